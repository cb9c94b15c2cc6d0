"""Driven recordings with known answers: filter, windows, noise, fits, and the published drive axis where it is."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.app.dataset import Emps
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.baseline import base_names, baseline
from harness.diagnosis.driven.force import inverse_force
from harness.diagnosis.driven.protocol import DIRECTED, PUBLISHED, SYMMETRIC
from harness.diagnosis.driven.ripple import find_ripple
from harness.diagnosis.driven.smooth import smoothed
from harness.diagnosis.driven.validate import Judge
from harness.diagnosis.driven.whiten import whiten_driven
from harness.diagnosis.fit import fit
from harness.diagnosis.observe import observe
from harness.diagnosis.parameters import free_of
from harness.diagnosis.prepare import Asked, prepare
from harness.diagnosis.search import noise_of, under
from harness.io.recording import ReadOptions, read_recording
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring

TRUTH = Model(2.0, 3.0, 0.0, 1.5, restoring=Restoring.NONE)
SPRUNG = Model(2.0, 3.0, 80.0, 1.5)


def driven(model: Model, seed: int = 1, sigma: float = 2e-6, push: float = 0.0, n: int = 6000) -> Recording:
    """A recording of a model pushed by a sum of slow waves; sigma : of x, m; push : white noise of the force, N."""
    draw = np.random.default_rng(seed)
    t = np.arange(n) / 1000.0
    waves = ((6.0, 3.1, 0.3), (4.0, 7.3, 1.1), (3.0, 14.0, 2.0))
    u = np.sum([a * np.sin(w * t + p) for a, w, p in waves], axis=0)
    x = solve(model, t, drive=Drive(t, u + push * draw.standard_normal(n))).x
    return Recording(t, {"x": x + sigma * draw.standard_normal(n), "u": u})


@pytest.mark.parametrize(
    ("truth", "restoring"), [(TRUTH, Restoring.NONE), (SPRUNG, Restoring.SPRING)], ids=["free axis", "spring"]
)
def test_driven_control_is_recovered_within_its_errors(truth: Model, restoring: Restoring) -> None:
    problem, notes = prepare(driven(truth), Asked(restoring))
    assert "windows of at most 1 s" in notes[0]
    found, scales = baseline(problem)
    problem = replace(problem, noise=noise_of(found, problem, scales.omega))
    found = fit(found.model, problem, found.free, scales)
    errors = np.sqrt(np.diag(found.covariance()))
    for name, value, error in zip(base_names(problem), found.values, errors, strict=True):
        assert abs(value - getattr(truth, name)) < 4.0 * error, name
        assert abs(value - getattr(truth, name)) < 0.01 * getattr(truth, name), name
    # two standard deviations of a chi-square over its degrees of freedom, doubled
    assert abs(found.chi2 / found.points - 1.0) < 4.0 * math.sqrt(2.0 / found.points)
    assert problem.noise["x"].sigma == pytest.approx(2e-6, rel=0.05)


def test_known_mass_is_not_fitted() -> None:
    problem, _ = prepare(driven(SPRUNG), Asked(mass=2.0))
    assert base_names(problem) == ("c", "k", "f_k")
    assert prepare(driven(SPRUNG), Asked())[0].in_newtons


def test_unknown_zero_is_found() -> None:
    recording = driven(SPRUNG)
    moved = Recording(recording.t, {"x": recording["x"] + 0.05, "u": recording["u"]})
    problem, _ = prepare(moved, Asked(zero_free=True))
    found, _ = baseline(problem)
    assert found.model.offset == pytest.approx(0.05, abs=2e-4)


def test_noise_of_the_force_is_told_from_that_of_the_sensor() -> None:
    problem, _ = prepare(driven(TRUTH, push=0.5), Asked(Restoring.NONE))
    found, scales = baseline(problem)
    problem = replace(problem, noise=noise_of(found, problem, scales.omega))
    refitted = fit(found.model, problem, found.free, scales)
    quiet = prepare(driven(TRUTH), Asked(Restoring.NONE))[0]
    still, _ = baseline(quiet)
    assert problem.noise["u"].sigma > 20.0 * noise_of(still, quiet, scales.omega)["u"].sigma
    assert refitted.chi2 / refitted.points == pytest.approx(1.0, abs=0.1)
    errors = np.sqrt(np.diag(refitted.covariance()))
    assert np.all(np.abs(refitted.values - np.array([2.0, 3.0, 1.5])) < 4.0 * errors)


def test_direction_dependent_friction_beats_the_base_and_has_its_value() -> None:
    truth = replace(TRUTH, terms=(ModelTerm.named("asymmetric-viscous", c_diff=0.6),))
    problem, _ = prepare(driven(truth), Asked(Restoring.NONE))
    found, scales = baseline(problem)
    model = replace(found.model, terms=(ModelTerm.named("asymmetric-viscous", c_diff=0.0),))
    better = fit(model, problem, free_of(model, base_names(problem)), scales)
    problem = replace(problem, noise=noise_of(better, problem, scales.omega))
    better, before = fit(better.model, problem, better.free, scales), under(found, problem)
    assert before.bic - better.bic > 1000.0
    assert better.model.terms[0].values[0] == pytest.approx(0.6, rel=0.02)


@pytest.mark.parametrize(
    "terms",
    [
        (),
        (ModelTerm.named("asymmetric-viscous", c_diff=0.4),),
        (ModelTerm.named("presliding", sigma0=4e4, sigma1=5.0),),
        (ModelTerm.named("viscoelastic", k_m=30.0, tau=0.2),),
    ],
    ids=lambda terms: terms[0].term.key if terms else "base",
)
def test_partials_over_windows_are_those_of_central_differences(terms: tuple[ModelTerm, ...]) -> None:
    model = replace(TRUTH, terms=terms)
    problem, _ = prepare(driven(model, n=2500), Asked(Restoring.NONE))
    free = free_of(model, ("m", "c", "f_k"))
    by = tuple(f.by for f in free)
    shown = observe(model, problem, by).dy["x"]
    from harness.diagnosis.parameters import values_of, with_values

    values = values_of(model, free)
    for i, value in enumerate(values):
        step = 1e-4 * max(abs(value), 1e-2)
        low, high = values.copy(), values.copy()
        low[i], high[i] = value - step, value + step
        ends = [observe(with_values(model, free, v), problem).y["x"] for v in (low, high)]
        numeric = (ends[1] - ends[0]) / (2.0 * step)
        size = np.max(np.abs(numeric)) + 1e-12
        assert np.quantile(np.abs(shown[:, i] - numeric), 0.98) < 0.02 * size, free[i].name


def test_innovations_of_simulated_errors_are_white() -> None:
    """The filter's own error model, simulated: innovations of unit variance, none correlated with the next."""
    problem, _ = prepare(driven(TRUTH, n=4000), Asked(Restoring.NONE))
    draw = np.random.default_rng(5)
    noise = {"x": replace(problem.noise["x"], sigma=1e-5), "u": replace(problem.noise["u"], sigma=1.0)}
    problem = replace(problem, noise=noise)
    assert problem.restarts is not None
    first, residual = problem.restarts.first, np.empty(problem.t.size)
    phi, h = noise["u"].phi, 1e-3
    for w in problem.restarts.windows:
        x, v, d = 10.0 * w.x_sd * draw.standard_normal(), 10.0 * w.v_sd * draw.standard_normal(), draw.standard_normal()
        for n in range(w.start, w.stop):
            residual[n] = x + 1e-5 * draw.standard_normal()
            after = phi * d + math.sqrt(1.0 - phi**2) * draw.standard_normal()
            a = 0.5 * (d + after) / first.m - first.c / first.m * v
            x, v, d = x + h * v + 0.5 * h * h * a, v + h * a, after
    white, _ = whiten_driven(problem, {"x": residual})
    assert np.mean(white**2) == pytest.approx(1.0, abs=4.0 * math.sqrt(2.0 / white.size))
    assert abs(np.mean(white[1:] * white[:-1])) < 4.0 / math.sqrt(white.size)


