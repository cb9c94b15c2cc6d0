"""Models in engines against a recording: whose share a mismatch is; friction that an engine smears is named."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import harness
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.diagnosis.alignment.align import align
from harness.diagnosis.attribution.attribute import Attribution, attribute_engine
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.explain.engines import engine_fit, suitable_step
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.integrator_maps import as_stepped
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.parameters import free_of
from harness.diagnosis.pipeline import explain, judge, prepare
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.request import Asked
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.search.search import Search
from harness.diagnosis.sensor_model import motion_at, sensed
from harness.diagnosis.stages import Found
from harness.diagnosis.starts import Window, Windows
from harness.engines.simulator import EngineSimulator
from harness.estimate.noise import Noise
from harness.kernels.solve import Drive, Scales, simulate, solve
from harness.model.model import Model, ModelTerm, Restoring

BASE = Model(1.0, 1.0, 100.0, 3.0, x0=1.0)
CUBIC = BASE.with_terms(ModelTerm.named("cubic-stiffness", k3=20.0))
SCALES = Scales(1.0, 10.0, 10.0)
SIGMA = {"x": 1e-3, "v": 1e-2, "a": 0.1}


def recorded(model: Model, seed: int = 0, count: int = 601, **sigma: float) -> Problem:
    """What was measured of a model for 3 s, with white noise."""
    t = np.linspace(0.0, 3.0, count)
    level = sigma or {"x": SIGMA["x"], "a": SIGMA["a"]}
    noise = {c: Noise(s, True) for c, s in level.items()}
    clean = observe(model, FreeDecay(t, dict.fromkeys(level, t), noise), scales=SCALES).y
    random = np.random.default_rng(seed)
    return FreeDecay(t, {c: y + level[c] * random.standard_normal(t.size) for c, y in clean.items()}, noise)


def test_a_motion_is_read_between_samples_with_its_jumps() -> None:
    coarse = simulate(BASE, np.arange(0.0, 3.0, 1e-3))
    t = np.sort(np.random.default_rng(1).uniform(0.0, 2.99, 2000))
    exact, read = solve(BASE, t), motion_at(coarse, t)
    assert np.abs(read.x - exact.x).max() < 1e-6
    assert np.abs(read.v - exact.v).max() < 1e-4
    # the jumps are 6 m/s^2 high
    assert np.abs(read.a - exact.a).max() < 0.02


def test_an_acceleration_that_reverses_a_step_early_is_not_believed() -> None:
    trace = EngineSimulator.named("pybullet")(BASE, 2.0, 1e-3, None)
    turns = np.flatnonzero(trace.v[:-1] * trace.v[1:] < 0.0)[:6]
    x, v = trace.x[turns], trace.v[turns]
    true = (-BASE.k * x - BASE.c * v - BASE.f_k * np.sign(v)) / BASE.m
    assert np.abs(motion_at(trace, trace.t[turns]).a - true).max() < 0.1
    assert np.abs(trace.a[turns] - true).max() > 1.0


def test_before_its_release_a_slider_is_held() -> None:
    read = motion_at(simulate(BASE, np.arange(0.0, 1.0, 1e-3)), np.array([-0.5, 0.0]))
    assert (read.x[0], read.v[0], read.a[0]) == (1.0, 0.0, 0.0)
    assert read.a[1] == pytest.approx(-97.0)


SENSORS = (
    ModelTerm.named("sensor-lag", lag=0.0123),
    ModelTerm.named("sensor-drift", rate=0.01),
    ModelTerm.named("sensor-curvature", q=0.05),
    ModelTerm.named("sensor-gravity", per_place=8.0),
    ModelTerm.named("sensor-gain", gain=0.9),
    ModelTerm.named("sensor-bias", bias=0.5),
    ModelTerm.named("sensor-clipping", limit=60.0),
)


def test_sensors_show_of_any_motion_what_they_show_of_the_reference() -> None:
    model = replace(CUBIC.with_terms(*CUBIC.terms, *SENSORS), offset=0.02)
    t = np.linspace(0.0, 3.0, 733)
    noise = {c: Noise(s, True) for c, s in SIGMA.items()}
    expected = observe(model, FreeDecay(t, dict.fromkeys(SIGMA, t), noise), scales=SCALES).y
    shown = sensed(model, t, simulate(model, np.linspace(0.0, 3.0, 6001)), SIGMA)
    for channel, tolerance in (("x", 1e-7), ("v", 1e-5), ("a", 2e-3)):
        assert np.abs(shown[channel] - expected[channel]).max() < tolerance, channel


@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_the_fit_improves_in_the_engine_and_reaches_the_noise(name: str) -> None:
    problem = recorded(CUBIC)
    base = fit(BASE, problem, free_of(BASE, ("c", "k", "f_k", "x0")), SCALES, thorough=False).model
    found = engine_fit(EngineSimulator.named(name), base, CUBIC, problem, SCALES)
    assert found.improved
    assert max(found.own_error.values()) < 0.3
    for channel, sigma in problem.noise.items():
        assert found.refined_rmse[channel] == pytest.approx(sigma.sigma, rel=0.08)
        assert found.baseline_rmse[channel] > 2.0 * sigma.sigma
    assert found.settings["dt"] <= suitable_step(problem, SCALES)
    assert found.settings["restoring"] == "spring"


@pytest.mark.parametrize(
    ("error", "halvings"), [(0.1, [0]), (0.5, [0, 1]), (2.0, [0, 1, 3]), (4.0, [0, 1, 4]), (40.0, [0, 1, 4])]
)
def test_the_first_halving_of_a_step_says_how_many_more_there_must_be(error: float, halvings: list[int]) -> None:
    """An engine of first order whose error begins at so many times the noise; at most four halvings, to below 0.3."""
    problem = recorded(CUBIC, x=SIGMA["x"])
    first, run = suitable_step(problem, SCALES), []

    def engine(model: Model, duration: float, dt: float | None, drive: Drive | None) -> Trajectory:
        assert dt is not None
        run.append(round(np.log2(first / dt)))
        motion = simulate(model, np.linspace(0.0, duration, 6001))
        return replace(motion, x=motion.x + error * SIGMA["x"] * dt / first)

    found = engine_fit(engine, BASE, CUBIC, problem, SCALES)
    # the base model at the last of them
    assert run == [*halvings, halvings[-1]]
    assert found.settings["dt"] == pytest.approx(first / 2 ** halvings[-1])
    assert found.own_error["x"] == pytest.approx(error / 2 ** halvings[-1], rel=1e-3)


@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_a_driven_recording_is_simulated_window_by_window(name: str) -> None:
    """A free axis under a force: windows of 1 s restarted from the recorded state."""
    model = Model(
        1.5, 2.0, 0.0, 3.0, restoring=Restoring.NONE, terms=(ModelTerm.named("asymmetric-viscous", c_diff=1.0),)
    )
    t = np.linspace(0.0, 2.0, 401)
    drive = Drive(t, 12.0 * np.sin(3.0 * t) + 6.0 * np.sin(7.3 * t))
    true = solve(model, t, drive=drive)
    starts = range(0, 400, 200)
    windows = tuple(Window(i, i + 200, float(t[i]), true.x[i], true.v[i], 1e-9, 1e-9) for i in starts)
    random = np.random.default_rng(3)
    sigma = 1e-4
    noise = {"x": Noise(sigma, True)}
    base = model.with_terms()
    x = true.x[:400] + sigma * random.standard_normal(400)
    problem = Driven(t[:400], {"x": x}, noise, drive=drive, first=base, starts=Windows(windows, t, true.v))
    found = engine_fit(EngineSimulator.named(name), base, model, problem, Scales(1.0, 3.0, 3.0))
    assert found.improved
    assert found.refined_rmse["x"] < 2.0 * sigma
    assert found.baseline_rmse["x"] > 10.0 * sigma


INTEGRATORS: list[tuple[dict[str, Any], float, bool]] = [
    ({"integrator": "Euler"}, 2e-3, True),
    ({"integrator": "implicitfast"}, 2e-3, True),
    ({"integrator": "discrete"}, 2e-3, True),
    ({"integrator": "RK4"}, 1e-4, False),
]


@pytest.mark.parametrize(("settings", "dt", "errs"), INTEGRATORS, ids=["Euler", "implicitfast", "discrete", "RK4"])
def test_what_the_integrator_does_wrong_is_the_engines(settings: dict[str, Any], dt: float, errs: bool) -> None:
    """The model is the true one: parameters and physics have no share, whatever the integrator does."""
    problem = recorded(BASE)
    found = attribute_engine(EngineSimulator.named("mujoco", "tuned", settings), BASE, BASE, problem, SCALES, dt)
    assert found.parameters == found.missing_physics == 0.0
    assert abs(found.unexplained) < 0.1 * found.noise
    assert found.engine > 0.5 if errs else abs(found.engine) < 0.1


def test_parameters_and_missing_physics_have_their_shares() -> None:
    """Right parameters without the term: all is missing physics; a base fit's stand for a part of the term."""
    problem = recorded(CUBIC)
    base = fit(BASE, problem, free_of(BASE, ("c", "k", "f_k", "x0")), SCALES, thorough=False).model
    simulator = EngineSimulator.named("mujoco")
    right = attribute_engine(simulator, CUBIC.with_terms(), CUBIC, problem, SCALES, 1e-4)
    assert abs(right.parameters) < 0.02
    assert right.missing_physics > 0.95
    assert not right.hides
    fitted = attribute_engine(simulator, base, CUBIC, problem, SCALES, 1e-4)
    assert fitted.hides
    assert fitted.whole < right.whole
    assert all(abs(found.engine) < 0.05 for found in (right, fitted))


