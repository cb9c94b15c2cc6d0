"""Driven recordings with known answers: filter, windows, noise, fits, and the published drive axis where it is."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.app.dataset import PUBLISHED_DIRECTED_ERROR, PUBLISHED_SYMMETRIC, Emps
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.baseline.base_fit import driven_baseline
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.inverse_dynamics.protocol import DIRECTED, PUBLISHED, SYMMETRIC, find_ripple
from harness.diagnosis.inverse_dynamics.search import force_baseline
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.parameters import free_of
from harness.diagnosis.pipeline import diagnose, prepare
from harness.diagnosis.prepare.driven import forced_problem
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.request import Asked
from harness.diagnosis.search.search import noise_of, under
from harness.diagnosis.smoothed_state.local_cubics import smoothed
from harness.diagnosis.starts import Windows
from harness.fit.series import standing_out
from harness.io.options import ReadOptions
from harness.io.recording import read_recording
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring

TRUTH = Model(2.0, 3.0, 0.0, 1.5, restoring=Restoring.NONE)
SPRUNG = Model(2.0, 3.0, 80.0, 1.5)


def driven(model: Model, seed: int = 1, sigma: float = 2e-6, n: int = 1500) -> Recording:
    """A recording of a model pushed by a sum of slow waves, which act between the samples too; sigma : of x, m."""
    draw = np.random.default_rng(seed)
    t, fine = np.arange(n) / 250.0, np.arange(16 * n) / 4000.0
    waves = ((6.0, 3.1, 0.3), (4.0, 7.3, 1.1), (3.0, 14.0, 2.0))
    u = np.sum([a * np.sin(w * fine + p) for a, w, p in waves], axis=0)
    x = solve(model, t, drive=Drive(fine, u)).x
    return Recording(t, {"x": x + sigma * draw.standard_normal(n), "u": u[::16]})


@pytest.mark.parametrize(
    ("truth", "restoring"), [(TRUTH, Restoring.NONE), (SPRUNG, Restoring.SPRING)], ids=["free axis", "spring"]
)
def test_driven_control_is_recovered_within_its_errors(truth: Model, restoring: Restoring) -> None:
    problem, notes = prepare(driven(truth), Asked(restoring))
    assert "followed from one start" in notes[0]
    assert isinstance(problem, Driven)
    found, scales = driven_baseline(problem)
    problem = replace(problem, noise=noise_of(found, problem, scales.omega))
    found = fit(found.model, problem, found.free, scales)
    errors = np.sqrt(np.diag(found.covariance()))
    for f, value, error in zip(found.free, found.values, errors, strict=True):
        assert abs(value - getattr(truth, f.name)) < 4.0 * error, f.name
        if f.name in ("m", "c", "k", "f_k"):
            assert abs(value - getattr(truth, f.name)) < 0.01 * getattr(truth, f.name), f.name
    # two standard deviations of a chi-square over its degrees of freedom, doubled
    assert abs(found.chi2 / found.points - 1.0) < 4.0 * math.sqrt(2.0 / found.points)
    assert problem.noise["x"].sigma == pytest.approx(2e-6, rel=0.05)


def test_unknown_zero_is_found() -> None:
    recording = driven(SPRUNG)
    moved = Recording(recording.t, {"x": recording["x"] + 0.05, "u": recording["u"]})
    problem, _ = prepare(moved, Asked(zero_free=True))
    assert isinstance(problem, Driven)
    found, _ = driven_baseline(problem)
    assert found.model.offset == pytest.approx(0.05, abs=2e-4)


def test_force_is_fitted_over_windows_within_errors_that_allow_for_colour() -> None:
    """A force that nobody measured, correlated over 20 samples: every number within four of its standard errors."""
    t = np.arange(6000) / 500.0
    draw = np.random.default_rng(7)
    unseen = np.zeros(t.size)
    for i in range(1, t.size):
        unseen[i] = 0.95 * unseen[i - 1] + 0.14 * draw.standard_normal()
    u = 6.0 * np.sin(3.1 * t) + 4.0 * np.sin(7.3 * t + 1.1) + 3.0 * np.sin(14.0 * t + 2.0)
    x = solve(TRUTH, t, drive=Drive(t, u + unseen)).x
    recording = Recording(t, {"x": x + 1e-7 * draw.standard_normal(t.size), "u": u})
    problem, notes = forced_problem(recording, Asked(Restoring.NONE))
    assert "windows of at most 1 s" in notes[0]
    found = fit(problem.first, problem, free_of(problem.first, problem.base_names))
    errors = np.sqrt(np.diag(found.covariance()))
    assert np.all(np.abs(found.model.m - 2.0) < 4.0 * errors[0])
    assert np.all(np.abs(np.array([found.model.c, found.model.f_k]) - (3.0, 1.5)) < 4.0 * errors[1:])
    assert found.memory.independent < 0.5 * found.residual.size


def test_ripple_of_a_fast_axis_is_found_over_its_travel() -> None:
    t = np.arange(20_000) / 1000.0
    x = 0.1 * np.sin(2.0 * t) + 0.02 * np.sin(5.3 * t)
    force = 0.5 * np.cos(2.0 * np.pi * x / 0.0031 + 0.4) + np.random.default_rng(1).standard_normal(t.size)
    assert standing_out(x, force, 1.5, 400.0)[0] == pytest.approx(0.0031, rel=5e-3)


def test_direction_dependent_friction_beats_the_base_and_has_its_value() -> None:
    truth = replace(TRUTH, terms=(ModelTerm.named("asymmetric-viscous", c_diff=0.6),))
    problem, _ = forced_problem(driven(truth), Asked(Restoring.NONE))
    found, scales = force_baseline(problem)
    model = replace(found.model, terms=(ModelTerm.named("asymmetric-viscous", c_diff=0.0),))
    better = fit(model, problem, free_of(model, problem.base_names), scales)
    problem = problem.levelled(better.residual, better.memory.independent)
    better, before = fit(better.model, problem, better.free, scales), under(found, problem)
    assert before.bic - better.bic > 1000.0
    assert better.model.terms[0].values[0] == pytest.approx(0.6, rel=0.02)


def test_an_axis_is_followed_however_fine_its_encoder_is() -> None:
    """By its force, which a controller holds, the base model's c would be as uncertain as all of c_diff."""
    truth = replace(TRUTH, terms=(ModelTerm.named("asymmetric-viscous", c_diff=0.02),))
    draw, t = np.random.default_rng(3), np.arange(3000) / 500.0
    u = 6.0 * np.sin(3.1 * t + 0.3) + 4.0 * np.sin(7.3 * t + 1.1) + 3.0 * np.sin(14.0 * t + 2.0)
    x = solve(truth, t, drive=Drive(t, u, held=True)).x
    count = float(np.ptp(x)) / 2e5
    seen = Recording(t, {"x": count * np.round(x / count), "u": u + 1e-3 * draw.standard_normal(t.size)})
    problem, _ = prepare(seen, Asked(Restoring.NONE))
    assert isinstance(problem, Driven)
    outcome = diagnose(problem)
    assert [m.name for m in outcome.mechanisms] == ["asymmetric-viscous"]
    (found,) = outcome.mechanisms[0].parameters.values()
    assert found.value == pytest.approx(0.02, abs=3.0 * (found.stderr or 0.0))
    assert found.stderr is not None
    assert found.stderr < 1e-3
    for name, value in (("mass", 2.0), ("c", 3.0), ("f_k", 1.5)):
        told = outcome.refined_parameters[name]
        assert told.value == pytest.approx(value, abs=3.0 * (told.stderr or 0.0))
        assert told.value == pytest.approx(value, rel=1e-3)


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
    problem, _ = prepare(driven(model, n=625), Asked(Restoring.NONE, horizon=1.0))
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