def test_windows_cover_every_sample_once_and_span_no_gap() -> None:
    recording = driven(TRUTH)
    keep = (recording.t < 2.0) | (recording.t > 2.6)
    cut = Recording(recording.t[keep], {c: recording[c][keep] for c in ("x", "u")})
    problem, _ = prepare(cut, Asked(Restoring.NONE, horizon=0.7))
    assert problem.restarts is not None
    windows = problem.restarts.windows
    assert [w.start for w in windows[1:]] == [w.stop for w in windows[:-1]]
    assert (windows[0].start, windows[-1].stop) == (0, problem.t.size)
    for w in windows:
        assert problem.t[w.stop - 1] - w.t0 < 0.71
    thin = problem.part(slice(100, None, 7))
    assert thin.restarts is not None
    assert sum(w.stop - w.start for w in thin.restarts.windows) == thin.t.size


def test_smoothing_of_a_cubic_is_exact() -> None:
    t = np.sort(np.random.default_rng(3).uniform(0.0, 2.0, 400))
    found = smoothed(t, 1.0 + t - 2.0 * t**2 + 0.5 * t**3, 1.0, 1e-9)
    assert np.max(np.abs(found.slope - (1.0 - 4.0 * t + 1.5 * t**2))) < 1e-7
    assert np.max(np.abs(found.bend - (-4.0 + 3.0 * t))) < 1e-4


