"""A force between its samples, held or a curve; few straight pieces, and gaps of which nothing is known."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import cumulative_trapezoid

from harness import stages
from harness.core.arrays import BoolArray, FloatArray
from harness.core.recording import Recording
from harness.diagnosis.baseline.base_fit import driven_baseline
from harness.diagnosis.fit.fitted_states import begun
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.grading.misfit import misfit
from harness.diagnosis.input_noise.noisy_base_fit import along
from harness.diagnosis.parameters import free_of
from harness.diagnosis.pipeline import diagnose, prepare
from harness.diagnosis.prepare.driven import ALL_FELT
from harness.diagnosis.prepare.intersample import ACTS_HELD, between_samples, curve, held, kinks_of
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.problems.simulated import COARSE, observe
from harness.diagnosis.request import Asked
from harness.diagnosis.search.few_pieces import in_few_pieces, projected
from harness.diagnosis.search.search import noise_of, under
from harness.diagnosis.starts import OneStart, Windows
from harness.estimate.noise import Noise
from harness.kernels.solve import Drive, Scales, solve
from harness.model.model import Model, ModelTerm, Restoring


def test_momentum_of_a_smooth_force_is_kept_to_the_fourth_order() -> None:
    missed = []
    for n in (50, 100, 200):
        t = np.linspace(0.0, 4.0, n + 1)
        assert kinks_of(t, np.sin(6.0 * t)).t.size == 0
        drive = curve(t, np.sin(6.0 * t))
        momentum = cumulative_trapezoid(drive.u, drive.t, initial=0.0)
        missed.append(float(np.abs(momentum - (1.0 - np.cos(6.0 * drive.t)) / 6.0).max()))
    assert missed[0] / missed[1] > 14.0
    assert missed[1] / missed[2] > 14.0


def _after_turns(t: FloatArray, turns: FloatArray) -> FloatArray:
    """A slow force whose slope jumps at turns (s) and fades back, as a loop's does."""
    force = np.sin(1.3 * t) + 0.2 * t**2
    for i, turn in enumerate(turns):
        since = np.maximum(t - turn, 0.0)
        force += (-1.0) ** i * 3.0 * since * np.exp(-since / 0.08)
    return force


@given(shift=st.floats(0.0, 1.0, exclude_max=True), gap=st.floats(0.45, 0.9))
@settings(max_examples=40, deadline=None)
def test_kinks_between_samples_are_found_and_the_momentum_is_kept(shift: float, gap: float) -> None:
    step = 0.02
    t: FloatArray = np.arange(400.0) * step
    turns = np.arange(1.0 + shift * step, 7.0, gap)
    drive, _ = between_samples(t, _after_turns(t, turns))
    fine = np.linspace(t[0], t[-1], 400_001)
    truth = _after_turns(fine, turns)
    kinks = kinks_of(t, _after_turns(t, turns))
    assert kinks.t.size == turns.size
    assert kinks.t == pytest.approx(turns, abs=0.05 * step)
    # a straight line over a kink in its middle misses 3 step^2 / 8, of one sign after the other
    lost = np.abs(np.cumsum(np.interp(fine, drive.t, drive.u) - truth)).max() * fine[1]
    assert lost < 0.02 * turns.size * 3.0 * step**2 / 8.0


SLIDER = Model(1.3, 0.9, 45.0, 0.6)
T: FloatArray = np.arange(2400.0) / 300.0
U: FloatArray = np.asarray(6.0 * np.sin(4.0 * T) + 3.0 * np.sin(9.3 * T + 0.4), dtype=np.float64)
SCALES = Scales(0.3, 2.0, 6.0)


def driven(u: FloatArray, noise: float = 1e-4) -> Driven:
    """A slider under a smooth force, as its fit begins."""
    drive = curve(T, u)
    x = solve(SLIDER, T, drive=drive).x + noise * np.random.default_rng(1).standard_normal(T.size)
    return Driven(T, {"x": x}, {"x": Noise(noise, True)}, drive=drive, first=SLIDER)


@settings(max_examples=30)
@given(st.integers(2, 60), st.floats(-5.0, 5.0), st.floats(-5.0, 5.0))
def test_a_straight_force_stays_what_it_is(count: int, level: float, slope: float) -> None:
    """However uneven its knots are, and where there are none."""
    t = np.unique(np.random.default_rng(count).uniform(0.0, 3.0, 200))
    t = t[(t < 1.0) | (t > 1.4)]
    found = projected(Drive(t, level + slope * t), count)
    assert found.t.size == count
    assert (found.t[0], found.t[-1]) == (t[0], t[-1])
    assert np.interp(t, found.t, found.u) == pytest.approx(level + slope * t, abs=1e-6)


