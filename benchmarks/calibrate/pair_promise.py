"""Two effects hidden: how near the noise does the true second one promise to come, from the true first one?

And which share of the best promise it has, in the whole recording or in its first part, where the first one leaves
structure: there a law is fitted only if it promises enough of both.
"""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from benchmarks.calibrate.calibration import Calibration, head, quantiles, stands
from benchmarks.calibrate.plant_cases import Start, case_of, pair_of, start_of, with_term
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.diagnosis.rules import PAIR_PROMISE, SCREEN_SHARE
from harness.diagnosis.search.extend import opening
from harness.diagnosis.search.look import Look
from harness.model.registry import NAMED


def measure(seed: int, index: int) -> tuple[str, float, float] | None:
    """The two names, the one fitted first, chi-square per point that the other promises to leave, and its share.

    share : nan where the first leaves no structure. None where neither fits alone, or where the other is no law with a
    linear amplitude, which promises nothing.
    """
    rng = np.random.default_rng([seed, 3, index])
    names = pair_of(rng)
    start = start_of(case_of(names, rng, index))
    alone = {name: found for name in names if (found := with_term(start, name)) is not None}
    if not alone:
        return None
    first = min(alone, key=lambda name: alone[name].base.chi2 / alone[name].problem.points)
    (other,) = (name for name in names if name != first)
    at = alone[first]
    look = Look.at(at.base, at.problem, at.scales, NAMED)
    own = look.gain_of(other)
    if own is None:
        return None
    structure = left_by(at.base, at.problem, at.scales.omega, at.base) is Left.STRUCTURE
    share = _share(at, look, other) if structure else math.nan
    return f"{first} + {other}", (at.base.chi2 - own) / at.base.points, share


def _share(at: Start, whole: Look, name: str) -> float:
    """Of the best promise, in the whole or in the first part."""
    looks = (whole, opening(at.base, at.problem, at.scales, NAMED))
    gains = [(look.gain_of(name) or 0.0) / look.most for look in looks if look is not None and look.most > 0.0]
    return max(gains, default=math.nan)


def said(rows: Sequence[tuple[str, float, float]]) -> Iterator[str]:
    """Quantiles of the promise, the largest with its effects; and of the share, the least."""
    yield head("chi-square per point promised")
    yield quantiles("true second effect", [promise for _, promise, _ in rows])
    if rows:
        names, most, _ = max(rows, key=lambda row: row[1])
        yield stands(PAIR_PROMISE, most <= PAIR_PROMISE.value, f"the largest is {most:.3g} ({names})")
    shares = [(names, share) for names, _, share in rows if math.isfinite(share)]
    yield head("share of the best promise where structure is left")
    yield quantiles("true second effect", [share for _, share in shares])
    if shares:
        names, least = min(shares, key=lambda row: row[1])
        yield stands(SCREEN_SHARE, least >= SCREEN_SHARE.value, f"the least is {least:.3g} ({names})")


CALIBRATION = Calibration(measure, said, "chi-square per point that the true second effect promises to leave")