def test_windows_cover_every_sample_once_and_span_no_gap() -> None:
    recording = driven(TRUTH)
    keep = (recording.t < 2.0) | (recording.t > 2.6)
    cut = Recording(recording.t[keep], {c: recording[c][keep] for c in ("x", "u")})
    problem, _ = prepare(cut, Asked(Restoring.NONE, horizon=0.7))
    assert isinstance(problem.starts, Windows)
    windows = problem.starts.windows
    assert [w.start for w in windows[1:]] == [w.stop for w in windows[:-1]]
    assert (windows[0].start, windows[-1].stop) == (0, problem.t.size)
    for w in windows:
        assert problem.t[w.stop - 1] - w.t0 < 0.71
    thin = problem.part(slice(100, None, 7))
    assert isinstance(thin.starts, Windows)
    assert sum(w.stop - w.start for w in thin.starts.windows) == thin.t.size


def test_smoothing_of_a_cubic_is_exact() -> None:
    t = np.sort(np.random.default_rng(3).uniform(0.0, 2.0, 400))
    found = smoothed(t, 1.0 + t - 2.0 * t**2 + 0.5 * t**3, 1.0, 1e-9)
    assert np.max(np.abs(found.slope - (1.0 - 4.0 * t + 1.5 * t**2))) < 1e-7
    assert np.max(np.abs(found.bend - (-4.0 + 3.0 * t))) < 1e-4


