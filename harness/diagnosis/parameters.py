"""What of a model is fitted, and in which coordinates.

Friction that a fit has lost to damping, given back a share of it, so that what acts on friction finds some.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.rules import FRICTION_GONE
from harness.fit.least_squares import Bounds
from harness.kernels.solve import By, Scales
from harness.model.elsewhere import parted
from harness.model.model import Model, ModelTerm

BASE = ("m", "c", "k", "f_k", "offset", "x0", "v0")
_POSITIVE_BASE = frozenset({"m", "k"})
_LEAST, _MOST = 1e-300, 1e300
"""Between these lies what is fitted as a logarithm."""
_LONGEST = 2.0
"""How far one step may move a logarithm."""


@dataclass(frozen=True, slots=True)
class Free:
    """One fitted number.

    by : base name, (term, parameter), or name of an internal start. lower, upper : bounds. log : fitted as logarithm.
    name : as results show it.
    """

    by: By
    name: str
    lower: float
    upper: float
    log: bool

    def inward(self, value: float) -> float:
        """To the coordinate that is fitted."""
        return math.log(max(value, _LEAST)) if self.log else value

    def outward(self, coordinate: float) -> float:
        """Back to the parameter, within its bounds."""
        # a number on its bound is known by equality, which a logarithm there and back would lose
        if coordinate >= self.inward(self.upper):
            return self.upper
        if coordinate <= self.inward(self.lower):
            return max(self.lower, _LEAST) if self.log else self.lower
        return min(max(math.exp(coordinate), self.lower), self.upper) if self.log else coordinate

    def slope(self, value: float) -> float:
        """d parameter / d coordinate."""
        return value if self.log else 1.0


def free_of(model: Model, base: tuple[str, ...]) -> tuple[Free, ...]:
    """The fitted numbers of a model: these base names, those of covariates, then every parameter of every term."""
    free = []
    given = (name for covariate in model.covariates for name in covariate.fitted)
    for name in dict.fromkeys((*base, *given)):
        stem, _ = parted(name)
        positive = stem in _POSITIVE_BASE
        lower = 0.0 if stem in ("c", "f_k") else (_LEAST if positive else -math.inf)
        free.append(Free(name, name, lower, math.inf, positive))
    for i, entry in enumerate(model.terms):
        for j, p in enumerate(entry.term.parameters):
            log = p.positive and entry.values[j] > 0.0
            upper = p.springs * model.k if p.springs is not None and model.k > 0.0 else p.upper
            free.append(Free((i, j), f"{entry.term.key}.{p.name}", p.lower, upper, log))
    return tuple(free)


def values_of(model: Model, free: tuple[Free, ...]) -> FloatArray:
    """Values of the fitted numbers in a model, (q,)."""
    values = np.empty(len(free))
    for i, f in enumerate(free):
        values[i] = model.terms[f.by[0]].values[f.by[1]] if isinstance(f.by, tuple) else _base_value(model, f.by)
    return values


def with_values(model: Model, free: tuple[Free, ...], values: FloatArray) -> Model:
    """The model with these values (q,) for its fitted numbers."""
    base: dict[str, Any] = {}
    terms = [list(entry.values) for entry in model.terms]
    covariates = list(model.covariates)
    given = {name: i for i, one in enumerate(covariates) for name in one.fitted}
    elsewhere = list(model.elsewhere)
    for f, value in zip(free, values, strict=True):
        if isinstance(f.by, tuple):
            terms[f.by[0]][f.by[1]] = float(value)
        elif f.by in given:
            covariates[given[f.by]] = covariates[given[f.by]].at(f.by, float(value))
        else:
            stem, recording = parted(f.by)
            if recording:
                elsewhere[recording - 1] = elsewhere[recording - 1].having(**{stem: float(value)})
            else:
                base[stem] = float(value)
    entries = tuple(
        ModelTerm(entry.term, tuple(new), entry.internal0) for entry, new in zip(model.terms, terms, strict=True)
    )
    return replace(model, terms=entries, covariates=tuple(covariates), elsewhere=tuple(elsewhere), **base)


def _base_value(model: Model, name: str) -> float:
    given = {at: value for one in model.covariates for at, value in one.fitted.items()}
    if name in given:
        return float(given[name])
    stem, recording = parted(name)
    return model.elsewhere[recording - 1].value(stem) if recording else float(getattr(model, stem))


def bounds_of(free: tuple[Free, ...]) -> Bounds:
    """Bounds of the coordinates that are fitted."""
    return Bounds(
        np.array([f.inward(f.lower) for f in free]),
        np.array([f.inward(min(f.upper, _MOST)) if f.log else f.upper for f in free]),
        np.array([_LONGEST if f.log else math.inf for f in free]),
    )


def coordinates_of(model: Model, free: tuple[Free, ...]) -> FloatArray:
    """Coordinates (q,) of the fitted numbers in a model."""
    return np.array([f.inward(v) for f, v in zip(free, values_of(model, free).tolist(), strict=True)])


def with_coordinates(model: Model, free: tuple[Free, ...], at: FloatArray) -> Model:
    """The model with its fitted numbers at these coordinates (q,), within their bounds."""
    return with_values(model, free, np.array([f.outward(c) for f, c in zip(free, at.tolist(), strict=True)]))


def base_of(free: tuple[Free, ...]) -> tuple[str, ...]:
    """Names of the base parameters among fitted numbers."""
    return tuple(f.name for f in free if isinstance(f.by, str))


def in_recording(number: By, model: Model, recording: int) -> By | None:
    """A number as it stands in the model of one recording by itself; None where that has one of its own."""
    if isinstance(number, tuple):
        return number
    stem, of = parted(number)
    if of == recording:
        return stem
    own = model.elsewhere[recording - 1].names if recording else ()
    return number if of == 0 and stem not in own else None


def with_friction(model: Model, base: tuple[str, ...], scales: Scales) -> Model | None:
    """A model whose friction, which is fitted, has vanished, with half of its damping as friction; None for others.

    base : names of what is fitted. Equal energy over a cycle of half the amplitude: 4 f_k X = pi c omega X^2.
    """
    as_friction = math.pi / 4.0 * model.c * scales.omega * 0.5 * scales.x
    if "f_k" not in base or model.f_k > FRICTION_GONE.value * as_friction:
        return None
    return replace(model, c=0.5 * model.c, f_k=0.5 * as_friction)
