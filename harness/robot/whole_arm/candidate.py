"""What may be missing: columns of torque, for one joint or for all at once, at several settings."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray

FRICTION, MODEL = "friction", "model"


@dataclass(frozen=True, slots=True)
class Setting:
    """values : what is not linear in the columns, by name and unit (("v_s", "rad/s", .1), ...); may be empty.

    given : its columns, or what makes them where there are too many settings to keep.
    """

    values: tuple[tuple[str, str, float], ...]
    given: dict[int, FloatArray] | Callable[[], dict[int, FloatArray]]

    @property
    def columns(self) -> dict[int, FloatArray]:
        """By joint, (m, c) torque for one unit of each of c numbers; joints it does not touch are left out."""
        return self.given if isinstance(self.given, dict) else self.given()


@dataclass(frozen=True, slots=True)
class Candidate:
    """One thing that may be missing.

    name : as results call it. family : FRICTION or MODEL. joint : the one it is of, None for the whole arm. settings :
    all with the same number of columns. numbers : name and unit of what multiplies each column. spread (c,) : standard
    deviation expected of each number beforehand, inf where anything goes. partner, pair : what it can never be told

    """

    name: str
    family: str
    joint: int | None
    settings: tuple[Setting, ...]
    numbers: tuple[tuple[str, str], ...]
    spread: FloatArray
    partner: str = ""
    pair: str = ""
    shape: Callable[[float], FloatArray] | None = None
    looks: float = 1.0
    """Independent settings that this one is the best of, where it was chosen among them and polished."""

    @property
    def key(self) -> tuple[str, int | None]:
        """What tells it from the others."""
        return self.name, self.joint

    def around(self, setting: int, value: float, numbers: FloatArray, looks: float) -> "Candidate":
        """The candidate at one value near a setting of its own, with a further column: what a step of value changes.

        numbers (c,) : of the columns at that value; the further number is the step. looks : settings it was among.
        """
        assert self.shape is not None
        (joint,) = self.settings[setting].columns
        ((what, unit, _),) = self.settings[setting].values
        step = _STEP * value
        slope = (self.shape(value + step) - self.shape(value - step)) @ numbers / (2.0 * step)
        columns = np.column_stack((self.shape(value), slope))
        at = Setting(((what, unit, value),), {joint: columns})
        more, spread = (*self.numbers, (what, unit)), np.append(self.spread, np.inf)
        return replace(self, settings=(at,), numbers=more, spread=spread, looks=looks)


_STEP = 1e-3
"""Share of a value by which it is moved to see what it changes."""


def free(count: int) -> FloatArray:
    """Of numbers about which nothing is expected."""
    return np.full(count, np.inf)