def trace_of(model: Model, start: float, *channels: str) -> Recording:
    t = np.arange(0.0, 3.2, 1e-3)
    motion = simulate(model, t)
    every: dict[str, FloatArray] = {"x": motion.x, "v": motion.v, "a": motion.a}
    return Recording(t + start, {c: every[c] for c in channels}, "sim.csv")


@pytest.mark.parametrize("channels", [("x", "v", "a"), ("x",), ("a",)])
def test_a_users_trace_is_shifted_to_where_it_belongs(channels: tuple[str, ...]) -> None:
    problem = recorded(BASE)
    noise = {c: problem.noise[c] for c in problem.channels if c in channels}
    found = align(trace_of(BASE, 7.3214, *channels), problem, noise, 2.0 * np.pi / 10.0)
    assert found.shift.value == pytest.approx(-7.3214, abs=2e-4)
    assert found.shift.stderr is not None
    assert abs((found.shift.value or 0.0) + 7.3214) < 4.0 * found.shift.stderr
    assert found.covered.all()


def test_a_rest_does_not_draw_a_trace_away_from_the_motion() -> None:
    t = np.linspace(0.0, 9.0, 1801)
    noise = {"x": Noise(1e-3, True)}
    problem = FreeDecay(t, {"x": solve(BASE, t).x}, noise)
    found = align(trace_of(BASE, 40.0, "x"), problem.part(slice(0, 1200)), noise, 0.628)
    assert found.shift.value == pytest.approx(-40.0, abs=2e-4)


