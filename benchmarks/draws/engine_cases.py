"""Joints of users' files as they are, of random parameters.

Each kind is a file that a reduced equation misreads: its flags, its servo, its damping, what else hangs on it. Right is
what MuJoCo's own steps of the file say, with nothing of the harness in between, and a closed form where there is one.
"""

import math
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from benchmarks.draws.shared import Answer
from harness.app.run.joint_servo import servo_scores
from harness.engines.mujoco.presets import warned
from harness.robot.as_it_is import as_it_is
from harness.robot.as_it_is_bullet import in_bullet

G = 9.81
_BAD = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)
Rng = np.random.Generator


def _link(folder: Path, option: str, joint: str, mass: float, arm: float, rest: str = "", body: str = "") -> Path:
    inertia = " ".join([f"{0.1 * mass * arm**2}"] * 3)
    (folder / "file.xml").write_text(
        f'<mujoco><option {option}</option><worldbody><body {body}><joint name="j" axis="0 1 0" {joint}/>'
        f'<inertial pos="{arm} 0 0" mass="{mass}" diaginertia="{inertia}"/></body></worldbody>{rest}</mujoco>'
    )
    return folder / "file.xml"


def _drawn(rng: Rng) -> tuple[float, float, float, float]:
    """Mass, kg, place of its centre, m, inertia about the joint, kg m^2, gravity's torque when level, N m."""
    mass, arm = float(np.exp(rng.uniform(-2.0, 1.0))), float(rng.uniform(0.05, 0.3))
    return mass, arm, 1.1 * mass * arm**2, G * mass * arm


def _step(rng: Rng) -> float:
    return float(np.exp(rng.uniform(math.log(5e-4), math.log(5e-3))))


def _slope(file: Path, joint: str = "j") -> float:
    """N m s/rad of MuJoCo's friction at rest as shipped: b d0/((1 - d0) w), b = 2/(d_width timeconst)."""
    model = mujoco.MjModel.from_xml_path(str(file))
    h, dof = float(model.opt.timestep), int(model.joint(joint).dofadr[0])
    return 2.0 / (0.95 * max(0.02, 2.0 * h)) * 9.0 / float(model.dof_invweight0[dof])


def _stepped(file: Path, seconds: float, **first: float) -> tuple[Any, Any, int | None]:
    """Times and speeds (n,) of the first degree of freedom by mj_step, and the step at which it was lost."""
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    data.qpos[0], data.qvel[0] = first.get("q", 0.0), first.get("v", 0.0)
    rows: list[tuple[float, float]] = []
    with warned():
        for n in range(round(seconds / model.opt.timestep)):
            mujoco.mj_step(model, data)
            if any(data.warning[kind].number for kind in _BAD) or not abs(data.qpos[0]) < 1e3:
                return *np.array(rows or [(0.0, 0.0)]).T, n + 1
            rows.append((data.time, float(data.qvel[0])))
    t, v = np.array(rows).T
    return t, v, None


def _near(value: float | None, right: float, share: float = 0.03) -> bool:
    return value is not None and abs(value - right) <= share * abs(right) + 1e-9


def _servo(integrator: str, rest: str, over: float) -> Callable[[Rng, Path], bool]:
    """A servo about the edge of stability. over : stiffness at the joint over kp."""

    def right(rng: Rng, folder: Path) -> bool:
        mass, arm, inertia, _ = _drawn(rng)
        h = _step(rng)
        k, c = inertia / h**2 * 10.0 ** rng.uniform(-1, 1.2), inertia / h * 10.0 ** rng.uniform(-1, 0.8)
        option = f'timestep="{h}" integrator="{integrator}" gravity="0 0 0">'
        file = _link(folder, option, "", mass, arm, rest.format(kp=k / over, kv=c / over))
        found = servo_scores(as_it_is(file, "j"))
        lost = _stepped(file, 1500 * h, q=1e-3, v=1e-3)[2] is not None
        if found is None or not (_near(found.stiffness, k) and _near(found.damping, c)):
            return False
        if integrator == "implicitfast" and found.cure is not None and found.cure.stiffness is not None:
            return lost and _near(found.cure.stiffness, (4.0 * inertia + 2.0 * h * c) / h**2, 0.01)
        return (found.cure is not None) == lost

    return right