def test_inverse_force_is_the_drive_of_the_motion() -> None:
    model = replace(SPRUNG, terms=(ModelTerm.named("asymmetric-viscous", c_diff=0.4),))
    t = np.arange(3000) / 1000.0
    u = 9.0 * np.sin(3.0 * t) + 5.0 * np.sin(8.0 * t)
    found = solve(model, t, drive=Drive(t, u))
    sliding = found.mode != 0
    force = inverse_force(model, t, found.x, found.v, found.a)
    assert np.max(np.abs(force - u)[sliding]) < 1e-6


@pytest.mark.parametrize(
    ("channels", "asked", "message"),
    [
        (("v", "u"), Asked(), "a driven recording whose state cannot be seen"),
        (("a", "u"), Asked(), "a driven recording whose state cannot be seen"),
        (("x",), Asked(Restoring.NONE), "none, but no force u is recorded"),
        (("x", "u"), Asked(Restoring.NONE, horizon=0.01), "--horizon: 0.01 s"),
    ],
)
def test_what_cannot_be_done_is_refused(channels: tuple[str, ...], asked: Asked, message: str) -> None:
    recording = driven(TRUTH, n=500)
    values = {c: recording["x" if c != "u" else "u"] for c in channels}
    with pytest.raises(InputError, match=message):
        prepare(Recording(recording.t, values), asked)


COLUMNS = ReadOptions("t=t,x=qm,u=vir*gtau[N]")


@pytest.fixture(scope="module")
def axis(recordings: Path) -> Judge:
    """The two files of the drive axis."""
    files = [recordings / "emps" / name for name in ("DATA_EMPS.mat", "DATA_EMPS_PULSES.mat")]
    judge = Judge.of(*(read_recording(file, COLUMNS) for file in files))
    assert judge is not None
    return judge


def test_published_protocol_is_reproduced(axis: Judge) -> None:
    values, errors = PUBLISHED.least_squares(SYMMETRIC, axis.fitted, axis.other)
    assert errors == pytest.approx((4.035, 5.952), abs=6e-4)
    assert values["M"] == pytest.approx(95.11, abs=0.05)
    _, errors = PUBLISHED.least_squares(DIRECTED, axis.fitted, axis.other)
    assert errors == pytest.approx((3.051, 5.336), abs=1e-3)


def test_ripple_of_the_screw_is_in_each_file(axis: Judge) -> None:
    values, _ = PUBLISHED.least_squares(DIRECTED, axis.fitted, axis.other)
    turned = ModelTerm.named("asymmetric-viscous", c_diff=values["Fv_diff"])
    model = Model(values["M"], values["Fv"], 0.0, values["Fc"], restoring=Restoring.NONE, terms=(turned,))
    for recording in (axis.fitted, axis.other):
        found = find_ripple(model, recording)
        assert found.period == pytest.approx(2.5e-3, rel=2e-3)
        assert found.contrast > 50.0


def test_files_that_are_not_the_published_ones_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"DATA_EMPS\.mat: no such file"):
        Emps.from_folder(tmp_path)
    (tmp_path / "DATA_EMPS.mat").write_bytes(b"something else")
    with pytest.raises(InputError, match="sha256"):
        Emps.from_folder(tmp_path)
