"""Is a recording the trace of a simulation that steps? Then what its integrator adds is the engine's, not physics.

An integrator of first order shifts omega_n and zeta, reads the acceleration of the step before, scales it by
1 + h c/m and turns friction round on whole steps. In the catalogue's words that looks like sensors out of tune. So
where the search ends at friction of a soft constraint, at nothing but sensors or at nothing, the recording is also
fitted by the very maps, from one state to the next, that engines step by; one that tells more with fewer numbers is
believed.

Every scheme takes the friction of a soft constraint, f_k sat((v + lead a0)/v_r), which includes friction that acts
within one step (lead = h, v_r = h f_k/m); they differ in what they take at the end of the step:

    explicit          nothing: v' = v + h a, then x' = x + h v'
    damping-implicit  the damping: (m + h c) v' counts (MuJoCo: Euler and implicitfast)
    implicit          damping and spring: m + h c + h^2 k counts, in the friction too (MuJoCo: discrete)

Under the first two the acceleration is the step's own; under the last it is what acts on the state itself. Given as
the step's own, (v' - v)/h, an implicit step is the explicit map of another slider, of c + h k for c and with
m + h c + h^2 k for m: its damping is then part of what is found.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, TypeAlias

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import compiled
from harness.diagnosis.baseline.residual_noise import residual_noise
from harness.diagnosis.fit.model_fit import Fit, fit, whitened
from harness.diagnosis.parameters import base_of, free_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.residual_tests.lack_of_fit import lack_of_fit
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.rules import STEPPED, STEPPED_WITHIN, STRUCTURE
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search, under
from harness.fit.least_squares import Bounds, Until, least_squares
from harness.kernels.solve import Scales
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.registry import TERMS
from harness.model.term import Slot

Scheme: TypeAlias = Literal["explicit", "damping-implicit", "implicit"]
SCHEMES: tuple[Scheme, ...] = ("explicit", "damping-implicit", "implicit")


@dataclass(frozen=True, slots=True)
class Stepped:
    """Samples x, v, a of stepped motions, each (n, k)."""

    x: FloatArray
    v: FloatArray
    a: FloatArray


def _march(
    p: FloatArray, h: float, each: int, scheme: int, pendulum: bool, late: bool, state: FloatArray, x: FloatArray,
    v: FloatArray, a: FloatArray,
) -> None:  # fmt: skip
    """Fill x, v, a (n, k) with every ``each``-th state of k motions side by side; p (7, k) : c/m, k/m, f_k/m, x0, v0,
    v_r, lead.

    late : the acceleration is the one that led to the state, not the one at it. state (3, k) : room.
    """
    count = p.shape[1]
    for q in range(count):
        state[0, q], state[1, q], state[2, q] = p[3, q], p[4, q], 0.0
    for step in range((x.shape[0] - 1) * each + 1):
        i = step // each
        shown = step % each == 0
        for q in range(count):
            c, k, f = p[0, q], p[1, q], p[2, q]
            at, speed, before = state[0, q], state[1, q], state[2, q]
            inertia = 1.0 + h * c + h * h * k
            pull = k * np.sin(at) if pendulum else k * at
            acting = -pull - c * speed
            free = (acting - h * k * speed) / inertia if scheme == 2 else acting
            share = min(1.0, max(-1.0, (speed + p[6, q] * free) / p[5, q]))
            now = acting - f * share
            if shown:
                x[i, q], v[i, q], a[i, q] = at, speed, before if late and step > 0 else now
            if scheme == 2:
                speed += h * (free - f * share / inertia)
            else:
                speed += h * now / (1.0 + h * c) if scheme == 1 else h * now
            state[0, q], state[1, q], state[2, q] = at + h * speed, speed, now


_compiled_march = compiled(_march)


def stepped(p: FloatArray, h: float, each: int, scheme: Scheme, pendulum: bool, late: bool, n: int) -> Stepped:
    """n samples, one every ``each`` steps of h s, for each column of p (7, k). See ``_march``."""
    p = np.ascontiguousarray(p)
    shape = (n, p.shape[1])
    out = Stepped(np.empty(shape), np.empty(shape), np.empty(shape))
    room = np.empty((3, p.shape[1]))
    _compiled_march(p, h, each, SCHEMES.index(scheme), pendulum, late, room, out.x, out.v, out.a)
    return out


@dataclass(frozen=True, slots=True)
class Stepping:
    """How the engine steps whose trace this is.

    scheme : one of SCHEMES. h : its step, s. late : whether the acceleration is that of the step before. model : the
    physics that it steps. left : mean square that the steps leave, in units of the noise. within_a_step : friction
    turns round within one step.
    """

    scheme: Scheme
    h: float
    late: bool
    model: Model
    left: float
    within_a_step: bool

    @property
    def sentence(self) -> str:
        """What is said of it."""
        m = self.model
        soft = m.terms[0]
        read = ", and its acceleration is that of the step before" if self.late else ""
        return (
            f"this is the trace of a simulation with a step of {self.h * 1e3:.4g} ms ({self.scheme}){read}; the steps"
            f" themselves fit to the noise with m = {m.m:.6g}, c = {m.c:.5g}, k = {m.k:.6g}, f_k = {m.f_k:.5g},"
            f" v_r = {soft.value('v_r'):.4g} m/s, lead = {soft.value('lead') * 1e3:.4g} ms; what the integrator adds"
            " is counted as the engine's"
        )


_READINGS = frozenset(t.name for t in TERMS if t.steps_alike and t.slot is Slot.OBSERVATION)
SOFT = next(t.name for t in TERMS if t.steps_alike and t.slot is Slot.FRICTION_LAW)
"""What steps look like in the catalogue's words: sensors out of tune, and the friction of a soft constraint."""
_STEPS_A_SAMPLE = (1, 2, 4, 5, 10)
"""Steps an engine may have made between samples: how traces are thinned."""
_EVEN = 1e-2
"""Share of the sampling interval by which times may differ from even ones (files are written with few digits)."""
_DIFFERENCE, _FAR, _DONE = 1e-6, 1e6, 1e-2
"""Of partials, in scales; residuals that diverged count as so many sigma; what a last step takes off chi-square."""
_ZERO = 7
"""Place of the sensor's zero among the parameters, after those of the motion."""
_FIRST_LOOK, _SECOND_LOOK = 1500, 4000
_LOOKS, _ROUNDS = 10, 25
_FINALISTS = 5
"""Samples and rounds of the first look at every scheme; those that go on to a second."""


