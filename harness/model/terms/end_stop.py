"""A stop on the positive side, the negative side or both: a spring beyond a gap."""

import math
from collections.abc import Callable

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import lean
from harness.model.law import D_PARAMETER, D_X, VALUE
from harness.model.term import LARGER, Element, Evidence, Extent, Parameter, Place, Probe, Seen, Slot, Term, Zone


@lean
def push(deep: float, side: float, k_stop: float, out: FloatArray) -> None:
    """Of a stop on this side (1 or -1), ``deep`` m beyond its gap."""
    out[VALUE] = side * k_stop * deep
    out[D_X] = k_stop
    out[D_PARAMETER] = -side * k_stop
    out[D_PARAMETER + 1] = side * deep


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """k_stop (x - gap) beyond +gap, on the positive side."""
    if x > theta[o]:
        push(x - theta[o], 1.0, theta[o + 1], out)


def law_negative(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """k_stop (x + gap) beyond -gap, on the negative side."""
    if -x > theta[o]:
        push(-x - theta[o], -1.0, theta[o + 1], out)


def law_both(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """k_stop (|x| - gap) sgn x beyond the gap, on both sides."""
    if abs(x) > theta[o]:
        push(abs(x) - theta[o], 1.0 if x > 0.0 else -1.0, theta[o + 1], out)


def probes(e: Evidence) -> list[Probe]:
    """Linear in k_stop; gaps at fractions of the largest displacement on the side in question."""
    return [(fraction * e.x_scale, 0.0) for fraction in (0.35, 0.5, 0.62, 0.74, 0.82, 0.89, 0.95)]


_PLAY = 0.2
"""Share of the way to both ends below which a spring that is softer before is one with play."""


def at_an_end(values: Probe, extent: Extent, least: float = 0.0) -> bool:
    """What acts over more than half of the way to an end is the spring's shape, unless its corner is seen.

    least : share of the way below which no corner makes it a stop.
    """
    return values[0] >= (least if extent.explains else 0.5) * extent.reach


def at_both_ends(values: Probe, extent: Extent) -> bool:
    """The same; but what acts on both sides from near the middle on leaves a softer middle: play."""
    return at_an_end(values, extent, _PLAY)


def _stop(variant: str, side: str, law: Callable[..., None], sides: tuple[int, ...]) -> Term:
    """The entry for a stop on these sides, +1 and -1."""

    def place(values: Probe, seen: Seen) -> Place:
        gap = values[0]
        beyond = {1: seen.x > gap, -1: seen.x < -gap}
        inside = np.any([beyond[s] for s in sides], axis=0)
        if len(sides) == 2:
            return Place("large-displacement", f"|x| > {gap:.4g} m", seen.where(inside))
        return Place("one-side", f"x > {gap:.4g} m" if sides[0] > 0 else f"x < -{gap:.4g} m", seen.where(inside))

    def made_of(values: Probe, k: float) -> tuple[Element, ...]:
        gap, k_stop = values
        return (Zone(k_stop, -gap if -1 in sides else -math.inf, gap if 1 in sides else math.inf),)

    return Term(
        "end-stop",
        "stiffness",
        Slot.SMOOTH,
        (Parameter("gap", "m", 0.0, positive=True), Parameter("k_stop", "N/m", 0.0, none=0.0)),
        f"A stop acts beyond {{gap}} on {side}: k_stop = {{k_stop}}.",
        law,
        probes,
        amplitude=1,
        variant=variant,
        needs=("returns",),
        example=(0.53, 200.0),
        corner=True,
        place=place,
        as_named=at_both_ends if len(sides) == 2 else at_an_end,
        elements=made_of,
        told_from={"stiffness-drift": LARGER},
        order=160,
    )


TERM = _stop("", "both sides", law_both, (1, -1))
TERM_POSITIVE = _stop("positive", "the positive side", law, (1,))
TERM_NEGATIVE = _stop("negative", "the negative side", law_negative, (-1,))
