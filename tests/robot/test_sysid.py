"""harness.sysid: what mujoco.sysid is given is a log, a log is what it is given, and friction goes either way."""

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from two_joint_arm import ARM, moved

import harness
from harness import sysid
from harness.core.errors import InputError
from harness.core.robot import JointLog

theirs: Any = pytest.importorskip("mujoco.sysid")
MOTORS = ARM.replace(
    "</worldbody>",
    '</worldbody><actuator><motor name="m1" joint="shoulder" gear="2"/><motor name="m2" joint="elbow"/></actuator>',
)
NAMES = ("shoulder", "elbow")


@pytest.fixture(scope="module")
def log() -> JointLog:
    """Twelve seconds with Coulomb and viscous friction and a little noise."""
    t, q, v, torque = moved(2400, 200.0, (0.8, 0.4), (0.3, 0.2))
    torque = torque + 0.01 * np.random.default_rng(1).standard_normal(torque.shape)
    position, velocity, effort = ({name: y[:, i] for i, name in enumerate(NAMES)} for y in (q, v, torque))
    return JointLog(t, position, velocity, effort)


def test_a_log_comes_back_from_what_it_becomes(log: JointLog) -> None:
    model = mujoco.MjModel.from_xml_string(MOTORS)
    control, sensor = sysid.series_of(log, model)
    assert control.data[:, 0] == pytest.approx(log.effort["shoulder"] / 2.0)
    again = sysid.log_of(model, sensor, control)
    for kind in ("position", "velocity", "effort"):
        for name in NAMES:
            assert getattr(again, kind)[name] == pytest.approx(getattr(log, kind)[name])


def test_sensors_of_joints_are_read_and_servos_are_refused(log: JointLog) -> None:
    sensed = MOTORS.replace(
        "</actuator>",
        '</actuator><sensor><jointpos name="q" joint="elbow"/><jointactuatorfrc name="u" joint="elbow"/></sensor>',
    )
    model = mujoco.MjModel.from_xml_string(sensed)
    data = np.column_stack((log.position["elbow"], log.effort["elbow"]))
    found = sysid.log_of(model, theirs.TimeSeries.from_names(log.t, data, model))
    assert found.effort["elbow"] == pytest.approx(log.effort["elbow"])
    servo = mujoco.MjModel.from_xml_string(MOTORS.replace("<motor", '<position kp="10"').replace('gear="2"', ""))
    _, sensor = sysid.series_of(log, mujoco.MjModel.from_xml_string(MOTORS))
    control = theirs.TimeSeries.from_control_names(log.t, np.zeros((log.t.size, 2)), servo)
    with pytest.raises(InputError, match="its torque is not its control"):
        sysid.log_of(servo, sensor, control)


def test_friction_becomes_parameters_that_a_spec_takes(log: JointLog, tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(MOTORS)
    table = sysid.write_log(log, tmp_path / "log.csv")
    result = harness.diagnose_joint(table, tmp_path / "arm.xml", "all", engines=["mujoco"])
    parameters = sysid.parameters_of(result)
    assert parameters["elbow_frictionloss"].value[0] == pytest.approx(0.4, rel=0.02)
    low, high = (float(one[0]) for one in parameters["shoulder_damping"].get_bounds())
    assert low < 0.3 < high
    spec = mujoco.MjSpec.from_string(MOTORS)
    found = sysid.friction_of(parameters, spec)
    assert found["elbow"]["damping"] == pytest.approx(float(parameters["elbow_damping"].value[0]))
    assert found["shoulder"]["frictionloss"] == pytest.approx(0.8, rel=0.02)
    assert not spec.joint("elbow").frictionloss
