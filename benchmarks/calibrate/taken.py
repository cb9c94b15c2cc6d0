"""How often each law takes most of a misfit that it has not made, on simulated machines whose effects are others."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import median

from benchmarks.calibrate.calibration import Calibration, stands
from benchmarks.calibrate.machine_draws import based, drawn
from benchmarks.calibrate.plant_cases import seen
from harness.diagnosis.grading.grade import ranked
from harness.diagnosis.grading.misfit import misfit
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.diagnosis.rules import GAIN, SHARE_OF_EXCESS, TAKEN
from harness.model.registry import NAMED
from harness.proof.machines.kinds import CONTROL, MAIN, UNNAMED
from harness.proof.statistics import Rate

_GROUPS = (MAIN, CONTROL, MAIN, MAIN, UNNAMED)
_NEAR = 0.01
"""Half a unit of what a term's file says, and more."""


@dataclass(frozen=True, slots=True)
class Row:
    """A recording: names of its machine's effects, and of the laws that take most of its misfit."""

    made_by: frozenset[str]
    taken_by: frozenset[str]


def measure(seed: int, index: int) -> Row | None:
    """A new recording of a machine; None where the base leaves noise. Raises HarnessError."""
    recording, truth = drawn(seed, index, _GROUPS[index % len(_GROUPS)])
    start = seen(*based(recording, truth))
    if left_by(start.base, start.problem, start.scales.omega, start.base) is not Left.STRUCTURE:
        return None
    found = ranked(misfit(start.problem, start.base, start.scales))
    most = [f.name for f in found if f.share >= SHARE_OF_EXCESS.value and f.gain >= GAIN.value and not f.clock]
    return Row(frozenset({truth["dominant"] or "", *truth["minor"], *truth["may_name"]}), frozenset(most))


def said(rows: Sequence[Row]) -> Iterator[str]:
    """A line for each law: how often it takes what it has not made, and what it has."""
    yield "takes most of a misfit that it has not made, and that it has"
    rates: dict[str, float] = {}
    noted = {term.name: max(t.taken for t in NAMED if t.name == term.name) for term in NAMED}
    for name, now in noted.items():
        other = Rate.of([name in row.taken_by for row in rows if name not in row.made_by])
        own = Rate.of([name in row.taken_by for row in rows if name in row.made_by])
        rates[name] = other.value or 0.0
        yield (
            f"{name:30s} {other.hits:3d}/{other.cases} {rates[name]:.3f}"
            f" ({other.low or 0:.3f} to {other.high or 1:.3f}), {own.hits}/{own.cases}; its file says {now:g}"
        )
    ordinary = median(rates.values())
    off = [n for n, r in rates.items() if abs(max(r, TAKEN.value) - max(noted[n], TAKEN.value)) > _NEAR]
    why = f"the median is {ordinary:.3f}; " + (f"other than noted: {', '.join(off)}" if off else "laws as noted")
    yield stands(TAKEN, abs(ordinary - TAKEN.value) <= _NEAR and not off, why)


ABOUT = "how often a law takes most of a misfit that it has not made"
CALIBRATION = Calibration(measure, said, ABOUT)
