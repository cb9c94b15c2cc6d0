"""One parameter of several recordings in the form of the results."""

from collections.abc import Mapping, Sequence

from harness.core.quantity import Quantity
from harness.estimate.repeated import repeated
from harness.results.common import P, RepeatedResult


def repeated_results(files: Sequence[str], each: Sequence[Mapping[str, Quantity]]) -> dict[str, RepeatedResult]:
    """Every number by name that two recordings or more tell with an error; files and each in the same order."""
    found = {}
    for name in dict.fromkeys(name for one in each for name in one):
        told = [(file, one[name]) for file, one in zip(files, each, strict=True) if name in one]
        known = [(f, q.value, q.stderr, q.unit) for f, q in told if q.value is not None and q.stderr is not None]
        known = [one for one in known if one[2] > 0.0]
        if len(known) < 2:
            continue
        seen = repeated([value for _, value, _, _ in known], [error for _, _, error, _ in known])
        found[name] = RepeatedResult(
            value=P(value=seen.value, stderr=seen.stderr, unit=known[0][3]),
            within=seen.within,
            between=seen.between,
            outliers=[known[i][0] for i in seen.outliers],
        )
    return found
