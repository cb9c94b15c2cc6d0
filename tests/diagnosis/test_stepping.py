"""The trace of an engine of first order: its physics is named, what its integrator adds is not."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.diagnosis.attribution.attribute import Attribution
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.integrator_maps.stepped import as_stepped
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.pipeline import explain, judge, prepare
from harness.diagnosis.request import Asked
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.search.search import Search
from harness.diagnosis.stages import Found
from harness.engines.simulator import EngineSimulator
from harness.kernels.solve import Scales, simulate
from harness.model.model import Model, ModelTerm

BASE = Model(1.0, 1.0, 100.0, 3.0, x0=1.0)
SIGMA = {"x": 1e-4, "a": 1e-3 * 100.0}
# what ENGINE's soft constraint gives: b = 2/(d_width timeconst), v_r = f_k/(m d0 b), lead = 1/b
B = 2.0 / (0.95 * 0.02)
V_R, LEAD = 3.0 / (0.9 * B), 1.0 / B


def measured(motion: Trajectory, every: int = 1, late: bool = False) -> Recording:
    """A trace as somebody gives it: noise added; late: the acceleration of the step before, as mj_step leaves it."""
    random = np.random.default_rng(5)
    a = np.concatenate((motion.a[:1], motion.a[:-1])) if late else motion.a
    channels = {"x": motion.x[::every], "a": a[::every]}
    noisy = {c: y + SIGMA[c] * random.standard_normal(y.size) for c, y in channels.items()}
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
