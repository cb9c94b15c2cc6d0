"""A stop on the positive side, the negative side or both: a spring beyond a gap."""

from harness.core.arrays import FloatArray
from harness.model.evidence import Evidence
from harness.model.law import D_PARAMETER, D_X, VALUE
from harness.model.term import Parameter, Probe, Slot, Term


def law(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """k_stop (x - gap) beyond +gap, on the positive side."""
    gap, k_stop = theta[o], theta[o + 1]
    out[VALUE] = 0.0
    out[D_X] = 0.0
    out[D_PARAMETER] = 0.0
    out[D_PARAMETER + 1] = 0.0
    if x > gap:
        out[VALUE] = k_stop * (x - gap)
        out[D_X] = k_stop
        out[D_PARAMETER] = -k_stop
        out[D_PARAMETER + 1] = x - gap


def law_negative(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """k_stop (x + gap) beyond -gap, on the negative side."""
    gap, k_stop = theta[o], theta[o + 1]
    out[VALUE] = 0.0
    out[D_X] = 0.0
    out[D_PARAMETER] = 0.0
    out[D_PARAMETER + 1] = 0.0
    if x < -gap:
        out[VALUE] = k_stop * (x + gap)
        out[D_X] = k_stop
        out[D_PARAMETER] = k_stop
        out[D_PARAMETER + 1] = x + gap


def law_both(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """k_stop (|x| - gap) sgn x beyond the gap, on both sides."""
    gap, k_stop = theta[o], theta[o + 1]
    out[VALUE] = 0.0
    out[D_X] = 0.0
    out[D_PARAMETER] = 0.0
    out[D_PARAMETER + 1] = 0.0
    if abs(x) > gap:
        side = 1.0 if x > 0.0 else -1.0
        out[VALUE] = k_stop * (x - side * gap)
        out[D_X] = k_stop
        out[D_PARAMETER] = -side * k_stop
        out[D_PARAMETER + 1] = x - side * gap


def probes(e: Evidence) -> list[Probe]:
    """Linear in k_stop; gaps at fractions of the largest displacement on the side in question."""
    return [(fraction * e.x_scale, 0.0) for fraction in (0.35, 0.5, 0.62, 0.74, 0.82, 0.89, 0.95)]


_PARAMETERS = (Parameter("gap", "m", 0.0, positive=True), Parameter("k_stop", "N/m", 0.0, none=0.0))
_SENTENCE = "A stop acts beyond {gap} {side}: k_stop = {k_stop}."

TERM = Term(
    "end-stop",
    "stiffness",
    Slot.SMOOTH,
    _PARAMETERS,
    _SENTENCE.replace("{side}", "on both sides"),
    law_both,
    probes,
    amplitude=1,
)
TERM_POSITIVE = Term(
    "end-stop",
    "stiffness",
    Slot.SMOOTH,
    _PARAMETERS,
    _SENTENCE.replace("{side}", "on the positive side"),
    law,
    probes,
    amplitude=1,
    variant="positive",
)
TERM_NEGATIVE = Term(
    "end-stop",
    "stiffness",
    Slot.SMOOTH,
    _PARAMETERS,
    _SENTENCE.replace("{side}", "on the negative side"),
    law_negative,
    probes,
    amplitude=1,
    variant="negative",
)
