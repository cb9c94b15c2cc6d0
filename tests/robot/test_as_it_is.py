"""The user's file itself, stepped: against closed forms, and MuJoCo's own steps of the same file, random parameters."""

import math
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from harness.app.run.joint import JointRun, run_joint
from harness.app.run.joint_servo import servo_scores
from harness.engines.mujoco.presets import warned
from harness.fidelity import laws
from harness.results.run import JointRunResult, ServoResult
from harness.robot.as_it_is import as_it_is
from harness.robot.as_it_is_bullet import in_bullet

IN_CI, ALL = 2, 20
DRAWS = [*range(IN_CI), *(pytest.param(i, marks=pytest.mark.full) for i in range(IN_CI, ALL))]
G = 9.81


def file_of(
    folder: Path,
    joint: str = "",
    actuator: str = "",
    *,
    mass: float = 0.5,
    arm: float = 0.1,
    inertia: float = 0.0005,
    option: str = "",
    body: str = "",
    more: str = "",
) -> Path:
    """A link on a hinge j, level at the reference, and another beside it that moves something else."""
    link = f'<inertial pos="{arm} 0 0" mass="{mass}" diaginertia="{inertia} {inertia} {inertia}"/>'
    text = (
        f"<mujoco><option {option}</option><worldbody>"
        f'<body name="link" {body}><joint name="j" axis="0 1 0" {joint}/>{link}</body>'
        f'<body name="other" pos="0 1 0"><joint name="k" axis="0 1 0"/>{link}</body></worldbody>'
        f'{more}<actuator>{actuator}<pid joint="k" kp="2" kv="1"/></actuator></mujoco>'
    )
    (folder / "file.xml").write_text(text)
    return folder / "file.xml"


def softness(model: Any, dof: int) -> float:
    """N m s/rad of MuJoCo's friction at rest as shipped: b d0/((1 - d0) w), b = 2/(d_width timeconst)."""
    return 2.0 / (0.95 * 0.02) * 9.0 / float(model.dof_invweight0[dof])


def survives(file: Path, h: float | None = None, kp: float = 1.0, armature: float = 0.0) -> bool:
    """Whether MuJoCo's own steps of a file stay near the target of the servo of j."""
    text = file.read_text().replace('name="j"', f'name="j" armature="{armature}"')
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.timestep = h or model.opt.timestep
    if model.actuator_biastype[0] == mujoco.mjtBias.mjBIAS_DCMOTOR.value:
        model.actuator_gainprm[0, 4] *= kp
    else:
        model.actuator_biasprm[0, 1] *= kp
        model.actuator_gainprm[0, 0] *= kp
    data = mujoco.MjData(model)
    data.qpos[0] = data.qvel[0] = 1e-3
    sizes = []
    with warned():
        for _ in range(8):
            mujoco.mj_step(model, data, 200)
            sizes.append(abs(float(data.qpos[0])) + model.opt.timestep * abs(float(data.qvel[0])))
    return not any(one.number for one in data.warning) and max(sizes[4:]) <= 4.0 * max(*sizes[:4], 2e-3)


SERVOS = {
    "position": '<position joint="j" kp="{kp}" kv="{kv}"/>',
    "geared": '<position joint="j" kp="{kp}" kv="{kv}" gear="3"/>',
    "velocity": '<velocity joint="j" kv="{kv}"/>',
    "tendon": '<position tendon="t" kp="{kp}" kv="{kv}"/>',
    "pid": '<pid joint="j" kp="{kp}" kv="{kv}"/>',
    "dcmotor": '<dcmotor joint="j" motorconst=".05" resistance="2" controller="{kp} 0 {kv}" input="pos"/>',
}
GEARS = {"geared": 9.0, "tendon": 4.0}
TENDON = '<tendon><fixed name="t"><joint joint="j" coef="2"/></fixed></tendon>'
INTEGRATORS = ("Euler", "implicitfast", "RK4")


