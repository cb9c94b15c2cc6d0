"""A comparison for people, in a terminal."""

from harness.results.compare import CompareResult
from harness.show.report.compare import compare_headline, rows_of


def summary(result: CompareResult) -> tuple[str, list[tuple[str, list[str]]]]:
    """The verdict in a sentence, and the figures side by side: a label, the first's, the second's, their distance."""
    data = result.model_dump(by_alias=True)
    return compare_headline(data), rows_of(data)
