"""A page made from a trace alone."""

from pathlib import Path

from harness.app.report import rebuild
from harness.results.diagnosis import DiagnosisResult


def is_rebuilt(result: DiagnosisResult, at: Path, says: str) -> None:
    """The page of a result, made again from its trace, is the page that was written, and says something."""
    _, page = rebuild(Path(result.files["rrd"]), at)
    text = page.read_text(encoding="utf-8")
    assert says in text
    assert text == Path(result.files["report"]).read_text(encoding="utf-8")
