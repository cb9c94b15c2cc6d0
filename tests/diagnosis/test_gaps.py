"""Driven recordings with gaps, or cut into windows: nothing counts as known of how a stretch starts."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.core.arrays import BoolArray
from harness.core.recording import Recording
from harness.diagnosis.baseline.base_fit import driven_baseline
from harness.diagnosis.fit.fitted_states import begun
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.observe import observe
from harness.diagnosis.input_noise.noisy_base_fit import along
from harness.diagnosis.pipeline import diagnose, prepare
from harness.diagnosis.prepare.intersample_curve import between_samples
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.problems.starts import OneStart, Windows
from harness.diagnosis.request import Asked
from harness.diagnosis.search.search import noise_of
from harness.kernels.solve import Drive, Scales, solve
from harness.model.model import Model, ModelTerm, Restoring

AXIS = Model(2.0, 3.0, 0.0, 1.5, restoring=Restoring.NONE)
SPRING = replace(AXIS, k=80.0, restoring=Restoring.SPRING)
GAPS = ((1.1, 1.16), (2.5, 2.9), (4.2, 4.23))
SIGMA = 2e-5


def recorded(model: Model, gaps: tuple[tuple[float, float], ...] = GAPS, n: int = 3000) -> Recording:
    """A recording of a model pushed by a sum of slow waves, without its samples in the gaps (s)."""
    t, fine = np.arange(n) / 500.0, np.arange(16 * n) / 8000.0
    waves = ((6.0, 3.1, 0.3), (4.0, 7.3, 1.1), (3.0, 14.0, 2.0))
    u = np.sum([a * np.sin(w * fine + p) for a, w, p in waves], axis=0)
    x = solve(model, t, drive=Drive(fine, u)).x + SIGMA * np.random.default_rng(4).standard_normal(n)
    keep: BoolArray = np.all([(t < low) | (t > high) for low, high in gaps], axis=0) if gaps else np.ones(n, dtype=bool)
    return Recording(t[keep], {"x": x[keep], "u": u[::16][keep]})


def fitted(recording: Recording, asked: Asked) -> tuple[Driven, Fit, Scales]:
    """The base model along its own motion, under the noise that it leaves."""
    problem, _ = prepare(recording, asked)
    assert isinstance(problem, Driven)
    base, scales = driven_baseline(problem)
    problem, base = along(base, problem, scales)
    problem = replace(problem, noise=noise_of(base, problem, scales.omega))
    return problem, fit(base.model, problem, base.free, scales), scales


@pytest.mark.parametrize("truth", [AXIS, SPRING], ids=["free axis", "spring"])
@pytest.mark.parametrize(
    ("gaps", "horizon", "windows"), [(GAPS, None, 4), ((), 1.0, 6), (GAPS, 1.0, 8)], ids=["gaps", "horizon", "both"]
)
def test_a_control_is_recovered_to_its_noise(
    truth: Model, gaps: tuple[tuple[float, float], ...], horizon: float | None, windows: int
) -> None:
    problem, found, _ = fitted(recorded(truth, gaps), Asked(truth.restoring, horizon=horizon))
    assert isinstance(problem, Driven)
    assert isinstance(problem.starts, Windows)
    assert len(problem.starts.windows) == windows
    assert problem.noise["x"].sigma == pytest.approx(SIGMA, rel=0.05)
    assert abs(found.chi2 / found.points - 1.0) < 4.0 * math.sqrt(2.0 / found.points)
    errors = np.sqrt(np.diag(found.covariance()))
    for f, value, error in zip(found.free, found.values, errors, strict=True):
        assert abs(value - getattr(truth, f.name)) < 4.0 * error, f.name
        assert error < 0.05 * getattr(truth, f.name), f.name


def test_starts_are_found_from_what_follows_them() -> None:
    truth = SPRING
    problem, _ = prepare(recorded(truth), Asked())
    assert isinstance(problem.starts, Windows)
    windows = problem.starts.windows
    moved = tuple(replace(w, x0=w.x0 + 3e-4, v0=w.v0 - 3e-3, x_sd=1e-3, v_sd=1e-2) for w in windows)
    again = begun(
        replace(problem, starts=replace(problem.starts, windows=moved)), truth, Scales.of(truth, problem.drive)
    )
    exact = solve(truth, np.array([0.0, *(w.t0 for w in windows[1:])]), drive=_drive())
    assert isinstance(again.starts, Windows)
    for i, w in enumerate(again.starts.windows):
        assert abs(w.x0 - exact.x[i]) < 4.0 * w.x_sd < 1e-4
        assert abs(w.v0 - exact.v[i]) < 4.0 * w.v_sd
        assert w.v_sd < 2.5e-3 or w.v0 == exact.v[i] == 0.0


def _drive() -> Drive:
    fine = np.arange(16 * 3000) / 8000.0
    waves = ((6.0, 3.1, 0.3), (4.0, 7.3, 1.1), (3.0, 14.0, 2.0))
    return Drive(fine, np.sum([a * np.sin(w * fine + p) for a, w, p in waves], axis=0))


def test_where_a_window_starts_counts_for_nothing() -> None:
    problem, found, scales = fitted(recorded(SPRING), Asked())
    assert isinstance(problem.starts, Windows)
    assert problem.force_noise is not None
    w = problem.starts.windows[1]
    model = replace(found.model, x0=w.x0, v0=w.v0, t0=w.t0)
    part = replace(problem.part(slice(w.start, w.stop)), starts=OneStart(), force_noise=None)
    by_start = observe(model, part, ("x0", "v0"), scales).dy["x"]
    out = np.zeros((problem.t.size, 2))
    out[w.start : w.stop] = by_start / np.abs(by_start).max(axis=0)
    white, _ = problem.force_noise.whitened(problem.t, problem.noise, problem.weight, {"x": out})
    # as good as nothing, next to what white noise would make of them
    assert np.linalg.norm(white["x"], axis=0) * SIGMA == pytest.approx(np.zeros(2), abs=0.01)
    assert np.all(np.linalg.norm(out, axis=0) > 1.0)


@pytest.mark.slow
def test_an_effect_is_named_over_gaps() -> None:
    truth = replace(AXIS, terms=(ModelTerm.named("asymmetric-viscous", c_diff=0.4),))
    dense = recorded(truth)
    thin = Recording(dense.t[::4], {c: dense[c][::4] for c in ("x", "u")})
    outcome = diagnose(prepare(thin, Asked(Restoring.NONE))[0])
    assert outcome.verdict == "missing_physics"
    (named,) = outcome.mechanisms
    assert named.entry.term.name == "asymmetric-viscous"
    c_diff = named.parameters["c_diff"]
    assert c_diff.value is not None
    assert c_diff.stderr is not None
    assert abs(c_diff.value - 0.4) < 4.0 * c_diff.stderr


def test_a_force_is_straight_where_nobody_recorded_it() -> None:
    t = np.concatenate((np.arange(100) * 0.01, 3.0 + np.arange(100) * 0.01))
    u = np.sin(3.0 * t)
    drive = between_samples(t, u, 0.05)
    within = np.linspace(t[99], t[100], 7)
    assert np.interp(within, drive.t, drive.u) == pytest.approx(np.interp(within, t, u), abs=1e-5)
    fine = np.concatenate((np.linspace(0.0, 0.99, 999), np.linspace(3.0, 3.99, 999)))
    # pieces of a curve: a quarter of an interval's chord is missed by h^2 / 8 of its bend
    assert np.max(np.abs(np.interp(fine, drive.t, drive.u) - np.sin(3.0 * fine))) < 9.0 * 0.0025**2 / 4.0
