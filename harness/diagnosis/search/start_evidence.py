"""Where the residual of a fit stands out: what terms choose their starting values from."""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.baseline.spectral_peaks import peaks
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import Problem
from harness.diagnosis.search.within_recording import fastest
from harness.kernels.solve import Scales
from harness.model.evidence import Evidence

_PEAKS = 48
_KNOCKS_PER_CYCLE = 12
_MOST_KNOCKS = 400
"""Frequencies and times that are tried: they bound the work."""
_HIGHEST = 12.0
"""Times the swing's frequency: a force further up hardly moves the slider (1/144 of what it would at rest)."""


def frequencies(fit: Fit, problem: Problem, omega: float) -> FloatArray:
    """Angular frequencies (rad/s) at which the whitened residual stands out, strongest first."""
    t = problem.t
    span = float(t[-1] - t[0])
    n = int(min(max(256, t.size), 1 << 16))
    grid = np.linspace(t[0], t[-1], n)
    power = np.zeros(2 * n + 1)
    for i in range(len(problem.channels)):
        part = fit.residual[i * t.size : (i + 1) * t.size]
        power += np.abs(np.fft.rfft(np.interp(grid, t, part), 4 * n)) ** 2
    step = 2.0 * math.pi * (n - 1) / (4.0 * n * span)
    tops = peaks(power)
    highest = min(_HIGHEST * omega, fastest(t))
    order = tops[(tops * step > math.pi / span) & (tops * step < highest)][:_PEAKS]
    # a slow or a resonant force hides below a peak of something else: a few fixed places besides
    fixed = omega * np.array([0.25, 0.5, 0.75, 0.9, 1.1, 1.3, 1.6, 2.0, 2.5, 3.0, 3.7, 4.5])
    return np.concatenate((order * step, fixed[fixed < highest]))


def evidence(fit: Fit, problem: Problem, scales: Scales) -> Evidence:
    """What the terms may look at."""
    t, model = problem.t, fit.model
    span = problem.duration
    count = int(min(_KNOCKS_PER_CYCLE * span * scales.omega / (2.0 * math.pi), _MOST_KNOCKS))
    knocks = np.linspace(t[0], t[0] + span, count + 2)[1:-1]
    peak = float(np.max(np.abs(problem.channels.get("a", fit.shown.a))))
    return Evidence(
        x_scale=float(np.max(np.abs(fit.shown.x))),
        v_scale=float(np.max(np.abs(fit.shown.v))),
        peak_a=peak,
        low=float(np.min(fit.shown.x)),
        high=float(np.max(fit.shown.x)),
        f_k=model.f_k,
        k=model.k,
        omega=scales.omega,
        duration=span,
        frequencies=frequencies(fit, problem, scales.omega),
        knock_times=knocks,
        driven="driven" in problem.given,
        angular=problem.angular,
    )