@dataclass(frozen=True, slots=True)
class _Tried:
    scheme: Scheme
    h: float
    each: int
    late: bool
    values: FloatArray
    residual: FloatArray
    jacobian: FloatArray

    @property
    def chi2(self) -> float:
        return float(self.residual @ self.residual)


def _is_even(t: FloatArray) -> bool:
    interval = (t[-1] - t[0]) / (t.size - 1)
    # of a clock that drifts, steps are as good as even, and what they add up to is not
    return bool(np.max(np.abs(t - np.linspace(t[0], t[-1], t.size))) < _EVEN * interval)


def _worth_a_try(found: Search) -> Fit | None:
    """The fit to start from: where soft friction, nothing but readings, or no explanation was found."""
    if "x" not in found.problem.channels or not _is_even(found.problem.t):
        return None
    names = set(key_of(found.chosen))
    if found.explained:
        return found.chosen if names and names <= _READINGS | {SOFT} else None
    if SOFT in names:
        return found.chosen
    soft_first = found.singles and key_of(found.singles[0]) == (SOFT,)
    return found.singles[0] if soft_first else found.base


def as_stepped(found: Search, scales: Scales) -> tuple[Search, Stepping] | None:
    """The search's answer for the trace of an engine, and how it steps; None for any other recording."""
    start = _worth_a_try(found)
    if start is None:
        return None
    best = _best(found.problem, start.model)
    shown = {c: y[:, 0] for c, y in _shown(best, best.values[:, None], found.problem, start.model).items()}
    period = 2.0 * np.pi / scales.omega
    noise = {c: residual_noise(found.problem.t, y - shown[c], y, period) for c, y in found.problem.channels.items()}
    problem = replace(found.problem, noise=noise)
    best = _fitted(best, problem, start.model, _ROUNDS)
    penalty = np.log(problem.points)
    rival = min(under(f, problem).bic for f in (found.chosen, start, *found.singles[:1]))
    free = best.values.size
    if best.chi2 + free * penalty > rival - STEPPED.value or not _is_noise(best, problem, scales.omega):
        return None
    stepping = _said(best, problem, start.model)
    return _without_readings(found, problem, start, stepping, scales), stepping