def drawn_servo(folder: Path, kind: str, draw: int) -> tuple[Path, ServoResult]:
    """A servo somewhere about the edge of stability."""
    random = np.random.default_rng([13, draw, list(SERVOS).index(kind)])
    m, h = 10.0 ** random.uniform(-3, 0), 10.0 ** random.uniform(-3, -2)
    kp, kv = m / h**2 * 10.0 ** random.uniform(-1, 1.2), m / h * 10.0 ** random.uniform(-1, 0.8)
    damping = m / h * 10.0 ** random.uniform(-2, 0)
    integrator = INTEGRATORS[int(random.integers(3))]
    over = GEARS.get(kind, 1.0)
    file = file_of(
        folder,
        f'damping="{damping}"',
        SERVOS[kind].format(kp=kp / over, kv=kv / over),
        arm=0.0,
        inertia=m,
        option=f'timestep="{h}" integrator="{integrator}" gravity="0 0 0">',
        more=TENDON,
    )
    found = servo_scores(as_it_is(file, "j"))
    assert found is not None
    assert found.stiffness == pytest.approx(0.0 if kind == "velocity" else kp, rel=1e-6)
    assert found.damping == pytest.approx(kv + damping, rel=1e-6)
    return file, found


@pytest.mark.parametrize("kind", SERVOS)
@pytest.mark.parametrize("draw", DRAWS)
def test_a_servo_diverges_where_mujocos_steps_of_the_file_do(tmp_path: Path, kind: str, draw: int) -> None:
    file, found = drawn_servo(tmp_path, kind, draw)
    assert found.scores[0].stable == survives(file)
    assert (found.cure is None) == found.scores[0].stable
    if found.cure is None:
        return
    cure = found.cure
    if cure.step_s is not None:
        assert survives(file, h=cure.step_s * 0.998)
        assert not survives(file, h=min(cure.step_s * 1.03, found.step_s))
    if cure.stiffness is not None:
        kp = cure.stiffness / found.stiffness
        assert survives(file, kp=kp * 0.998)
        assert not survives(file, kp=min(kp * 1.03, 1.0))
    if cure.armature is not None:
        assert survives(file, armature=cure.armature * 1.002)
        assert not survives(file, armature=cure.armature * 0.95)
    text = file.read_text()
    for name in INTEGRATORS:
        file.write_text(text.replace(f'integrator="{_integrator(text)}"', f'integrator="{name}"'))
        assert name == _integrator(text) or survives(file) == (name in cure.integrators)


def _integrator(text: str) -> str:
    return text.split('integrator="')[1].split('"', maxsplit=1)[0]


def test_stability_is_jurys_two_conditions() -> None:
    random = np.random.default_rng(1)
    for _ in range(500):
        m, h = 10.0 ** random.uniform(-3, 1, 2)
        c, end = m / h * 10.0 ** random.uniform(-2, 2, 2)
        k = m / h**2 * 10.0 ** random.uniform(-2, 2)
        both = h * h * k < 4 * m - 2 * h * c + 2 * h * end and h * c < 2 * m + h * end
        assert laws.stable(laws.semi_implicit_step(m, c, end, k, h)) == both
        radius = max(abs(np.linalg.eigvals(np.array(laws.held_step(m, c, k, h, 3)))))
        assert laws.stable(laws.held_step(m, c, k, h, 3)) == (radius <= 1.0 + 1e-9)
        assert laws.stable(laws.implicit_step(m, c, k, h, 2))
        free = h * math.sqrt(k / m) < laws.RK4_IMAGINARY
        assert laws.stable(laws.runge_kutta_step(m, 0.0, k, h)) == free