def test_what_is_left_out_is_even() -> None:
    """The nearest force by its mean square leaves nothing along any piece, so that the momentum stays; the error of
    straight pieces falls with their square.
    """
    whole = curve(T, U)
    weight = np.gradient(whole.t)
    errors = []
    for count in (80, 160):
        few = projected(whole, count)
        left = whole.u - np.interp(whole.t, few.t, few.u)
        assert abs(weight @ left) < 1e-9 * float(weight @ np.abs(whole.u))
        errors.append(float(np.sqrt(weight @ left**2)))
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_a_fitted_model_leaves_what_it_left_in_a_fifth_of_the_pieces() -> None:
    """Sample by sample but for the integrator's error, and its partials are the same but for a hundredth."""
    problem = driven(U)
    few = in_few_pieces(problem, SLIDER, SCALES)
    assert few.drive is not None
    assert problem.drive is not None
    assert 5 * few.drive.t.size < problem.drive.t.size
    by = tuple(f.by for f in free_of(SLIDER, ("m", "c", "k", "f_k")))
    here, there = (observe(SLIDER, one, by, SCALES, COARSE) for one in (problem, few))
    left, left_few = problem.channels["x"] - here.y["x"], few.channels["x"] - there.y["x"]
    assert left_few == pytest.approx(left, abs=COARSE.tolerance * SCALES.x)
    size = np.linalg.norm(here.dy["x"], axis=0)
    assert np.linalg.norm(there.dy["x"] - here.dy["x"], axis=0) / size == pytest.approx(0.0, abs=0.01)


AXIS = Model(2.0, 3.0, 0.0, 1.5, restoring=Restoring.NONE)
SPRING = replace(AXIS, k=80.0, restoring=Restoring.SPRING)
GAPS = ((1.1, 1.16), (2.5, 2.9), (4.2, 4.23))
SIGMA = 2e-5


def recorded(model: Model, gaps: tuple[tuple[float, float], ...] = GAPS, n: int = 3000) -> Recording:
    """A recording of a model pushed by a sum of slow waves, without its samples in the gaps (s)."""
    t, fine = np.arange(n) / 500.0, np.arange(8 * n) / 4000.0
    waves = ((6.0, 3.1, 0.3), (4.0, 7.3, 1.1), (3.0, 14.0, 2.0))
    u = np.sum([a * np.sin(w * fine + p) for a, w, p in waves], axis=0)
    x = solve(model, t, drive=Drive(fine, u)).x + SIGMA * np.random.default_rng(4).standard_normal(n)
    keep: BoolArray = np.all([(t < low) | (t > high) for low, high in gaps], axis=0) if gaps else np.ones(n, dtype=bool)
    return Recording(t[keep], {"x": x[keep], "u": u[::8][keep]})


def fitted(recording: Recording, asked: Asked) -> tuple[Driven, Fit, Scales]:
    """The base model along its own motion, under the noise that it leaves."""
    problem, _ = prepare(recording, asked)
    assert isinstance(problem, Driven)
    base, scales = driven_baseline(problem)
    problem, base = along(base, problem, scales)
    problem = replace(problem, noise=noise_of(base, problem, scales.omega))
    return problem, fit(base.model, problem, base.free, scales), scales


