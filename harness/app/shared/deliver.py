"""A result as a JSON file; light, since the command imports it before anything else."""

from typing import TYPE_CHECKING

from harness.io.store import check_writable, write_text

if TYPE_CHECKING:
    from harness.results.common import Result

__all__ = ["check_writable", "to_json", "write_text"]


def to_json(result: "Result") -> str:
    """The text of a result, as every file of ours holds it."""
    return result.model_dump_json(by_alias=True, indent=2) + "\n"
