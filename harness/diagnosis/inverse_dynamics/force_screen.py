"""Which laws of the catalogue would take most off what inverse dynamics leave of a force, with starting values."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.baseline.base_fit import peaks
from harness.diagnosis.inverse_dynamics.force_fit import ForceFit
from harness.diagnosis.inverse_dynamics.protocol import periods
from harness.diagnosis.parameters import free_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.measured import Measured
from harness.diagnosis.search.look import Recorded, within
from harness.diagnosis.search.screen import applicable, with_amplitudes
from harness.kernels.solve import Scales
from harness.model.model import Model, ModelTerm
from harness.model.registry import NAMED
from harness.model.term import Evidence, Probe, Slot, Term

_SLOTS = frozenset({Slot.SMOOTH, Slot.FRICTION_LAW, Slot.FRICTION_LEVEL, Slot.FRICTION_MODULATION, Slot.INTERNAL})
_PEAKS = 24
"""Frequencies of the force left over at which a law that repeats in time is tried."""
_KEPT = 2
"""Starts of a law that are fitted."""


def sayable(term: Term) -> bool:
    """Whether a law's force follows from the recorded motion: no event, no sensor."""
    return term.slot in _SLOTS


def seen_in(found: ForceFit, measured: Measured, problem: Problem, scales: Scales) -> Evidence:
    """What the laws choose their starts from: the recorded motion, and frequencies at which the residual stands out."""
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


def _periods(found: ForceFit, measured: Measured) -> list[float]:
    """Periods over the travel at which the force left over stands out, at the full rate: a fast pass has its ripple."""
    left = measured.u - measured.needed(found.model)
    moving = np.repeat(measured.moving, measured.t.size // measured.moving.size)
    return periods(measured.x[moving], left[moving])


def whole_in(model: Model, measured: Measured) -> bool:
    """Whether a period, the relaxation, or the bending of a model's last law lies in the recording whole."""
    return within(model.terms[-1], model.f_k, Recorded.of(measured.t, measured.x, driven=True))


def starts(found: ForceFit, measured: Measured, problem: Problem, scales: Scales) -> Iterator[Model]:
    """The model with one more law each, at its best probes."""
    evidence = seen_in(found, measured, problem, scales)
    q, _ = np.linalg.qr(found.jacobian / np.maximum(np.linalg.norm(found.jacobian, axis=0), 1e-300))
    for term in NAMED:
        if not sayable(term) or not applicable(term, found.model, problem):
            continue
        probes = list(term.probes(evidence))
        if term.amplitude is None:
            yield from (_with(found.model, term, p) for p in probes or ([()] if not term.parameters else []))
            continue
        width = 1 if term.phase is None else 2
        ranked = []
        for i in range(0, len(probes), width):
            group = probes[i : i + width]
            answers = np.column_stack([_answer(found, measured, term, p) for p in group])
            answers -= q @ (q.T @ answers)
            size = np.linalg.norm(answers, axis=0)
            if not np.all(np.isfinite(size)) or np.any(size <= 0.0):
                continue
            amplitudes = np.asarray(np.linalg.lstsq(answers, found.residual, rcond=1e-10)[0], dtype=np.float64)
            gain = float(found.residual @ answers @ amplitudes)
            ranked.append((gain, _within_bounds(term, with_amplitudes(term, group[0], amplitudes))))
        ranked.sort(key=lambda r: -r[0])
        yield from (_with(found.model, term, values) for _, values in ranked[:_KEPT])


def _with(model: Model, term: Term, values: Probe) -> Model:
    return replace(model, terms=(*model.terms, ModelTerm(term, values)))


def _answer(found: ForceFit, measured: Measured, term: Term, probe: Probe) -> FloatArray:
    """What a unit of the law's amplitude adds to the force asked for, (m,)."""
    model = _with(found.model, term, probe)
    last = (len(model.terms) - 1, term.amplitude)
    amplitude = tuple(f for f in free_of(model, ()) if f.by == last)
    return measured.even(measured.asked_by(model, amplitude)[1][:, 0])


def _within_bounds(term: Term, values: Probe) -> Probe:
    return tuple(min(max(v, p.lower), p.upper) for v, p in zip(values, term.parameters, strict=True))
