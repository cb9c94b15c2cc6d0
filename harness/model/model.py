"""A model of a slider: base parameters, restoring force, release, and terms in their slots.

And motions that leave the range over which a table of it is known.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Literal

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.checks import finite, not_negative, positive
from harness.core.errors import InputError
from harness.core.slider import Slider
from harness.model.covariate import Covariate
from harness.model.elsewhere import Elsewhere
from harness.model.registry import term as find_term
from harness.model.term import SINGLE, Extent, Slot, Term


class Restoring(StrEnum):
    """What pulls the slider back."""

    SPRING = "spring"
    PENDULUM = "pendulum"
    NONE = "none"


@dataclass(frozen=True, slots=True)
class ModelTerm:
    """A catalogue entry with values for its parameters (in the entry's order) and starts of its internal states.

    given : a table that its law reads and nothing fits, see harness.model.covariate.
    """

    term: Term
    values: tuple[float, ...]
    internal0: tuple[float, ...] = ()
    given: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if len(self.values) != len(self.term.parameters):
            wanted = ", ".join(self.term.names) or "no parameter"
            raise InputError(f"term {self.term.key}", f"{len(self.values)} parameters", wanted)
        for parameter, value in zip(self.term.parameters, self.values, strict=True):
            where = f"term {self.term.key}: {parameter.name}"
            finite(where, value)
            if not parameter.lower <= value <= parameter.upper:
                accepted = f"{parameter.lower:g} to {parameter.upper:g}"
                raise InputError(where, f"{value:g}", accepted)
        start = tuple(self.internal0) or (0.0,) * self.term.internal
        if len(start) != self.term.internal:
            wanted = f"{self.term.internal or 'no'} internal starts"
            raise InputError(f"term {self.term.key}", f"{len(start)} internal starts", wanted)
        for value in start:
            finite(f"term {self.term.key}: internal start", value)
        object.__setattr__(self, "internal0", start)

    @classmethod
    def named(cls, key: str, **values: float) -> "ModelTerm":
        """A term by its key and its parameters by name; InputError lists what it takes."""
        entry = find_term(key)
        if set(values) != set(entry.names):
            found = f"parameters {', '.join(sorted(values)) or 'none'}"
            raise InputError(f"term {key}", found, f"{', '.join(entry.names) or 'none'}")
        return cls(entry, tuple(float(values[name]) for name in entry.names))

    def repeats(self, over: Literal["time", "travel"]) -> float | None:
        """The angular frequency (rad/s) or the period (m) by which it repeats, None where it does not."""
        index = self.term.repeating(over)
        return None if index is None else self.values[index]

    @property
    def relaxation(self) -> float | None:
        """The time (s) within which it forgets, None where it does not."""
        return next((v for p, v in zip(self.term.parameters, self.values, strict=True) if p.relaxes), None)

    def presliding(self, f_k: float) -> float | None:
        """How far (m) it bends until friction f_k (N) slides, None where nothing bends."""
        stiffness = next((v for p, v in zip(self.term.parameters, self.values, strict=True) if p.bends), None)
        if stiffness is None:
            return None
        return f_k / stiffness if stiffness > 0.0 else math.inf

    def value(self, name: str) -> float:
        """The value of one parameter."""
        return self.values[self.term.names.index(name)]


@dataclass(frozen=True, slots=True)
class Model:
    """m x'' + c x' + k R(x) + sum of terms + f = u(t), released at time t0 from x0, v0.

    SI units; without a known mass m = 1 and forces are per unit mass. f_s : break-away force, None for f_k.
    offset : what the sensor of x shows when the restoring force is nil, m. covariates : measured columns that act too.
    elsewhere : what the slider has of its own in each further recording.
    Raises InputError for parameters out of range and for two laws in a slot that takes one.
    """

    m: float
    c: float
    k: float
    f_k: float
    f_s: float | None = None
    restoring: Restoring = Restoring.SPRING
    x0: float = 0.0
    v0: float = 0.0
    t0: float = 0.0
    terms: tuple[ModelTerm, ...] = ()
    mass_known: bool = True
    offset: float = 0.0
    covariates: tuple[Covariate, ...] = ()
    elsewhere: tuple[Elsewhere, ...] = ()

    def __post_init__(self) -> None:
        positive("model: m", self.m, "kg")
        not_negative("model: c", self.c, "N s/m")
        not_negative("model: f_k", self.f_k, "N")
        object.__setattr__(self, "restoring", Restoring(self.restoring))
        if self.restoring is Restoring.NONE:
            if self.k != 0.0:
                raise InputError("model: k", f"{self.k:g} with restoring none", "0")
        else:
            positive("model: k", self.k, "N/m")
        if self.f_s is not None and not_negative("model: f_s", self.f_s, "N") < self.f_k:
            raise InputError("model: f_s", f"{self.f_s:g}, below f_k = {self.f_k:g}", "f_s >= f_k")
        for name in ("x0", "v0", "t0", "offset"):
            finite(f"model: {name}", getattr(self, name))
        object.__setattr__(self, "terms", tuple(self.terms))
        for slot in SINGLE:
            filled = [entry.term.key for entry in self.terms if entry.term.slot is slot]
            if len(filled) > 1:
                raise InputError("model", f"{' and '.join(filled)} in slot {slot.value}", "one law a slot")

    @property
    def has_level(self) -> bool:
        """Whether a constant force is fitted with that of a covariate."""
        return any(one.has_level for one in self.covariates)

    @classmethod
    def of_slider(cls, slider: Slider, x0: float, v0: float = 0.0) -> "Model":
        """The base model of a slider."""
        f_s = None if slider.f_s == slider.f_k else slider.f_s
        return cls(slider.m, slider.c, slider.k, slider.f_k, f_s, x0=x0, v0=v0)

    def with_terms(self, *terms: ModelTerm) -> "Model":
        """The same model with these terms in place of its own."""
        return replace(self, terms=terms)

    def recentred(self, given: Mapping[str, FloatArray]) -> "Model":
        """The same with its covariates about the means of these values (n,), by name."""
        moved = (one.recentred(float(np.mean(given[one.name]))) for one in self.covariates)
        return replace(self, covariates=tuple(moved))

    def of_recording(self, number: int) -> "Model":
        """The model of one recording by itself, 0 being the first."""
        own = dict(self.elsewhere[number - 1].values) if number else {}
        return replace(self, elsewhere=(), **own)  # type: ignore[arg-type]

    def as_named(self, reach: float, speed: float, explains: bool = False) -> bool:
        """Whether the numbers of every term are what its name says.

        reach (m), speed (m/s) : of the motion. explains : whether the model leaves noise alone.
        """
        extent = Extent(self.f_k, reach, speed, explains)
        return all(entry.term.as_named(entry.values, extent) for entry in self.terms)

    @property
    def labels(self) -> tuple[str, ...]:
        """A name for each term: its key, with "#2" behind the second of a kind."""
        keys = [entry.term.key for entry in self.terms]
        if len(set(keys)) == len(keys):
            return tuple(keys)
        earlier = [keys[:i].count(key) for i, key in enumerate(keys)]
        return tuple(f"{key}#{n + 1}" if n else key for key, n in zip(keys, earlier, strict=True))

    @property
    def internal_names(self) -> tuple[tuple[str, ...], ...]:
        """Names of the internal states of each term: "presliding.z" for a bristle's, "viscoelastic.w0" for others."""
        return tuple(
            (f"{label}.z",) * entry.term.internal
            if entry.term.slot is Slot.FRICTION_LAW
            else tuple(f"{label}.w{i}" for i in range(entry.term.internal))
            for label, entry in zip(self.labels, self.terms, strict=True)
        )

    def in_slot(self, *slots: Slot) -> tuple[ModelTerm, ...]:
        """The terms in these slots."""
        return tuple(entry for entry in self.terms if entry.term.slot in slots)

    def find(self, key: str) -> ModelTerm | None:
        """The first term of this key, or None."""
        return next((entry for entry in self.terms if entry.term.key == key), None)


def beyond(model: Model, x: FloatArray, v: FloatArray) -> list[str]:
    """A sentence for each table that a motion x (n,), m, v (n,), m/s, leaves; none where all that acts is known."""
    return [said for entry in model.terms if (said := _beyond(entry, x, v))]


def _beyond(entry: ModelTerm, x: FloatArray, v: FloatArray) -> str:
    known = entry.term.known
    if known is None:
        return ""
    if known.reach is not None:
        return _out(entry, known.reach, x, v)
    low, high = known.ends(entry.values)
    motion = {"x": x, "|v|": np.abs(v), "v": np.maximum(v, 0.0), "-v": np.maximum(-v, 0.0)}[known.of]
    least, most = float(np.min(motion)), float(np.max(motion))
    if low <= least and most <= high:
        return ""
    unit = "m" if known.of == "x" else "m/s"
    reached = most if most > high else least
    return (
        f"{entry.term.name} is known from {known.of} = {low:.4g} to {high:.4g} {unit}, and the motion reaches"
        f" {reached:.4g} {unit}: what acts beyond is not known, and the table keeps its last value."
    )


def _out(entry: ModelTerm, reach: int, x: FloatArray, v: FloatArray) -> str:
    known = entry.term.known
    assert known is not None
    out, most = known.out(entry.values, x, v), entry.values[reach]
    worst = int(np.argmax(out))
    if out[worst] <= most:
        return ""
    return (
        f"{entry.term.name} is known over an oval of x and v, and the motion leaves it (x = {x[worst]:.4g} m at"
        f" v = {v[worst]:.4g} m/s, {out[worst] / most:.3g} times as far out): what acts there is not known, and the"
        " table keeps its last value."
    )
