"""Which laws of the catalogue would take most off what inverse dynamics leave of a force, with starting values."""

import math

import numpy as np

from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.inverse_dynamics.protocol import periods
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.measured import Measured
from harness.diagnosis.search.look import Recorded, within
from harness.diagnosis.search.screen import direct, screen
from harness.fit.along_travel import peaks
from harness.kernels.solve import Scales
from harness.model.model import Model
from harness.model.registry import NAMED
from harness.model.term import Evidence, Slot, Term

_SLOTS = frozenset({Slot.SMOOTH, Slot.FRICTION_LAW, Slot.FRICTION_LEVEL, Slot.FRICTION_MODULATION, Slot.INTERNAL})
_PEAKS = 24
"""Frequencies of the force left over at which a law that repeats in time is tried."""


def sayable(term: Term) -> bool:
    """Whether a law's force follows from the recorded motion: no event, no sensor."""
    return term.slot in _SLOTS


def seen_in(found: Fit, problem: InverseDynamics, scales: Scales) -> Evidence:
    """What the laws choose their starts from: the recorded motion, and frequencies at which the residual stands out."""
    measured = problem.measured
    every = np.zeros(measured.moving.size)
    every[measured.moving] = found.residual
    times = measured.t.reshape(measured.moving.size, -1).mean(axis=1)
    step = float(np.median(np.diff(times)))
    power = np.abs(np.fft.rfft(every * np.hanning(every.size), 4 * every.size)) ** 2
    tops = peaks(power)[:_PEAKS]
    x, v = measured.x, measured.v
    return Evidence(
        x_scale=float(np.max(np.abs(x))),
        v_scale=float(np.max(np.abs(v))),
        peak_a=float(np.max(np.abs(measured.a))),
        low=float(x.min()),
        high=float(x.max()),
        f_k=found.model.f_k,
        k=found.model.k,
        omega=scales.omega,
        duration=float(measured.t[-1] - measured.t[0]),
        frequencies=np.asarray(2.0 * math.pi * tops / (4.0 * every.size * step), dtype=np.float64),
        knock_times=np.empty(0),
        driven=True,
        angular=problem.angular,
        periods=tuple(_periods(found, measured)),
    )


def _periods(found: Fit, measured: Measured) -> list[float]:
    """Periods over the travel at which the force left over stands out, at the full rate: a fast pass has its ripple."""
    left = measured.u - measured.needed(found.model)
    moving = np.repeat(measured.moving, measured.t.size // measured.moving.size)
    return periods(measured.x[moving], left[moving])


def whole_in(model: Model, measured: Measured) -> bool:
    """Whether a period, the relaxation, or the bending of a model's last law lies in the recording whole."""
    return within(model.terms[-1], model.f_k, Recorded.of(measured.t, measured.x, driven=True))


def starts(found: Fit, problem: InverseDynamics, scales: Scales) -> list[Model]:
    """The model with one more law each, at its best probes; first those of which no look can tell."""
    evidence = seen_in(found, problem, scales)
    terms = [term for term in NAMED if sayable(term)]
    looked = (*direct(found, problem, evidence, terms), *screen(found, problem, evidence, scales, terms))
    return [candidate.model for candidate in looked]