@pytest.mark.parametrize(
    ("channels", "asked", "message"),
    [
        (("v", "u"), Asked(), "a driven speed without a position.*Try: --restoring none"),
        (("a", "u"), Asked(), "a driven recording whose state cannot be seen"),
        (("x",), Asked(Restoring.NONE), "none, but no force u is recorded"),
        (("x", "u"), Asked(Restoring.NONE, horizon=0.01), "--horizon: 0.01 s"),
    ],
)
def test_what_cannot_be_done_is_refused(channels: tuple[str, ...], asked: Asked, message: str) -> None:
    recording = driven(TRUTH, n=125)
    values = {c: recording["x" if c != "u" else "u"] for c in channels}
    values = {c: y - (np.mean(y) if c == "v" else 0.0) for c, y in values.items()}
    with pytest.raises(InputError, match=message):
        prepare(Recording(recording.t, values), asked)


def test_a_rotor_that_is_driven_one_way_needs_no_position() -> None:
    t = np.linspace(0.0, 4.0, 800)
    u = 0.3 + 0.25 * np.sin(2.0 * t) + 0.2 * np.sin(7.0 * t)
    v = np.zeros(t.size)
    for k in range(1, t.size):  # inertia .02, viscous .01, Coulomb .05
        v[k] = v[k - 1] + (t[1] - t[0]) * (u[k - 1] - 0.01 * v[k - 1] - 0.05) / 0.02
    noise = 0.02 * np.random.default_rng(2).standard_normal(t.size)
    assert np.all(v >= 0.0)
    found, notes = prepare(Recording(t, {"v": v + noise, "u": u}, angular=True), Asked())
    assert "nothing pulls it back" in " ".join(notes)
    assert isinstance(found, Driven)


def test_a_driven_slider_that_never_moves_is_refused() -> None:
    random = np.random.default_rng(1)
    t: FloatArray = np.arange(2000.0) * 1e-3
    still = Recording(t, {"x": 1e-6 * random.standard_normal(t.size), "u": np.sin(5.0 * t)})
    with pytest.raises(InputError, match="a slider that does not move beyond its noise"):
        prepare(still, Asked())


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
    *known, fit, cross = PUBLISHED_SYMMETRIC
    # the protocol as it stands here leaves a little less than was published: 1.2 and 0.5 % of it
    assert 0.98 * fit <= errors[0] <= fit
    assert 0.99 * cross <= errors[1] <= cross
    assert values["M"] == pytest.approx(known[0], abs=0.05)
    _, directed = PUBLISHED.least_squares(DIRECTED, axis.fitted, axis.other)
    assert 0.975 * PUBLISHED_DIRECTED_ERROR <= directed[0] <= PUBLISHED_DIRECTED_ERROR
    # our own figures: what this protocol gives today, which is nowhere published
    assert errors == pytest.approx((4.035, 5.952), abs=6e-4)
    assert directed == pytest.approx((3.051, 5.336), abs=1e-3)


def test_ripple_of_the_screw_is_in_each_file(axis: Judge) -> None:
    values, _ = PUBLISHED.least_squares(DIRECTED, axis.fitted, axis.other)
    turned = ModelTerm.named("asymmetric-viscous", c_diff=values["Fv_diff"])
    model = Model(values["M"], values["Fv"], 0.0, values["Fc"], restoring=Restoring.NONE, terms=(turned,))
    for recording in (axis.fitted, axis.other):
        found = find_ripple(model, recording)
        assert found.period == pytest.approx(2.5e-3, rel=2e-3)
        assert found.contrast > 50.0


def test_force_fit_finds_the_published_axis(axis: Judge, recordings: Path) -> None:
    problem, _ = prepare(read_recording(recordings / "emps" / "DATA_EMPS.mat", COLUMNS), Asked(Restoring.NONE))
    assert isinstance(problem, InverseDynamics)
    base = fit(problem.first, problem, free_of(problem.first, problem.base_names))
    model = replace(base.model, terms=(ModelTerm.named("asymmetric-viscous", c_diff=0.0),))
    turned = fit(model, problem, free_of(model, problem.base_names))
    fitted, cross = axis.errors(turned.model)
    assert fitted < PUBLISHED_DIRECTED_ERROR
    # our own figures, a little above what the protocol itself leaves with this law, 3.051 and 5.336
    assert fitted <= 3.06
    assert cross <= 5.345
    assert turned.model.m == pytest.approx(95.1, abs=0.5)
    assert axis.confirms(base.model, turned.model)


def test_files_that_are_not_the_published_ones_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"DATA_EMPS\.mat: no such file"):
        Emps.from_folder(tmp_path)
    (tmp_path / "DATA_EMPS.mat").write_bytes(b"something else")
    with pytest.raises(InputError, match="sha256"):
        Emps.from_folder(tmp_path)
