"""Noise of a driven recording: of each sensor, and of the force, by maximum likelihood of what a fit leaves.

The force's noise is whatever pushes beside what was measured and is not in the model. Its level comes from the
innovations, so that a model is judged against what the recording itself cannot repeat, not against the sensor alone. It
is taken as white up to the sampling rate: a push that lasts longer is physics to be found, and must not be noise.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.driven.whiten import whiten_driven
from harness.diagnosis.problem import Problem
from harness.estimate.noise import FLOOR, Noise, channel_noise, quantisation_step

_FIRST_SHARE = 0.03
"""First guess of the force's noise, as a share of its rms."""
_PHI = math.exp(-1.0)
"""Its correlation from one sample to the next: one interval is its correlation time."""
_NOTHING = 1e-6
"""Share of a channel's rms at which a search for its noise ends: there is none."""
_SAMPLES = 30_000
_EVALUATIONS = 80


def first_noise(t: FloatArray, channels: Mapping[str, FloatArray], u: FloatArray) -> dict[str, Noise]:
    """Noise of the channels (n,) from themselves and a guess for the force's, from which to start. t : s."""
    noise = {c: replace(channel_noise(t, y), phi=0.0) for c, y in channels.items()}
    rms = math.sqrt(float(np.mean(u**2)))
    noise["u"] = Noise(_FIRST_SHARE * rms, True, _PHI, quantisation_step(u))
    return noise


def _sane(problem: Problem) -> Problem:
    """As much of the recording as a likelihood needs."""
    return problem.part(slice(0, _SAMPLES)) if problem.t.size > _SAMPLES else problem


def driven_noise(problem: Problem, residual: Mapping[str, FloatArray]) -> dict[str, Noise]:
    """Noise of channels and force ("u") from the residuals (n,) of a fit; levels not below step^2/12 nor the floor.

    Colour beyond the force's is not looked for.
    """
    from scipy.optimize import minimize

    assert problem.restarts is not None
    assert problem.drive is not None
    part = _sane(problem)
    left = {c: residual[c][: part.t.size] for c in part.channels}
    names = [*part.channels, "u"]
    values = {**part.channels, "u": problem.drive.u}
    least = {}
    for c in names:
        step = problem.noise[c].step
        rms = math.sqrt(float(np.mean((values[c] - (0.0 if c == "u" else values[c].mean())) ** 2)))
        least[c] = max(step / math.sqrt(12.0), _NOTHING * rms)

    def at(theta: FloatArray) -> dict[str, Noise]:
        noise = {}
        for c, value in zip(names, theta, strict=True):
            sigma = max(math.exp(min(value, 300.0)), least[c])
            noise[c] = replace(problem.noise[c], sigma=sigma, found=True)
        return noise

    def cost(theta: FloatArray) -> float:
        white, logs = whiten_driven(replace(part, noise=at(theta)), left)
        # bounds are walls with a slope, so that a simplex finds its way back
        over = sum(max(0.0, math.log(least[c]) - v) for c, v in zip(names, theta, strict=True))
        return float(0.5 * (float(white @ white) + logs) + over)

    start = np.array([math.log(max(problem.noise[c].sigma, least[c])) for c in names])
    found = minimize(
        cost,
        start,
        method="Nelder-Mead",
        options={"maxfev": _EVALUATIONS, "xatol": 5e-3, "fatol": 0.05, "initial_simplex": _simplex(start)},
    )
    noise = at(found.x)
    for c in names:
        if problem.noise[c].step == 0.0 and noise[c].sigma < 1.5 * least[c]:
            # none to speak of: the floor, whose size is a convention
            noise[c] = replace(noise[c], sigma=noise[c].sigma * FLOOR / _NOTHING, found=False)
    return noise


def _simplex(start: FloatArray) -> FloatArray:
    """A simplex of half a unit (a factor of 1.6) around the start."""
    corners: FloatArray = np.vstack([start, start + 0.5 * np.eye(start.size)])
    return corners
