"""A result as a JSON file."""

from pathlib import Path

from harness.io.store import check_writable, write_text
from harness.results.common import Result


def check_target(path: Path) -> None:
    """Raise StoreError now when a result could not be written to ``path`` later."""
    check_writable(path)


def to_json(result: Result) -> str:
    """The text of a result, as every file of ours holds it."""
    return result.model_dump_json(by_alias=True, indent=2) + "\n"


def write_json(result: Result, path: Path) -> None:
    """Write a result whole or not at all; raises StoreError."""
    write_text(path, to_json(result))


def write_json_text(text: str, path: Path) -> None:
    """Write several results, already as text, whole or not at all; raises StoreError."""
    write_text(path, text)