@pytest.mark.parametrize(
    ("truth", "gaps", "horizon", "windows"),
    [(AXIS, GAPS, None, 4), (SPRING, (), 1.0, 6), (SPRING, GAPS, 1.0, 8)],
    ids=["gaps", "horizon", "both"],
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
    fine = np.arange(8 * 3000) / 4000.0
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
    drive, _ = between_samples(t, u, 0.05)
    within = np.linspace(t[99], t[100], 7)
    assert np.interp(within, drive.t, drive.u) == pytest.approx(np.interp(within, t, u), abs=1e-5)
    fine = np.concatenate((np.linspace(0.0, 0.99, 999), np.linspace(3.0, 3.99, 999)))
    # pieces of a curve: a quarter of an interval's chord is missed by h^2 / 8 of its bend
    assert np.max(np.abs(np.interp(fine, drive.t, drive.u) - np.sin(3.0 * fine))) < 9.0 * 0.0025**2 / 4.0


def _pushed(is_held: bool) -> Recording:
    """A free axis under four sines, given every 8 ms, and a constant force that nobody measured."""
    t: FloatArray = np.arange(1500.0) * 8e-3
    random = np.random.default_rng(2)
    phases = random.uniform(0.0, 6.0, 4)
    sines = zip((1.2, 0.8, 0.6, 0.5), (2.0, 4.3, 7.1, 11.0), phases, strict=True)
    u: FloatArray = np.sum([size * np.sin(rate * t + phase) for size, rate, phase in sines], axis=0)
    drive = held(t, u) if is_held else Drive(t, u)
    terms = (ModelTerm.named("constant-force", force=0.06),)
    model = Model(m=1.0, c=1.6, k=0.0, f_k=0.1, restoring=Restoring.NONE, terms=terms)
    x = solve(model, t, drive=drive).x + 4e-4 * random.standard_normal(t.size)
    return Recording(t=t, channels={"x": x, "u": u})


def test_a_held_force_moves_a_slider_as_constant_forces_do_one_after_another() -> None:
    m, f_k, h = 2.0, 0.7, 0.01
    # rests until a step exceeds its friction, slides, stops under a step that is smaller, and goes back
    u: FloatArray = np.repeat([0.6, 3.0, 0.5, -0.6, -2.0, -2.5], 25)
    t: FloatArray = np.arange(u.size + 1.0) * h
    x, v, seen = 0.0, 0.0, [0.0]
    for force in u:
        left = h
        while left > 0.0:
            if v == 0.0 and abs(force) <= f_k:
                break
            a = (force - f_k * np.sign(v or force)) / m
            stops = -v / a if v * a < 0.0 else np.inf
            step = min(left, stops)
            x, v = x + v * step + 0.5 * a * step**2, 0.0 if stops <= left else v + a * step
            left -= step
        seen.append(x)
    model = Model(m=m, c=0.0, k=0.0, f_k=f_k, restoring=Restoring.NONE)
    drive = Drive(t[:-1], u, held=True)
    found = solve(model, t, ("f_k", "m"), drive)
    assert found.x == pytest.approx(np.array(seen), abs=1e-12)
    assert np.max(np.abs(found.x - solve(model, t, drive=drive.straight).x)) > 1e-4
    d = 1e-6
    for q, (less, more, size) in enumerate((
        (replace(model, f_k=f_k * (1.0 - d)), replace(model, f_k=f_k * (1.0 + d)), f_k),
        (replace(model, m=m * (1.0 - d)), replace(model, m=m * (1.0 + d)), m),
    )):  # fmt: skip
        change = solve(more, t, drive=drive).x - solve(less, t, drive=drive).x
        assert found.dx[:, q] == pytest.approx(change / (2.0 * d * size), abs=1e-6)


@pytest.mark.parametrize("is_held", [pytest.param(False, marks=pytest.mark.full), True])
def test_a_force_that_is_left_out_does_not_decide_how_the_drive_acts(is_held: bool) -> None:
    problem = stages.prepare(_pushed(is_held), restoring="none").problem
    assert isinstance(problem, Driven)
    assert not problem.is_held, "the base model is misled: this is what the test is about"
    found = stages.search(stages.fit_base(problem))
    assert isinstance(found.search.problem, Driven)
    assert found.search.problem.is_held is is_held
    assert any(ACTS_HELD in note for note in found.notes) is is_held
    (law,) = found.search.chosen.model.terms
    assert found.search.explained
    assert law.term.name == "constant-force"
    assert law.values[0] == pytest.approx(0.06, abs=2e-3)


def test_the_other_ways_and_back_are_the_same() -> None:
    problem = stages.prepare(_pushed(is_held=False), restoring="none").problem
    assert isinstance(problem, Driven)
    stepped, *_ = problem.other_ways
    assert stepped.is_held
    assert stepped.drive.straight.t[0] - problem.drive.t[0] == pytest.approx(4e-3)
    assert [way.drive for way in stepped.other_ways if way.drive is problem.drive]
    assert {id(way.drive) for way in problem.other_ways} == {id(way) for way in problem.otherwise}


def test_a_force_in_straight_lines_is_told_from_a_smooth_one_by_the_motion() -> None:
    # the samples of this force are those of a smooth one; whoever simulates with them joins them by lines
    t = np.arange(1500.0) / 125.0
    u = 6.0 * np.sin(3.1 * t + 0.3) + 4.0 * np.sin(7.3 * t + 1.1)
    x = solve(Model(2.0, 3.0, 80.0, 1.5), t, drive=Drive(t, u)).x
    x = x + 2e-5 * np.random.default_rng(1).standard_normal(t.size)
    outcome = diagnose(stages.prepare(Recording(t=t, channels={"x": x, "u": u})).problem)
    assert outcome.verdict == "adequate"
    for name, true in (("omega_n", 40.0**0.5), ("zeta", 3.0 / 2.0 / (2.0 * 40.0**0.5)), ("x_k", 1.5 / 80.0)):
        quantity = outcome.base_parameters[name]
        assert quantity.stderr is not None
        assert quantity.value == pytest.approx(true, abs=5.0 * quantity.stderr)


@pytest.mark.parametrize("seed", [3, pytest.param(5, marks=pytest.mark.full), pytest.param(9, marks=pytest.mark.full)])
def test_a_stage_that_pulls_by_its_stiffness_tells_the_inertia_beside_the_noise_of_its_force(seed: int) -> None:
    # most of the force is friction, which it kinks by wherever the slider stops: lines between samples lie inside
    m, c, f_k, stiff, damp, step = 4.0, 25.0, 22.0, 2500.0, 120.0, 1e-3
    random, fine = np.random.default_rng(seed), np.arange(25_000.0) * step
    moves = np.linspace(0.0, 25.0, 16)
    s = np.interp(fine, moves, np.arange(moves.size)) % 1.0
    smooth, slope = s**3 * (10.0 - 15.0 * s + 6.0 * s**2), 30.0 * (s * (1.0 - s)) ** 2 / np.diff(moves)[0]
    ends = np.concatenate(([0.0], 0.1 * (-1.0) ** np.arange(15) * random.uniform(0.5, 1.0, 15)))
    at = np.minimum(np.searchsorted(moves, fine, side="right") - 1, 14)
    goal, speed = ends[at] + np.diff(ends)[at] * smooth, np.diff(ends)[at] * slope
    moved = solve(Model(m, c + damp, stiff, f_k), fine, drive=Drive(fine, stiff * goal + damp * speed))
    u = stiff * (goal - moved.x) + damp * (speed - moved.v)
    seen = Recording(
        t=fine[::10],
        channels={
            "x": moved.x[::10] + 3e-5 * random.standard_normal(2500),
            "u": u[::10] + 2e-2 * random.standard_normal(2500),
        },
    )
    outcome = diagnose(stages.prepare(seen, restoring="none").problem)
    assert outcome.verdict == "adequate"
    for name, true in (("mass", m), ("c", c), ("f_k", f_k)):
        found = outcome.base_parameters[name]
        assert found.value is not None
        assert found.stderr is not None
        assert abs(found.value - true) < 3.0 * found.stderr
        assert found.stderr < 2e-3 * true


def _in_a_loop(noise: float) -> Recording:
    """A free axis that a loop on encoder counts moves to and fro; the force is recorded with so much noise, N."""
    m, c_loop, f_k, h, count = 2.0, 60.0, 3.0, 2e-3, 2e-6
    random = np.random.default_rng(4)
    t: FloatArray = np.arange(3000.0) * h
    goal = 0.05 * np.sin(2.1 * t) + 0.03 * np.sin(4.7 * t)
    x, v, before, seen, u = 0.0, 0.0, 0.0, np.zeros(t.size), np.zeros(t.size)
    for i in range(t.size):
        seen[i] = count * round(x / count)
        u[i] = m * c_loop**2 * (goal[i] - seen[i]) - 1.6 * m * c_loop * (seen[i] - before) / h
        before, left = seen[i], h
        while left > 0.0 and not (v == 0.0 and abs(u[i]) <= f_k):
            a = (u[i] - f_k * np.sign(v or u[i])) / m
            stops = -v / a if v * a < 0.0 else np.inf
            step = min(left, stops)
            x, v = x + v * step + 0.5 * a * step**2, 0.0 if stops <= left else v + a * step
            left -= step
    return Recording(t=t, channels={"x": seen, "u": u + noise * random.standard_normal(t.size)})


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_the_scatter_of_a_command_is_no_noise_and_what_is_measured_has_its_own(noise: float) -> None:
    prepared = stages.prepare(_in_a_loop(noise), restoring="none")
    based = stages.fit_base(prepared.problem)
    assert isinstance(based.problem, Driven)
    assert based.problem.is_held
    model, force = based.fit.model, based.problem.force_noise
    if noise == 0.0:
        assert force is None
        assert ALL_FELT in prepared.notes
        assert model.f_k == pytest.approx(3.0, rel=1e-4)
    else:
        assert force is not None
        assert force.noise.sigma == pytest.approx(noise, rel=0.45)  # levels are twofold apart
        assert model.f_k == pytest.approx(3.0, rel=1e-2)
        # a grade sees the recording under the same noise as the test
        graded = misfit(based.problem, based.fit, based.scales)
        again = under(graded.base, graded.sensed(graded.noise_left(graded.base)))
        assert again.chi2 == pytest.approx(based.fit.chi2, rel=1e-2)
