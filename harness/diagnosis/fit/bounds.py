"""How far a fit may go: no parameter beyond what the recording could show of it.

A step of a descent is as long as its linear look says, and beside a flat direction that is any length; what lies
beyond these bounds is told by nothing in the recording, and costs a simulation all the same.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.parameters import Free, values_of, with_values
from harness.diagnosis.problem import Problem
from harness.kernels.solve import Scales
from harness.model.elsewhere import parted
from harness.model.model import Model
from harness.model.term import Parameter

_BEYOND = 10.0
"""Times the largest length, speed, acceleration or time of the recording: a law on such a scale is flat in it."""
_FORCES = 1e3
"""Times the largest force of the motion: forces may cancel, but what is left of larger ones is lost in noise."""
_ALIASED = 2.0
"""Times half the rate of the samples: a law faster than that half is dropped by ``within``, and must get there."""
_FINER = 100.0
"""Times finer than a sample's noise is what the motion of thousands of them shows of a bristle's length.

Not beside a recorded force: what that does between two samples, at a reversal, moves a slider as such a bristle does.
"""
_UNITS = {
    "m": "m", "c": "N s/m", "k": "N/m", "f_k": "N", "offset": "m", "x0": "m", "v0": "m/s",
}  # fmt: skip
"""Of base parameters; the mass is measured against the force."""


@dataclass(frozen=True, slots=True)
class Reach:
    """The largest of what a recording shows, or of what follows from it in a motion of its frequency.

    begin, end : of its clock, s. fastest : half the rate of its samples, rad/s. x (m), v (m/s), a (m/s^2). force : of
    its drive, N, 0 without one. noise : of x, m, 0 without one.
    """

    begin: float
    end: float
    fastest: float
    x: float
    v: float
    a: float
    force: float
    noise: float

    @classmethod
    def of(cls, problem: Problem, scales: Scales) -> "Reach":
        """Of a recording; scales give the frequency by which a channel that is missing follows from the others."""
        t, omega = problem.t, scales.omega
        size = {c: _largest(y) for c, y in problem.channels.items()}
        derived = (
            ("v", "x", omega), ("a", "v", omega), ("a", "x", omega**2),
            ("v", "a", 1.0 / omega), ("x", "v", 1.0 / omega), ("x", "a", 1.0 / omega**2),
        )  # fmt: skip
        for new, old, factor in derived:
            if new not in size and old in size:
                size[new] = factor * size[old]
        # what is no motion has none of them
        size = {"x": scales.x, "v": scales.v, "a": scales.v * scales.omega} | size
        force = 0.0 if problem.drive is None else _largest(problem.drive.u)
        step = float(np.median(np.diff(t))) if t.size > 1 else 0.0
        fastest = math.pi / step if step > 0.0 else math.inf
        noise = problem.noise["x"].sigma if "x" in problem.noise else 0.0
        return cls(float(t[0]), float(t[-1]), fastest, size["x"], size["v"], size["a"], force, noise)

    @property
    def span(self) -> float:
        """How long it is, s."""
        return self.end - self.begin

    def of_unit(self, unit: str, mass: float) -> float:
        """The largest value of a parameter in this unit that it could tell; infinite for an angle or a pure number."""
        force = _FORCES * max(self.force, mass * self.a)
        x, v = self.x, self.v
        largest = {
            "s": lambda: _BEYOND * self.span,
            "rad/s": lambda: _ALIASED * self.fastest,
            "1/s": lambda: _FORCES / self.span,
            "m": lambda: _BEYOND * x,
            "m/s": lambda: _BEYOND * v,
            "m/s^2": lambda: _BEYOND * self.a,
            "1/m": lambda: _FORCES / x,
            "kg": lambda: _FORCES * self.force / self.a if self.force > 0.0 else math.inf,
            "N": lambda: force,
            "N s": lambda: mass * _BEYOND * v,
            "N s/m": lambda: force / v,
            "kg/m": lambda: force / v**2,
            "N (s/m)^p": lambda: force / min(v, 1.0),
            "N/m": lambda: force / x,
            "N/m^2": lambda: force / x**2,
            "N/m^3": lambda: force / x**3,
        }.get(unit)
        with np.errstate(all="ignore"):
            try:
                found = math.inf if largest is None else float(largest())
            except (OverflowError, ZeroDivisionError):
                return math.inf
        return found if found > 0.0 else math.inf


def _largest(values: FloatArray) -> float:
    return float(np.max(np.abs(values), initial=0.0))


def within(free: Sequence[Free], model: Model, problem: Problem, scales: Scales | None) -> tuple[Free, ...]:
    """The fitted numbers of a model with no bound beyond what the recording could show."""
    reach = Reach.of(problem, scales or Scales.of(model, problem.drive))
    found = []
    for f in free:
        if isinstance(f.by, tuple):
            term = model.terms[f.by[0]].term
            low, high = _ends(term.parameters[f.by[1]], reach, model.m)
        else:
            stem, _ = parted(f.by)
            unit = "kg" if stem == "m" else _UNITS.get(stem, "1")
            high = reach.of_unit(unit, model.m)
            low = -high
        found.append(replace(f, lower=max(f.lower, low), upper=min(f.upper, high)))
    return tuple(found)


def _ends(parameter: Parameter, reach: Reach, mass: float) -> tuple[float, float]:
    """The least and the largest value of a term's parameter that a recording could tell."""
    if parameter.moment:
        # a part of a recording shows nothing of a moment in another part, and leaves it where it is
        return reach.begin - _BEYOND * reach.span, reach.end + _BEYOND * reach.span
    if parameter.unit == "s" and not parameter.relaxes:
        return -reach.span, reach.span
    high = reach.of_unit(parameter.unit, mass)
    if parameter.bends and reach.noise > 0.0:
        finer = _FINER if reach.force == 0.0 else 1.0
        high = max(high, finer * max(reach.force, mass * reach.a) / reach.noise)
    return -high, high


def brought_within(model: Model, free: Sequence[Free], problem: Problem, scales: Scales) -> Model:
    """A model with its fitted numbers brought back to what the recording could show."""
    bounds = within(free, model, problem, scales)
    values = values_of(model, bounds)
    moved = np.clip(values, [f.lower for f in bounds], [f.upper for f in bounds])
    return model if np.array_equal(moved, values) else with_values(model, bounds, moved)
