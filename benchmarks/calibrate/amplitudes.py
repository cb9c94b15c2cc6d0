"""One decay or two from different amplitudes: which names stay for a law of the amplitude, or of the time?

A machine holds one of four laws above small effects. Of quadratic drag and load-dependent friction, and of stiffness
drift and a cubic spring, one decay mostly lists both; a second one, let go from less far, is to part them.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.calibrate.calibration import Calibration, stands
from benchmarks.calibrate.pairs_of_one import two
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.pipeline import diagnose, prepare, prepare_together
from harness.diagnosis.rules import AMPLITUDES_APART

PARTED_BY_AMPLITUDE = (("quadratic-drag", "load-dependent-friction"), ("stiffness-drift", "cubic-stiffness"))
"""Effects that a single decay does not tell apart once small ones are beside them."""

RIVAL = {one: other for pair in PARTED_BY_AMPLITUDE for one, other in (pair, pair[::-1])}
"""Each law, and the one that follows a single decay of it alike."""


@dataclass(frozen=True, slots=True)
class Names:
    """main : the law that was there. alone, together : what is said of the larger decay, and of both."""

    main: str
    swings: float
    alone: str
    together: str


def measure(seed: int, index: int) -> Names:
    """One machine, the laws in turn."""
    rng = np.random.default_rng([seed, 12, index])
    main = list(RIVAL)[index % len(RIVAL)]
    pair = two(rng, main)
    swings = [float(np.ptp(next(iter(one.channels.values())))) for one in pair.recordings]
    together = prepare_together(pair.recordings, pair.asked)[0]
    alone = prepare(pair.recordings[0], pair.asked)[0]
    return Names(main, swings[0] / swings[1], _said(diagnose(alone), main), _said(diagnose(together), main))


def _said(found: Outcome, main: str) -> str:
    """named : alone, without an alternative. listed : among several. wrong : another without it. none."""
    graded = [m for m in found.mechanisms if m.grade.value in ("explains", "main", "one-of")]
    names = {m.name for m in graded} | {a.name for m in graded for a in m.alternatives}
    if not names or found.verdict == "unexplained":
        return "none"
    if main not in names:
        return "wrong"
    return "named" if names == {main} else ("listed with its rival" if RIVAL[main] in names else "listed")


def said(rows: Sequence[Names]) -> Iterator[str]:
    """A table."""
    ways = ("named", "listed with its rival", "listed", "wrong", "none")
    for which in ("alone", "together"):
        counts = [sum(getattr(row, which) == way for row in rows) for way in ways]
        yield f"{which:9s}" + ", ".join(f"{way} {count}" for way, count in zip(ways, counts, strict=True))
    for row in rows:
        yield f"  {row.main:24s} swings {row.swings:.2f}: {row.alone} -> {row.together}"
    apart = [row for row in rows if row.swings >= AMPLITUDES_APART.value]
    wrong = sum(row.together == "wrong" and row.alone != "wrong" for row in apart)
    named = [sum(getattr(row, which) == "named" for row in apart) for which in ("alone", "together")]
    yield stands(
        AMPLITUDES_APART,
        named[1] > named[0] and wrong == 0,
        f"of {len(apart)} with swings so far apart {named[0]} are named alone and {named[1]} together, {wrong} wrongly",
    )


CALIBRATION = Calibration(measure, said, "what a second amplitude parts")
