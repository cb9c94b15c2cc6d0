"""Bodies with six freedoms in contact: slopes, grips, what rolls and spins, against closed forms."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from harness.core.errors import SimulationError
from harness.core.scenario import Body
from harness.core.trajectory import Trajectory
from harness.engines import registry
from harness.engines.base import Task
from harness.fidelity.kind import Metrics, kind, kinds, names, suite
from harness.fidelity.matrix import Matrix
from harness.fidelity.scenarios.bodies import INCLINE, PINCH, ROLLING, SPINNING, BodyKind, deceleration

ELLIPTIC = {"cone": "elliptic", "impratio": 10.0}
BODIES = names("contact", "bodies")


def run(name: str, own: BodyKind, body: Body, mass: float = 1.0, speed: float = 0.0, **options: Any) -> Trajectory:
    preset, dt = options.pop("preset", "as-shipped"), options.pop("dt", 2e-3)
    scenario = own.scenario(mass, speed, body, options.pop("duration", 1.0))
    return registry.load(name).simulate(Task(scenario, "contact", preset, dt, options))


def figures(own: BodyKind, trace: Trajectory, body: Body, mass: float = 1.0, speed: float = 0.0) -> Metrics:
    return own.measure(trace, own.scenario(mass, speed, body, trace.duration))


@pytest.mark.parametrize(
    ("condim", "options", "creep"),
    [(4, {}, 1213.0), (6, {}, 1416.0), (6, ELLIPTIC | {"impratio": 1.0}, 638.4), (3, ELLIPTIC, 63.84)],
)
def test_a_block_on_a_slope_creeps_by_its_cone(condim: int, options: dict[str, Any], creep: float) -> None:
    """um/s at half of friction: more with condim on a pyramid, as 1/impratio on an elliptic cone."""
    body = replace(INCLINE.body, condim=condim)
    found = figures(INCLINE, run("mujoco", INCLINE, body, **options), body)["creep_m_s"]
    assert found == pytest.approx(creep * 1e-6, rel=2e-3)


@settings(max_examples=6, deadline=None, derandomize=True, phases=[Phase.generate])
@given(
    radius=st.floats(0.03, 0.2), mu=st.floats(2e-4, 5e-3), mass=st.floats(0.1, 10.0), spins=st.booleans(),
    name=st.sampled_from(("mujoco", "pybullet")),
)  # fmt: skip
def test_what_rolls_and_spins_slows_down_by_its_law(
    radius: float, mu: float, mass: float, spins: bool, name: str
) -> None:
    """mu_r g/(1.4 r), and mu_t g/(0.4 r) at the rim."""
    pytest.importorskip(name)
    own = SPINNING if spins else ROLLING
    body = replace(own.body, size=radius, mu_r=mu, mu_t=mu)
    speed = 1.2 * deceleration(body)  # more than a second's worth
    trace = run(name, own, body, mass, speed, preset="tuned", dt=1e-3)
    found = figures(own, trace, body, mass, speed)["deceleration_m_s2"]
    assert found == pytest.approx(deceleration(body), rel=2e-3)


@pytest.mark.parametrize("own", [INCLINE, PINCH])
def test_a_pair_says_the_same_as_its_two_geoms(own: BodyKind) -> None:
    geoms, pair = (run("mujoco", own, replace(own.body, pair=said), duration=0.2) for said in (False, True))
    assert np.array_equal(geoms.x, pair.x)


def test_a_tuned_grip_holds_and_one_without_friction_on_a_slope_slides() -> None:
    found = figures(PINCH, run("mujoco", PINCH, PINCH.body, preset="tuned", dt=1e-3), PINCH.body)
    assert found["creep_m_s"] == pytest.approx(0.0, abs=1e-6)
    body = replace(INCLINE.body, condim=1)
    for name in ("mujoco", "pybullet"):
        pytest.importorskip(name)
        slid = figures(INCLINE, run(name, INCLINE, body, preset="tuned", duration=0.3), body)
        assert slid["deceleration_m_s2"] == pytest.approx(-0.25 * 9.81, rel=1e-3)


@pytest.mark.parametrize("name", BODIES)
def test_the_exact_motion_has_the_deceleration_that_is_asked_for(name: str) -> None:
    own = kind(name)
    assert isinstance(own, BodyKind)
    scenario = suite("contact", part="bodies")[name]
    t = np.linspace(0.0, scenario.duration, 2001)
    exact = own.exact(scenario, t)
    assert np.allclose(np.gradient(exact.x, t)[2:-2], exact.v[2:-2], atol=2e-3)
    measured = own.measure(exact, scenario)
    for metric, value in own.answers(scenario).items():
        assert measured[metric] == pytest.approx(value, rel=1e-9, abs=1e-12)


def test_an_engine_without_bodies_refuses_them_and_has_no_rows_of_them() -> None:
    engine = registry.load("rapier") if registry.available().get("rapier") is None else None
    if engine is None:
        pytest.skip("rapier is not installed")
    with pytest.raises(SimulationError, match="six freedoms"):
        engine.simulate(Task(suite("contact", part="bodies")["pinch"], "contact"))
    assert not {spec.scenario.name for spec in Matrix(routes=("contact",)).specs({"rapier": engine})} & set(BODIES)
    mine = {spec.scenario.name for spec in Matrix(routes=("contact",)).specs({"mujoco": registry.load("mujoco")})}
    assert set(BODIES) <= mine
    assert set(BODIES) <= set(kinds())