@pytest.mark.parametrize(
    ("timeconst", "d0", "width"), [(0.02, 0.9, 0.95), (0.01, 0.95, 0.99)], ids=["as shipped", "stiffer"]
)
def test_mujocos_friction_is_a_regularised_friction(timeconst: float, d0: float, width: float) -> None:
    """v_r = f_k/(m d0 b), lead = 1/b with b = 2/(d_width timeconst), read from a noisy trace within 5 %."""
    settings = {"integrator": "RK4", "solreffriction": (timeconst, 1.0), "solimpfriction": (d0, width, 0.001, 0.5, 2.0)}
    motion = EngineSimulator.named("mujoco", "as-shipped", settings)(BASE, 3.0, 1e-4, None)
    every = slice(None, None, 40)
    sigma = {"x": 1e-4, "a": 1e-3 * 100.0}
    random = np.random.default_rng(5)
    channels = {
        c: getattr(motion, c)[every] + s * random.standard_normal(motion.t[every].size) for c, s in sigma.items()
    }
    problem = FreeDecay(motion.t[every], channels, {c: Noise(s, True) for c, s in sigma.items()})
    start = BASE.with_terms(ModelTerm.named("regularised-friction", v_r=0.1, lead=0.003))
    found = fit(start, problem, free_of(start, ("c", "k", "f_k", "x0")), SCALES)
    b = 2.0 / (width * timeconst)
    entry = found.model.terms[0]
    assert entry.value("v_r") == pytest.approx(BASE.f_k / (BASE.m * d0 * b), rel=0.05)
    assert entry.value("lead") == pytest.approx(1.0 / b, rel=0.05)
    assert found.chi2 / found.points < 1.1