@pytest.mark.parametrize("draw", DRAWS)
def test_creep_is_the_loads_over_softness_and_every_damping(tmp_path: Path, draw: int) -> None:
    """F/(s + c + kv), of what gravity compensation leaves; a stiff servo is let go, a braking one stays."""
    random = np.random.default_rng([14, draw])
    share, c, kv = random.uniform(0.0, 0.8), 10.0 ** random.uniform(-1, 1), 10.0 ** random.uniform(-1, 1)
    load = 0.5 * G * 0.1 * (1.0 - share)
    integrator = INTEGRATORS[draw % 3]
    friction = load * 10.0 ** random.uniform(0.02, 1)
    act = f'<velocity joint="j" kv="{kv}"/>' if draw % 2 else f'<position joint="j" kp="50" kv="{kv}"/>'
    option = f'timestep="0.0005" integrator="{integrator}">'
    file = file_of(tmp_path, f'damping="{c}" frictionloss="{friction}"', act, option=option, body=f'gravcomp="{share}"')
    own = as_it_is(file, "j")
    brakes = softness(mujoco.MjModel.from_xml_path(str(file)), 0) + c + (kv if draw % 2 else 0.0)
    assert own.load == pytest.approx(min(load, 0.97 * friction))
    assert own.creep == pytest.approx(own.load / brakes, rel=0.02)


@pytest.mark.parametrize("draw", DRAWS)
def test_a_motors_bristle_holds_below_its_break_away(tmp_path: Path, draw: int) -> None:
    random = np.random.default_rng([15, draw])
    sliding = 0.5 * G * 0.1 * random.uniform(0.5, 2.0)
    static = sliding * random.uniform(1.05, 1.5)
    act = f'<dcmotor joint="j" motorconst=".05" resistance="2" lugre="1000 10 {sliding} {static} .1"/>'
    own = as_it_is(file_of(tmp_path, 'damping=".01"', act, option='integrator="implicitfast">'), "j")
    assert own.friction == pytest.approx(sliding)
    assert own.break_away == pytest.approx(static)
    assert own.creep == pytest.approx(0.0, abs=1e-5)
    assert f"breaks away at {static:.4g} N m and slides at {sliding:.4g} N m" in own.notes[0]


@pytest.mark.parametrize("draw", DRAWS)
def test_friction_that_a_flag_disables_holds_nothing(tmp_path: Path, draw: int) -> None:
    """The link falls from level as a pendulum does: by energy, v^2 = 2 G sin(q)/I."""
    friction = float(np.random.default_rng([16, draw]).uniform(0.6, 5.0))
    file = file_of(tmp_path, f'frictionloss="{friction}"', option='><flag frictionloss="disable"/>')
    own = as_it_is(file, "j")
    assert own.friction == 0.0
    assert own.switched_off == pytest.approx(friction)
    _, x, v = own.hold
    assert v**2 == pytest.approx(2.0 * 0.5 * G * 0.1 * np.sin(x) / 0.0055, rel=0.2, abs=3.0)
    assert np.max(x) > 1.0


@pytest.mark.parametrize("draw", DRAWS)
def test_noslip_beside_damping_pushes_on(tmp_path: Path, draw: int) -> None:
    """It brings the acceleration to that of the constraint, -b v, with b = 2/(d_width timeconst), before the damping is
    taken at the step's end: v' = v (1 - h b M/(M + h D)) a step, while |v| < f/D. With b = 1/h that is h D/(M + h D).
    """
    random = np.random.default_rng([17, draw])
    m, h, f = 10.0 ** random.uniform(-6, -4), 10.0 ** random.uniform(-3, -2.5), 10.0 ** random.uniform(-2, 0)
    constant = h * random.uniform(2.5, 12.0)
    d = m / h * 10.0 ** random.uniform(0.7, 1.7)
    option = (
        f'timestep="{h}" integrator="implicitfast" gravity="0 0 0" noslip_iterations="10" noslip_tolerance="1e-15">'
    )
    file = file_of(
        tmp_path, f'damping="{d}" frictionloss="{f}" solreffriction="{constant} 1"', arm=0.0, inertia=m, option=option
    )
    own = as_it_is(file, "j")
    assert own.stop is not None
    steps = math.log(0.05) / math.log(1.0 - 2.0 * h / (0.95 * constant) * m / (m + h * d))
    assert own.stop.time / h == pytest.approx(steps, rel=0.01, abs=1.0)


