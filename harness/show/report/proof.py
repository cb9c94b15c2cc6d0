"""The page of a sealed proof."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from harness.show.report.page import write_report
from harness.show.report.section import Section
from harness.show.report.sources import MadeWith
from harness.show.report.verdict import Verdict


def write_proof_page(path: Path, result: Mapping[str, Any]) -> None:
    """Write the page. result : harness.proof/1 as data, with its transcript entry by entry."""
    sections: Sequence[Section] = [
        Verdict("", result["shortfalls"]),
        MadeWith(result["machine"], result["files"], result["command"]),
    ]
    write_report(path, "The sealed proof", "", sections)