OF_TRACE = {"x": 1e-4, "a": 1e-3 * 100.0}
# what ENGINE's soft constraint gives: b = 2/(d_width timeconst), v_r = f_k/(m d0 b), lead = 1/b
B = 2.0 / (0.95 * 0.02)
V_R, LEAD = 3.0 / (0.9 * B), 1.0 / B


def measured(motion: Trajectory, every: int = 1, late: bool = False) -> Recording:
    """A trace as somebody gives it: noise added; late: the acceleration of the step before, as mj_step leaves it."""
    random = np.random.default_rng(5)
    a = np.concatenate((motion.a[:1], motion.a[:-1])) if late else motion.a
    channels = {"x": motion.x[::every], "a": a[::every]}
    noisy = {c: y + OF_TRACE[c] * random.standard_normal(y.size) for c, y in channels.items()}
    return Recording(motion.t[::every], noisy, "trace")


def trace(every: int = 1, late: bool = False, **settings: Any) -> Recording:
    dt = settings.pop("dt")
    return measured(EngineSimulator.named("mujoco", "as-shipped", settings)(BASE, 3.0, dt, None), every, late)


def concluded(recording: Recording, *named: ModelTerm) -> tuple[Outcome, Scales] | None:
    """What is concluded from a search that ended at these terms; None where no engine was seen."""
    problem, _ = prepare(recording, Asked())
    base, scales = baseline(problem)
    names = ("c", "k", "f_k", "x0", "v0")
    fits = []
    for count in range(1, len(named) + 1):
        model = replace(base.model, terms=named[:count])
        fits.append(fit(model, problem, free_of(model, names), scales))
    found = as_stepped(Search(problem, base, fits[-1], tuple(fits[:1]), tuple(fits[-1:]), Left.STRUCTURE), scales)
    return None if found is None else (explain(judge(Found(found[0], scales, found[0], found[1]))), scales)


SOFT = ModelTerm.named("regularised-friction", v_r=0.03, lead=0.009)
LAG = ModelTerm.named("sensor-lag", lag=-1e-4)


@pytest.mark.parametrize(
    ("settings", "every", "late"),
    [
        ({"dt": 2e-3, "integrator": "Euler"}, 1, False),
        ({"dt": 2e-3, "integrator": "Euler"}, 1, True),
        ({"dt": 1e-3, "integrator": "implicitfast"}, 1, False),
        ({"dt": 1e-3, "integrator": "implicitfast"}, 2, True),
    ],
)
def test_soft_friction_alone_is_named_as_the_engine_has_it(settings: dict[str, Any], every: int, late: bool) -> None:
    found = concluded(trace(every, late, **settings), SOFT, *([LAG] if late else []))
    assert found is not None
    outcome, _ = found
    assert outcome.verdict == "missing_physics"
    assert [m.name for m in outcome.mechanisms] == ["regularised-friction"]
    named = outcome.mechanisms[0].entry
    assert named.value("v_r") == pytest.approx(V_R, rel=0.05)
    assert named.value("lead") == pytest.approx(LEAD, rel=0.05)
    stepping = outcome.stepping
    assert stepping is not None
    assert stepping.h == pytest.approx(settings["dt"])
    assert stepping.late == late
    assert stepping.model.k == pytest.approx(100.0, rel=1e-4)
    assert stepping.model.c == pytest.approx(1.0, rel=1e-3)
    assert stepping.left == pytest.approx(1.0, abs=0.1)
    assert "trace of a simulation" in outcome.warnings[0]