@pytest.mark.parametrize("draw", DRAWS)
def test_a_floating_base_is_held_and_the_softness_is_the_files(tmp_path: Path, draw: int) -> None:
    random = np.random.default_rng([18, draw])
    trunk, leg, f = random.uniform(1.0, 9.0), random.uniform(0.2, 2.0), random.uniform(0.1, 0.5)
    i = leg * 0.01
    (tmp_path / "leg.xml").write_text(
        f'<mujoco><option gravity="0 0 0"/><worldbody><body name="trunk"><freejoint/>'
        f'<inertial pos="0 0 0" mass="{trunk}" diaginertia=".1 .1 .1"/><body>'
        f'<joint name="hip" axis="0 1 0" frictionloss="{f}"/>'
        f'<inertial pos="0 0 -.1" mass="{leg}" diaginertia="{i} {i} {i}"/></body></body></worldbody></mujoco>'
    )
    own = as_it_is(tmp_path / "leg.xml", "hip")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "leg.xml"))
    assert own.inertia == pytest.approx(i + leg * 0.01)
    assert own.creep == pytest.approx(0.97 * f / softness(model, 6), rel=0.01)


@pytest.mark.usefixtures("pybullet")
@pytest.mark.parametrize("draw", DRAWS)
def test_pybullets_joint_damping_is_explicit(tmp_path: Path, draw: int) -> None:
    """It diverges where h c/I is above 2."""
    ratio = 2.0 * (1.15 if draw % 2 else 0.87) ** (1 + draw % 3)
    h = (1 / 240, 0.002)[draw % 2]
    (tmp_path / "a.urdf").write_text(
        '<robot name="r"><link name="base"/><link name="link"><inertial><origin xyz=".1 0 0"/><mass value=".5"/>'
        '<inertia ixx=".0005" iyy=".0005" izz=".0005" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="j" type="revolute"><parent link="base"/><child link="link"/><axis xyz="0 1 0"/>'
        '<limit lower="-3" upper="3" effort="100" velocity="100"/>'
        f'<dynamics damping="{ratio * 0.0055 / h}" friction=".6"/></joint></robot>'
    )
    preset = "as-shipped" if draw % 2 == 0 else "tuned"
    own = as_it_is(tmp_path / "a.urdf", "j")
    found = in_bullet(tmp_path / "a.urdf", "j", own, None, preset, 0.002)
    assert (found.diverges is not None) == (ratio > 2.0)


def run_of(file: Path, out: Path) -> JointRunResult:
    return run_joint(JointRun(file, "j", engines=("mujoco",), presets=("as-shipped",)), out / "out")


def test_a_servo_that_diverges_is_told_with_its_cure(tmp_path: Path) -> None:
    act = '<position joint="j" kp="8000" kv="5"/>'
    found = run_of(file_of(tmp_path, "", act, option='timestep=".005" integrator="implicitfast">'), tmp_path)
    assert found.servo is not None
    assert found.servo.cure is not None
    assert found.servo.diverges_after is not None
    assert found.servo.cure.kp == pytest.approx(2880, rel=1e-3)
    assert found.servo.cure.step_s == pytest.approx(2.39e-3)
    assert any("kp at most 2880" in sentence and "2.39 ms" in sentence for sentence in found.conclusions)


def test_where_file_and_reduced_joint_disagree_it_is_said(tmp_path: Path) -> None:
    found = run_of(file_of(tmp_path, 'damping="5" frictionloss="1"', option='integrator="RK4">'), tmp_path)
    (itself,) = found.as_it_is
    assert itself.creep == pytest.approx(0.4905 / 10.21, rel=0.01)
    assert itself.differs is not None
    assert "damping" in itself.differs
    assert itself.differs in found.conclusions
