"""What is tabulated: a force by position, by speed, by a sum of both, a resistance by position, a force over both."""

from collections.abc import Sequence
from dataclasses import dataclass

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
_RUBS, _BOTH = "g(x) sgn v", "f(x, v)"
RUNGS = (
    Rung("f(x)", (_BY_PLACE,)),
    Rung("f(|v|) sgn v", (_BY_SPEED,)),
    Rung(_RUBS, (_table("x", Slot.FRICTION_MODULATION),)),
    Rung("f(v)", (_table("v"), _table("-v")), ("f(|v|) sgn v",)),
    Rung("f(x) + f(v)", (_BY_PLACE, _BY_SPEED), ("f(x)", "f(|v|) sgn v")),
)
"""Simple ones first."""
_PLANE = _table("x, v")


def over_plane(kept: Sequence[Rung]) -> tuple[Rung, ...]:
    """The last rungs, on those that stay, the best of them first: a force of position and speed that no sum says.

    Beside it stand the tables of the best sum, and friction by position only where that stays and adds to it.
    """
    total = next((r.terms for r in kept if r.said != _RUBS), ())
    rubs = next((r.terms for r in kept if r.said == _RUBS), ())
    on = tuple(r.said for r in kept)
    alone = Rung(_BOTH, (*total, _PLANE), on)
    return (alone, Rung(f"{_BOTH} + {_RUBS}", (*total, *rubs, _PLANE), (*on, _BOTH))) if rubs else (alone,)
