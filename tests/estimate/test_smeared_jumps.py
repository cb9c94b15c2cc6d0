"""Engines and real machines: jumps that are not where the speed is zero."""

from pathlib import Path

import numpy as np
import pytest

from harness.core.scenario import FREE_DECAY
from harness.core.trajectory import Trajectory
from harness.engines.base import Task
from harness.engines.registry import load
from harness.estimate.every import estimate_all


def _run(engine: str, **task: object) -> Trajectory:
    return load(engine).simulate(Task(FREE_DECAY, **task))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "task",
    [
        {"preset": "as-shipped"},
        {"preset": "as-shipped", "dt": 1e-3, "settings": {"integrator": "implicitfast"}},
        {"preset": "as-shipped", "dt": 1e-4, "settings": {"integrator": "RK4"}},
    ],
)
def test_friction_of_shipped_mujoco_is_read_through_the_guard_and_missed_beside_it(task: dict[str, object]) -> None:
    motion = _run("mujoco", **task)
    for found in (estimate_all(motion.t, motion.x, motion.v, motion.a), estimate_all(motion.t, a=motion.a)):
        wide, narrow = found["acceleration"], found["acceleration-local"]
        assert wide.x_k.value == pytest.approx(0.030, rel=0.02)
        assert wide.zeta.value == pytest.approx(0.050, rel=0.01)
        assert narrow.x_k.value is not None
        assert narrow.x_k.value < 0.015
        # friction acts about 1/b = 9.5 ms early; the guard reaches beyond that and not much further
        assert wide.lead is not None
        assert wide.lead.value == pytest.approx(9.5e-3, rel=0.2)
        assert wide.guard is not None
        assert 9e-3 < wide.guard < 25e-3


def test_numerical_damping_of_discrete_is_seen() -> None:
    motion = _run("mujoco", preset="as-shipped", dt=1e-3, settings={"integrator": "discrete"})
    found = estimate_all(motion.t, a=motion.a)["acceleration"]
    assert found.zeta.value == pytest.approx(0.05 + 1e-3 * 10.0 / 2.0, rel=1e-3)


def test_a_pendulum_with_an_encoder(recordings: Path) -> None:
    x = np.deg2rad(np.loadtxt(recordings / "rotary-pendulum" / "pendulum_free_swing_data_03.txt", skiprows=2))
    t = np.arange(x.size) / 1000.0
    found = estimate_all(t[400:], x=x[400:], unit="rad")["displacement"]
    # a full simulation with k sin x gives omega_n 10.97 rad/s, zeta 0.0093, x_k 0.0177 rad
    assert found.omega_n.value == pytest.approx(10.97, rel=0.03)
    assert found.x_k.value == pytest.approx(0.0177, rel=0.2)
    assert found.zeta.value == pytest.approx(0.0093, rel=0.5)
    assert found.x_k.unit == "rad"


def test_a_driven_axis_is_refused(recordings: Path) -> None:
    from scipy.io import loadmat

    data = loadmat(recordings / "emps" / "DATA_EMPS.mat")
    t, x, u = (data[name].ravel() for name in ("t", "qm", "vir"))
    for channels in ({"x": x}, {"x": x, "u": u}):
        found = estimate_all(t, **channels)
        assert all("no free decay" in str(found[method].x_k.why) for method in found.methods)
