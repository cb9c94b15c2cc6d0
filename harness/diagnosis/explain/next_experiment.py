"""The recording that would decide between names that this one leaves open."""

from harness.diagnosis.outcome import Mechanism
from harness.diagnosis.problem import Problem
from harness.model.experiments import LARGER
from harness.model.registry import TERMS

_BY_FAMILY = {
    "friction": "releases from several displacements, the smallest a few times x_k, and a longer rest at the end",
    "damping": "releases from displacements that differ by a factor of three or more",
    "stiffness": LARGER,
    "environment": "the same release repeated: what hangs on the clock and what hangs on the motion then part",
    "sensor": "position and acceleration recorded together",
}


def _told(name: str, other: str) -> str | None:
    """What an entry of one name says of how it is told from another."""
    return next((t.told_from[other] for t in TERMS if t.name == name and other in t.told_from), None)


def next_experiment(mechanisms: tuple[Mechanism, ...], problem: Problem) -> str:
    """A sentence, empty when nothing is open."""
    open_ones = [m for m in mechanisms if m.alternatives]
    if not open_ones:
        return ""
    m = open_ones[0]
    other = m.alternatives[0].name
    advice = _told(m.name, other) or _told(other, m.name) or _BY_FAMILY[m.entry.term.family]
    if m.entry.term.family == "sensor" and {"x", "a"} <= set(problem.channels):
        advice = LARGER
    return f"To tell {m.name} from {other}: {advice}."