def steps_of(trace: Problem, model: Model) -> list[Stepping]:
    """How the engine steps whose trace this is known to be, by every scheme; none for a trace whose times are not even,
    that is driven, or has no spring.

    Without an acceleration the schemes are one map of different sliders. model : a fit to the trace, which the maps
    begin at.
    """
    if trace.drive is not None or model.k <= 0.0 or not _is_even(trace.t):
        return []
    best = _best(trace, model)
    others = [replace(best, scheme=to, values=_by_scheme(best, to)) for to in SCHEMES if to != best.scheme]
    return [_said(_fitted(one, trace, model, _ROUNDS), trace, model) for one in (best, *others)]


def _by_scheme(tried: _Tried, to: Scheme) -> FloatArray:
    """The numbers with which another scheme makes the same steps, as far as they are seen in positions.

    The explicit scheme's C, K, F are those of the others over 1 + h c, or 1 + h c + h^2 k, which are 1 / (1 - h C).
    """
    values, h = tried.values.copy(), tried.h
    c, k = values[0], values[1]
    inertia = {"explicit": 1.0, "damping-implicit": 1.0 + h * c, "implicit": 1.0 + h * c + h * h * k}[tried.scheme]
    values[:3] /= inertia
    values[0] += h * values[1] if tried.scheme == "implicit" else 0.0
    values[6] *= inertia if tried.scheme == "damping-implicit" else 1.0
    inertia = 1.0 if to == "explicit" else 1.0 / max(1.0 - h * values[0], 0.5)
    values[:3] *= inertia
    values[0] = max(values[0] - h * values[1], 0.0) if to == "implicit" else values[0]
    values[6] /= inertia if to == "damping-implicit" else 1.0
    return values


def _best(problem: Problem, model: Model) -> _Tried:
    interval = float((problem.t[-1] - problem.t[0]) / (problem.t.size - 1))
    interval, none = float(f"{interval:.9g}"), np.empty(0)
    tries = []
    for each in _STEPS_A_SAMPLE:
        for scheme in SCHEMES:
            for late in (False, True) if "a" in problem.channels else (False,):
                tries.append(_Tried(scheme, interval / each, each, late, _start(model, interval / each), none, none))
    first, second = (problem.part(slice(0, n)) for n in (_FIRST_LOOK, _SECOND_LOOK))
    looks = sorted((_fitted(t, first, model, _LOOKS) for t in tries), key=lambda t: t.chi2)
    return min((_fitted(t, second, model, _ROUNDS) for t in looks[:_FINALISTS]), key=lambda t: t.chi2)


def _start(model: Model, h: float) -> FloatArray:
    soft = model.find(SOFT)
    f = model.f_k / model.m
    v_r, lead = (h * f, h) if soft is None else (soft.value("v_r"), soft.value("lead"))
    offset = (model.offset,) if model.offset else ()
    return np.array([model.c / model.m, model.k / model.m, f, model.x0, model.v0, v_r, lead, *offset])


def _shown(tried: _Tried, values: FloatArray, problem: Problem, model: Model) -> dict[str, FloatArray]:
    """Channels (n, k) by the numbers of each column of ``values`` (q, k)."""
    pendulum = model.restoring is Restoring.PENDULUM
    motion = stepped(values[:7], tried.h, tried.each, tried.scheme, pendulum, tried.late, problem.t.size)
    every = {"x": motion.x + (values[_ZERO] if len(values) > _ZERO else 0.0), "v": motion.v, "a": motion.a}
    return {c: every[c] for c in problem.channels}


