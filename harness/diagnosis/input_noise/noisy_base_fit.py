"""A base fit under the noise of its force, and what that noise does beyond first order, by simulation."""

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

import numpy as np

from harness.core.errors import SimulationError
from harness.diagnosis.fit.fitted_states import begun
from harness.diagnosis.fit.model_fit import Fit, fit, whitened
from harness.diagnosis.input_noise.propagation import as_it_shows, between, force_noise
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.problems.force_noise import FAR, ForceNoise
from harness.diagnosis.problems.simulated import COARSE, observe
from harness.diagnosis.rules import INPUT_NOISE_DRAWS
from harness.diagnosis.starts import Windows
from harness.kernels.solve import Scales

_TURNS = 6
"""Fits in turn with the noise they leave; most end after two."""
_SAME = 1e-3
"""Share of chi-square that changes nothing."""


def along(base: Fit, problem: Driven, scales: Scales) -> tuple[Driven, Fit]:
    """A problem with what its force's noise does along the motion of its base fit, and that fit under it."""
    if problem.force_noise is None:
        return problem, base
    problem, base = in_turn(problem, base, scales, lambda p, found: (p, fit(found.model, p, found.free, scales)))
    if problem.force_noise is not None and problem.force_noise.noise.found:
        beyond = beyond_first_order(base, problem, problem.force_noise, scales)
        problem = replace(problem, force_noise=replace(problem.force_noise, beyond=beyond))
    return problem, base


def in_turn(
    problem: Driven,
    found: Fit,
    scales: Scales,
    again: Callable[[Driven, Fit], tuple[Driven, Fit]],
    same: float = _SAME,
) -> tuple[Driven, Fit]:
    """What depends on a model's motion (starts of windows, what noise of a force does) and the fit, in turn.

    again : the problem and the fit of a turn, from those of the one before. Ends where chi-square stays within the
    share ``same``.
    """
    for _ in range(_TURNS):
        before = found.chi2
        problem, found = again(traced(problem, found, scales), found)
        if abs(found.chi2 - before) < same * before:
            break
    return problem, found


def traced(problem: Driven, found: Fit, scales: Scales) -> Driven:
    """The problem with its starts as a model has them, and what its force's noise does along that model's motion."""
    known = problem.force_noise
    if known is None:
        return problem
    problem = begun(problem, found.model, scales)
    moved = isinstance(problem.starts, Windows)
    shown = observe(found.model, problem, (), scales) if moved else found.shown
    start = known.start[np.searchsorted(known.t, problem.t)]
    told = known.as_told()
    unknown = problem.unknown * between(problem, told)
    force = force_noise(found.model, shown, problem.t, told, problem.noise, start, drive=problem.drive, between=unknown)
    force = None if force is None else as_it_shows(force, problem, shown)
    return replace(problem, force_noise=force if force is None else replace(force, beyond=known.beyond))


def beyond_first_order(base: Fit, problem: Driven, force: ForceNoise, scales: Scales) -> float:
    """Chi-square that noise of a force leaves beyond first order and what a fit takes: the most of some draws.

    Reversals come earlier or later, and slight ones become sticking. A sample on the other side of a jump counts as
    one that is far out, no more.
    """
    random, partials = np.random.default_rng(0), base.jacobian
    size = np.sqrt(np.sum(partials**2, axis=0))
    taken, _ = np.linalg.qr(partials[:, size > 0.0] / size[size > 0.0])
    # where the slider rests its noise was taken away
    known = problem.scatter is not None and problem.scatter.at(force.t) != 0.0
    found = []
    for _ in range(INPUT_NOISE_DRAWS.count):
        w = np.where(known, 0.0, force.noise.drawn(force.t.size, random))
        u = problem.drive.u + np.interp(problem.drive.t, force.t, w)
        with suppress(SimulationError):
            disturbed = observe(base.model, replace(problem, drive=replace(problem.drive, u=u)), (), scales, COARSE).y
            felt = force.felt(w)
            left = whitened(problem, {c: disturbed[c] - base.shown.y[c] - felt[c] for c in problem.channels})
            left = np.clip(left, -FAR, FAR)
            found.append(float(left @ left) - float(np.sum((taken.T @ left) ** 2)))
    return max(found, default=math.inf)
