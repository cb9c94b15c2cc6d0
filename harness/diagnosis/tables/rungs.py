"""What is tabulated: a force by position, by speed, by both, a resistance by speed in each direction, by position."""

from dataclasses import dataclass

from harness.core.arrays import FloatArray
from harness.model.registry import TERMS
from harness.model.term import Slot, Term


@dataclass(frozen=True, slots=True)
class Rung:
    """Tables that are fitted together.

    said : in words. on : rungs that it holds, and must improve on.
    """

    said: str
    terms: tuple[Term, ...]
    on: tuple[str, ...] = ()


def _table(of: str, slot: Slot = Slot.SMOOTH) -> Term:
    return next(t for t in TERMS if t.known is not None and t.known.of == of and t.slot is slot)


_BY_PLACE, _BY_SPEED = _table("x"), _table("|v|")
RUNGS = (
    Rung("f(x)", (_BY_PLACE,)),
    Rung("f(|v|) sgn v", (_BY_SPEED,)),
    Rung("g(x) sgn v", (_table("x", Slot.FRICTION_MODULATION),)),
    Rung("f(v)", (_table("v"), _table("-v")), ("f(|v|) sgn v",)),
    Rung("f(x) + f(v)", (_BY_PLACE, _BY_SPEED), ("f(x)", "f(|v|) sgn v")),
)
"""Simple ones first. A force over position and speed at once has none: a free decay never crosses itself."""


def rungs_for(x: FloatArray, v: FloatArray) -> tuple[Rung, ...]:
    """The rungs that a motion x, v (n,) bears."""
    return RUNGS