@pytest.mark.parametrize("late", [False, True])
def test_a_step_implicit_in_position_names_no_sensor_either(late: bool) -> None:
    found = concluded(trace(1, late, dt=1e-3, integrator="discrete"), SOFT, LAG)
    assert found is not None
    outcome, _ = found
    assert [m.name for m in outcome.mechanisms] == ["regularised-friction"]
    stepping = outcome.stepping
    assert stepping is not None
    # the damping of h k that it adds is told from the slider's own
    assert stepping.scheme == "implicit"
    assert stepping.late == late
    assert stepping.model.c == pytest.approx(1.0, rel=2e-3)
    assert stepping.model.k == pytest.approx(100.0, rel=1e-4)


def test_an_acceleration_that_is_the_implicit_steps_own_names_no_sensor_either() -> None:
    motion = EngineSimulator.named("mujoco", "as-shipped", {"integrator": "discrete"})(BASE, 3.0, 1e-3, None)
    own = np.concatenate((np.diff(motion.v) / 1e-3, motion.a[-1:]))
    found = concluded(measured(replace(motion, a=own), late=True), SOFT, LAG)
    assert found is not None
    outcome, _ = found
    assert [m.name for m in outcome.mechanisms] == ["regularised-friction"]
    stepping = outcome.stepping
    assert stepping is not None
    # such a trace is that of an explicit step of another slider
    inertia = 1.0 + 1e-3 + 1e-4
    assert stepping.model.c == pytest.approx((1.0 + 0.1) / inertia, rel=2e-3)
    assert stepping.model.k == pytest.approx(100.0 / inertia, rel=1e-4)


def test_an_engine_of_fourth_order_has_nothing_taken_from_it() -> None:
    found = concluded(trace(5, dt=1e-4, integrator="RK4"), SOFT)
    assert found is None


def test_a_sensor_of_a_real_recording_stays_a_sensor() -> None:
    t = np.arange(0.0, 3.0, 1e-3)
    exact = simulate(BASE, t)
    late = measured(exact)
    for lag in (-1e-3, 3.7e-4):
        shown = Recording(t, {"x": np.interp(t - lag, t, late["x"]), "a": late["a"]}, "lagging")
        assert concluded(shown, ModelTerm.named("sensor-lag", lag=lag)) is None


def test_what_the_integrator_adds_counts_as_the_engines() -> None:
    model = Model(1.0, 1.0, 100.0, 1.0, x0=1.0)
    plain = Attribution(0.1, 0.1, 0.75, 0.04, 0.01, whole=100.0, configured=model, alone={}, by_parameter={})
    seen = plain.with_steps(1.1, 5.0)
    assert seen.engine == pytest.approx(plain.engine + 0.039)
    assert seen.unexplained == pytest.approx(0.001)
    total = seen.engine + seen.parameters + seen.missing_physics + seen.unexplained + seen.noise
    assert total == pytest.approx(1.0)


def test_what_an_own_integrator_does_at_reversals_is_no_name() -> None:
    """Runge-Kutta at a step of 1 ms, with the sign of the speed as friction: 1e-4 of the motion is its error."""

    def rate(y: FloatArray) -> FloatArray:
        return np.array([y[1], -150.0 * y[0] - 0.3 * y[1] - 0.08 * np.sign(y[1])])

    h, path = 1e-3, [np.array([0.03, 0.0])]
    for _ in range(4000):
        y = path[-1]
        k1 = rate(y)
        k2 = rate(y + 0.5 * h * k1)
        k3 = rate(y + 0.5 * h * k2)
        path.append(y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + rate(y + h * k3)))
    x, v = np.array(path).T
    found = harness.diagnose(Recording(h * np.arange(x.size), {"x": x, "v": v}, "own.csv"), engines=())
    assert found.verdict == "unexplained"
    assert not found.mechanisms
    assert "no more than an integrator may" in str(found)
    assert found.baseline.parameters["zeta"].value == pytest.approx(0.3 / 2.0 / np.sqrt(150.0), rel=1e-3)