@dataclass(frozen=True)
class _Point:
    """A map's numbers (q,) in units of their size, and the whitened residual (n,) that they leave.

    seen : residuals (n, k) by the numbers of each column (q, k).
    """

    at: FloatArray
    seen: Callable[[FloatArray], FloatArray]

    @cached_property
    def residual(self) -> FloatArray:
        """What the numbers leave, (n,)."""
        return self.seen(self.at[:, None])[:, 0]

    @property
    def squares(self) -> float:
        """Chi-square."""
        return float(self.residual @ self.residual)

    @cached_property
    def partials(self) -> FloatArray:
        """Of the residual (n, q); differences serve, because a map is smooth where its friction is."""
        moved = self.seen(self.at[:, None] + _DIFFERENCE * np.eye(self.at.size))
        partials: FloatArray = (moved - self.residual[:, None]) / _DIFFERENCE
        return partials

    def normal_equations(self) -> tuple[FloatArray, FloatArray]:
        """By the numbers in units of their size."""
        return self.partials.T @ self.partials, -self.partials.T @ self.residual


def _fitted(tried: _Tried, problem: Problem, model: Model, rounds: int) -> _Tried:
    """Least squares of a map."""
    size = np.maximum(np.abs(tried.values), _sizes(tried.values))
    bounds = Bounds.of(size.size)
    bounds.lower[[0, 1, 2, 6]] = 0.0
    bounds.lower[5] = 1e-9

    def seen(scaled: FloatArray) -> FloatArray:
        shown = _shown(tried, scaled * size[:, None], problem, model)
        left = whitened(problem, {c: y[:, None] - shown[c] for c, y in problem.channels.items()})
        # a map that diverges is far off, not an error
        return np.clip(np.nan_to_num(left, nan=_FAR), -_FAR, _FAR)

    found = least_squares(lambda at: _Point(at, seen), tried.values / size, Until(_DONE, iterations=rounds), bounds)
    point = found.point
    return replace(tried, values=found.coordinates * size, residual=point.residual, jacobian=point.partials)


def _sizes(p: FloatArray) -> FloatArray:
    """What counts as one of each number where it is zero."""
    omega = np.sqrt(p[1])
    x = abs(p[3]) + abs(p[4]) / omega
    scale = np.array([0.01 * omega, p[1], 0.01 * p[1] * x, x, x * omega, 1e-3 * x * omega, 1e-3 / omega, x])
    return scale[: p.size]


def _is_noise(tried: _Tried, problem: Problem, omega: float) -> bool:
    n = problem.t.size
    parts = {c: slice(i * n, (i + 1) * n) for i, c in enumerate(problem.channels)}
    left = lack_of_fit(
        {c: tried.residual[at] for c, at in parts.items()},
        problem.t,
        omega,
        jacobian={c: tried.jacobian[at] for c, at in parts.items()},
    )
    return left.p_value > STRUCTURE.value


def _said(tried: _Tried, problem: Problem, model: Model) -> Stepping:
    p, m = tried.values, model.m
    soft = ModelTerm.named(SOFT, v_r=float(p[5]), lead=float(p[6]))
    stepped_model = replace(
        model, c=float(p[0]) * m, k=float(p[1]) * m, f_k=float(p[2]) * m, x0=float(p[3]), v0=float(p[4]), terms=(soft,)
    )
    within = p[6] <= STEPPED_WITHIN.value * tried.h and p[5] <= STEPPED_WITHIN.value * tried.h * p[2]
    return Stepping(
        tried.scheme, tried.h, tried.late, stepped_model, tried.chi2 / problem.points, within_a_step=bool(within)
    )


def _without_readings(found: Search, problem: Problem, start: Fit, stepping: Stepping, scales: Scales) -> Search:
    """The search's answer with soft friction alone, or with nothing where friction turns within a step."""
    base = under(found.base, problem)
    singles = tuple(sorted((under(f, problem) for f in found.singles), key=lambda f: f.bic))
    chosen = base
    if not stepping.within_a_step:
        names = base_of(base.free)
        names = names if "v0" in names else (*names, "v0")
        # v_r and lead as the steps give them: an exact motion would bend them to make up for the integrator
        model = replace(start.model, terms=stepping.model.terms)
        moved = fit(model, problem, free_of(replace(model, terms=()), names), scales)
        chosen = fit(moved.model, problem, free_of(model, names), scales, iterations=0, thorough=False)
    return Search(problem, base, chosen, singles, (), Left.NOISE)