def _creep(rng: Rng, folder: Path) -> bool:
    mass, arm, _, load = _drawn(rng)
    c, friction = load * 10.0 ** rng.uniform(-0.5, 1.0), load * 10.0 ** rng.uniform(0.05, 0.8)
    joint = f'damping="{c}" frictionloss="{friction}"'
    file = _link(folder, f'timestep="{_step(rng)}" integrator="RK4">', joint, mass, arm)
    return _near(as_it_is(file, "j").creep, load / (_slope(file) + c))


def _compensated(rng: Rng, folder: Path) -> bool:
    mass, arm, _, level = _drawn(rng)
    share = float(rng.uniform(0.1, 0.95))
    load, friction = level * (1.0 - share), level * (1.0 - share) * float(rng.uniform(1.1, 5.0))
    option = f'timestep="{_step(rng)}" integrator="implicitfast">'
    file = _link(folder, option, f'frictionloss="{friction}"', mass, arm, body=f'gravcomp="{share}"')
    own = as_it_is(file, "j")
    return _near(own.load, load) and _near(own.creep, load / _slope(file))


def _disabled(rng: Rng, folder: Path) -> bool:
    mass, arm, _, load = _drawn(rng)
    friction, h = load * float(rng.uniform(1.1, 5.0)), _step(rng)
    option = f'timestep="{h}" integrator="implicitfast"><flag frictionloss="disable"/>'
    file = _link(folder, option, f'frictionloss="{friction}"', mass, arm)
    own = as_it_is(file, "j")
    t, v, _ = _stepped(file, 0.5)
    if own.friction != 0.0 or not _near(own.switched_off, friction):
        return False
    times, _, speeds = own.hold
    return times.size > 0 and _near(abs(float(speeds[-1])), abs(float(np.interp(times[-1], t, v))), 0.05)


