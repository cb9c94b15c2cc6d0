"""A joint driven by its log's torque: where the torque is right both engines go where the log went."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from chains import chain, urdf

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.robot import JointLog
from harness.engines.models import folder
from harness.robot.arm import Arm, load_arm
from harness.robot.bare import bare_model
from harness.robot.example import FRICTION, excited
from harness.robot.paste import JointPaste
from harness.robot.replay import replay
from harness.robot.replay.as_urdf import of_file, of_model
from harness.robot.replay.drive import WINDOW, Drive, drive_of
from harness.robot.replay.replay import MUJOCO, PYBULLET, replayed

FILE = folder() / "arm" / "arm.xml"
ARM = load_arm(FILE)
NONE: Mapping[str, float] = {}


def _sines(arm: Arm, seed: int) -> JointLog:
    """Every joint on sums of two sines."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, 2.5, 0.002)
    position = {}
    for i, name in enumerate(arm.joints):
        (f, g), (a, b) = random.uniform(1.0, 4.0, 2), random.uniform(0.0, 6.0, 2)
        position[name] = arm.model.qpos0[i] + 0.5 * np.sin(f * t + a) + 0.2 * np.sin(g * t + b)
    return JointLog(t, position)


def _right(arm: Arm, joint: str, seed: int) -> tuple[Arm, Drive]:
    """An arm without friction in steps of .25 ms, and a drive whose torque is that of the inverse dynamics."""
    nothing = np.zeros(len(arm.joints))
    free = replace(arm, frictionloss=nothing, damping=nothing)
    free.model.opt.timestep = 2.5e-4
    drive = drive_of(free, _sines(free, seed), joint, NONE)
    return free, replace(drive, u=free.inverse(drive.q, drive.v, drive.a)[:, drive.at])


def _near(drive: Drive, found: tuple[FloatArray, FloatArray]) -> None:
    """Within 1.5 % of the speed of the fastest joint, and of what it makes of the position in a window."""
    speed = float(np.sqrt(np.max(np.mean(drive.v**2, axis=0))))
    errors = drive.errors(*found)
    assert errors["v"] < 0.015 * speed
    assert errors["x"] < 0.015 * speed * WINDOW


@pytest.mark.parametrize("seed", [0, 1, 3])
def test_the_inverse_dynamics_torque_keeps_a_random_chain_on_its_log(tmp_path: Path, seed: int) -> None:
    """Skew axes, several joints in one body, references, springs and rotors; PyBullet has a URDF of ours."""
    pytest.importorskip("pybullet")
    from harness.robot.replay import in_pybullet

    file = tmp_path / "chain.xml"
    file.write_text(chain(seed))
    arm = load_arm(file)
    joint = next(name for name in reversed(arm.joints) if not arm.slides(name))
    free, drive = _right(arm, joint, seed)
    _near(drive, replay.replay(free, drive))
    text = of_model(free, joint, float(free.armature[drive.at]))
    _near(drive, in_pybullet.replay(free, drive, text, np.array(free.model.qpos0)))


@pytest.mark.parametrize("seed", [0, 2])
def test_a_users_urdf_is_loaded_as_it_is(tmp_path: Path, seed: int) -> None:
    pytest.importorskip("pybullet")
    from harness.robot.replay import in_pybullet

    file = tmp_path / "chain.urdf"
    file.write_text(urdf(seed))
    arm = load_arm(file)
    joint = next(name for name in arm.joints if not arm.slides(name))
    free, drive = _right(arm, joint, seed)
    text = of_file(bare_model(file).root, joint, 0.0)
    _near(drive, in_pybullet.replay(free, drive, text, np.zeros(free.model.nv)))


@pytest.mark.parametrize(("file", "moving"), [("arm.xml", ("shoulder",)), ("arm.urdf", ARM.joints)])
@pytest.mark.parametrize("engine", [MUJOCO, PYBULLET])
def test_the_copy_with_the_right_friction_follows_the_log_and_the_file_does_not(
    file: str, moving: tuple[str, ...], engine: str
) -> None:
    if engine == PYBULLET:
        pytest.importorskip("pybullet")
    log = excited(ARM, FRICTION, moving, duration=6.0)
    path = FILE.with_name(file)
    arm = load_arm(path)
    paste = JointPaste("shoulder", FRICTION["shoulder"].f_k, FRICTION["shoulder"].c, 0.0, 0.002)
    found = replayed(path, arm, log, paste, NONE, engine=engine)
    assert found is not None
    for channel in ("x", "v"):
        assert found.after[channel] < 0.15 * found.before[channel]
    assert found.t.shape == found.logged.shape == found.q_before.shape == found.q_after.shape


def test_a_known_load_hangs_on_the_arm_in_both_engines() -> None:
    """The wrong load takes the shoulder as far off in one engine as in the other."""
    pytest.importorskip("pybullet")
    log = excited(ARM, FRICTION, ("shoulder",), duration=4.0)
    paste = JointPaste("shoulder", FRICTION["shoulder"].f_k, FRICTION["shoulder"].c, 0.0, 0.002)
    with_it = [replayed(FILE, ARM, log, paste, NONE, payload=0.5, engine=name) for name in (MUJOCO, PYBULLET)]
    without = replayed(FILE, ARM, log, paste, NONE)
    assert with_it[0] is not None
    assert with_it[1] is not None
    assert without is not None
    assert with_it[0].after["x"] > 5.0 * without.after["x"]
    assert with_it[0].after["x"] == pytest.approx(with_it[1].after["x"], rel=0.05)


def test_a_file_that_pybullet_does_not_load_is_said(tmp_path: Path) -> None:
    """A joint that moves along an axis and has no limits: MuJoCo takes it, PyBullet does not."""
    pytest.importorskip("pybullet")
    file = tmp_path / "slide.urdf"
    inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    file.write_text(
        f'<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/>{inertia}</inertial></link>'
        '<joint name="j" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/></joint></robot>'
    )
    arm, t = load_arm(file), np.arange(0.0, 3.0, 0.004)
    log = JointLog(t, {"j": np.sin(t)}, effort={"j": np.sin(t)})
    with pytest.raises(SimulationError, match="PyBullet does not load it"):
        replayed(file, arm, log, JointPaste("j", 0.1, 0.1, 0.0, 0.002), NONE, engine=PYBULLET)
