"""The recording that would decide between names that this one leaves open."""

from harness.diagnosis.outcome import Mechanism
from harness.diagnosis.problem import Problem

_LARGER = "a release from a larger displacement"
_REST = "a recording that starts before the release and goes on well after rest"
_BOTH = "position and acceleration recorded together"
_SLOW = "a slow to-and-fro drive with the force recorded, so that it breaks away several times"

_BY_FAMILY = {
    "friction": "releases from several displacements, the smallest a few times x_k, and a longer rest at the end",
    "damping": "releases from displacements that differ by a factor of three or more",
    "stiffness": _LARGER,
    "environment": "the same release repeated: what hangs on the clock and what hangs on the motion then part",
    "sensor": _BOTH,
}
_BY_PAIR = {
    frozenset({"cubic-stiffness", "end-stop"}): _LARGER,
    frozenset({"constant-force", "sensor-drift"}): _REST,
    frozenset({"constant-force", "force-ripple"}): _LARGER,
    frozenset({"stribeck", "static-friction"}): _SLOW,
    frozenset({"presliding", "regularised-friction"}): _REST,
    frozenset({"stiffness-drift", "cubic-stiffness"}): _LARGER,
    frozenset({"friction-drift", "position-dependent-friction"}): "the same release repeated after a pause",
}


def next_experiment(mechanisms: tuple[Mechanism, ...], problem: Problem) -> str:
    """A sentence, empty when nothing is open."""
    open_ones = [m for m in mechanisms if m.alternatives]
    if not open_ones:
        return ""
    m = open_ones[0]
    other = m.alternatives[0].name
    advice = _BY_PAIR.get(frozenset({m.name, other}), _BY_FAMILY[m.entry.term.family])
    if m.entry.term.family == "sensor" and {"x", "a"} <= set(problem.channels):
        advice = _LARGER
    return f"To tell {m.name} from {other}: {advice}."