def _motor(rng: Rng, folder: Path) -> bool:
    mass, arm, _, load = _drawn(rng)
    sliding = load * float(rng.uniform(1.05, 3.0))
    static = sliding * float(rng.uniform(1.05, 1.6))
    lugre = f"{2e3 * load} {load} {sliding} {static} .1"
    rest = f'<actuator><dcmotor joint="j" motorconst=".05" resistance="2" lugre="{lugre}"/></actuator>'
    file = _link(folder, 'timestep="0.002" integrator="implicitfast">', 'damping="0.01"', mass, arm, rest)
    own = as_it_is(file, "j")
    _, v, _ = _stepped(file, 0.5)
    creep = float(np.mean(v[len(v) // 2 :]))
    found = own.friction, own.break_away, own.creep
    return all(_near(one, right) for one, right in zip(found, (sliding, static, creep), strict=True))


def _elsewhere(rng: Rng, folder: Path) -> bool:
    mass, arm, _, load = _drawn(rng)
    friction = load * float(rng.uniform(1.1, 4.0))
    other = (
        '<body pos="0 1 0"><joint name="k" axis="0 1 0"/><inertial pos=".1 0 0" mass="1" diaginertia=".01 .01 .01"/>'
    )
    file = _link(folder, f'timestep="{_step(rng)}">', f'frictionloss="{friction}"', mass, arm)
    text = file.read_text().replace("</worldbody>", f"{other}</body></worldbody>")
    gain = f'<actuator><pid joint="k" kp="{rng.uniform(1, 50)}" kv="{rng.uniform(0, 2)}"/></actuator>'
    file.write_text(text.replace("</mujoco>", f"{gain}</mujoco>"))
    return _near(as_it_is(file, "j").creep, load / _slope(file))


def _floating(rng: Rng, folder: Path) -> bool:
    trunk, thigh, shank = rng.uniform(1.0, 9.0), rng.uniform(0.3, 2.0), rng.uniform(0.1, 0.5)
    f, c, rotor = rng.uniform(0.1, 0.5), rng.uniform(0.02, 0.5), rng.uniform(0.002, 0.02)
    joint = f'axis="0 1 0" armature="{rotor}" damping="{c}" frictionloss="{f}"/>'
    (folder / "leg.xml").write_text(
        f'<mujoco><option integrator="implicitfast" gravity="0 0 0"/><worldbody><body><freejoint/>'
        f'<inertial pos="0 0 0" mass="{trunk}" diaginertia=".1 .1 .1"/><body><joint name="hip" {joint}'
        f'<inertial pos="0 0 -.1" mass="{thigh}" diaginertia=".005 .005 .001"/><body pos="0 0 -.2">'
        f'<joint name="knee" {joint}<inertial pos="0 0 -.1" mass="{shank}" diaginertia=".001 .001 .0002"/>'
        "</body></body></body></worldbody></mujoco>"
    )
    name = str(rng.choice(("hip", "knee")))
    creep = as_it_is(folder / "leg.xml", name).creep
    return _near(creep, 0.97 * f / (_slope(folder / "leg.xml", name) + c))


def _noslip(rng: Rng, folder: Path) -> bool:
    m, h, f = 10.0 ** rng.uniform(-6, -4), _step(rng), 10.0 ** rng.uniform(-2, 0)
    d = m / h * 10.0 ** rng.uniform(0.5, 1.7)
    option = f'timestep="{h}" integrator="implicitfast" gravity="0 0 0" noslip_iterations="5">'
    file = _link(folder, option, f'damping="{d}" frictionloss="{f}"', 10.0 * m, 0.0)
    text = file.read_text().replace('diaginertia="0.0 0.0 0.0"', f'diaginertia="{m} {m} {m}"')
    file.write_text(text)
    stop = as_it_is(file, "j").stop
    if stop is None:
        return False
    t, v, _ = _stepped(file, 4.2, v=stop.v0)
    slow = np.flatnonzero(np.abs(v) <= 0.05 * stop.v0)
    own = float(t[slow[0]]) if slow.size and t[slow[0]] <= 4.0 else math.inf
    return stop.time == own if math.isinf(own) else abs(stop.time - own) <= max(0.01 * own, 1.5 * h)


def _bullet(rng: Rng, folder: Path) -> bool:
    ratio = 2.0 * float(rng.choice((rng.uniform(0.1, 0.9), rng.uniform(1.1, 12.0))))
    tuned = bool(rng.integers(2))
    mass, arm, inertia, load = _drawn(rng)
    h = 0.002 if tuned else 1.0 / 240.0
    own = 0.1 * mass * arm**2
    (folder / "a.urdf").write_text(
        f'<robot name="r"><link name="base"/><link name="link"><inertial><origin xyz="{arm} 0 0"/><mass '
        f'value="{mass}"/><inertia ixx="{own}" iyy="{own}" izz="{own}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="j" type="revolute"><parent link="base"/><child link="link"/><axis xyz="0 1 0"/>'
        '<limit lower="-3" upper="3" effort="100" velocity="100"/>'
        f'<dynamics damping="{ratio * inertia / h}" friction="{1.2 * load}"/></joint></robot>'
    )
    preset = "tuned" if tuned else "as-shipped"
    found = in_bullet(folder / "a.urdf", "j", as_it_is(folder / "a.urdf", "j"), None, preset, 0.002)
    return (found.diverges is not None) == (ratio > 2.0)


_POSITION = '<actuator><position joint="j" kp="{kp}" kv="{kv}"/></actuator>'
_TENDON = (
    '<tendon><fixed name="t"><joint joint="j" coef="2"/></fixed></tendon>'
    '<actuator><position tendon="t" kp="{kp}" kv="{kv}"/></actuator>'
)
KINDS: Mapping[str, Callable[[Rng, Path], bool]] = {
    "cap-implicitfast": _servo("implicitfast", _POSITION, 1.0),
    "cap-rk4": _servo("RK4", _POSITION, 1.0),
    "tendon-servo": _servo("Euler", _TENDON, 4.0),
    "pid-elsewhere": _elsewhere,
    "flag-frictionloss": _disabled,
    "creep-with-damping": _creep,
    "gravcomp": _compensated,
    "dcmotor-lugre": _motor,
    "floating-base": _floating,
    "noslip-damping": _noslip,
    "pybullet-damping": _bullet,
}


def answer(seed: int, number: int, *, kind: str) -> Answer:
    """Of one draw of a kind."""
    rng = np.random.default_rng((seed, number, [*KINDS].index(kind)))
    with tempfile.TemporaryDirectory() as folder:
        return Answer(KINDS[kind](rng, Path(folder)), kind)
