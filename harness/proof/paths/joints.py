"""A robot's joint as its user has it: the log of an arm with the other joint locked, and the arm's model.

The log has a torque, or of a servo its goals.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from harness.core.arrays import FloatArray
from harness.proof.paths.forms import Rng
from harness.proof.paths.rigs import Rig

_DEG = 180.0 / np.pi
_G = 9.81
_MOVED, _LOCKED = "elbow", "wrist"
_LAYOUTS: Sequence[tuple[str, float, str, float, str, str, str]] = (
    ("t [s]", 1.0, "{}.position [rad]", 1.0, "{}.velocity [rad/s]", "{}.effort [N*m]", "ew"),
    ("__time", 1.0, "/joint_states/{}/position", 1.0, "/joint_states/{}/velocity", "/joint_states/{}/effort", "we"),
    ("time_ms", 1e3, "{}.position [deg]", _DEG, "{}.velocity [rad/s]", "{}_torque", "ew"),
    ("timestamp", 1.0, "q{}", 1.0, "dq{}", "tau{}", "ew"),
)
"""Header of the time and its unit over s, of positions and theirs, of speeds and torques; in which order joints are."""
_GOALS: Sequence[tuple[str, float, str, str, float]] = (
    ("t [s]", 1.0, "{}.goal", "{}.position", 1.0),
    ("time_ms", 1e3, "{}.goal [deg]", "{}.position [deg]", _DEG),
    ("t", 1.0, "xcmd{}_rad", "x{}_rad", 1.0),
)
"""Header of the time and its unit over s, of goals, of positions and their unit."""
_EPOCH = 1.7e9
ROTOR = 0.3
"""Share of a servo's inertia that is its rotor's, behind the gears, and that no model has."""


def log(rng: Rng, t: FloatArray, channels: Mapping[str, FloatArray], rig: Rig) -> str:
    """A log of both joints: x and, where they are there, u and v of the one that moves, (n,) each, SI."""
    return _of_torque(rng, t, channels) if rig.driven else _of_goals(rng, t, channels["x"], rig.drive[0])


def _of_goals(rng: Rng, t: FloatArray, x: FloatArray, goal: FloatArray) -> str:
    time, ms, asked, place, degrees = _GOALS[int(rng.integers(len(_GOALS)))]
    at = np.full_like(t, rng.uniform(-1.0, 1.0))
    columns = {time: [f"{one:.6g}" for one in ms * t]}
    for head, each in ((asked, (goal, at)), (place, (x, at))):
        for name, number, y in zip((_MOVED, _LOCKED), "12", each, strict=True):
            columns[head.format(name if head[0] == "{" else number)] = [f"{degrees * one:.8g}" for one in y]
    return _table(columns)


def _table(columns: Mapping[str, Sequence[str]]) -> str:
    return "\n".join([",".join(columns), *map(",".join, zip(*columns.values(), strict=True))]) + "\n"


def _of_torque(rng: Rng, t: FloatArray, channels: Mapping[str, FloatArray]) -> str:
    time, ms, place, degrees, speed, torque, order = _LAYOUTS[int(rng.integers(len(_LAYOUTS)))]
    at, weight, n = rng.uniform(-1.0, 1.0), rng.uniform(-0.05, 0.05) * float(np.std(channels["u"])), t.size
    still = {
        "x": at + 2e-6 * np.round(rng.standard_normal(n)),
        "v": 1e-4 * rng.standard_normal(n),
        "u": weight + 0.002 * abs(weight) * rng.standard_normal(n),
    }
    stamps = (_EPOCH if time == "__time" else 0.0) + ms * t
    columns = {time: [f"{one:.6f}" for one in stamps]}
    for head, c, unit in ((place, "x", degrees), (speed, "v", 1.0), (torque, "u", 1.0)):
        for which in order if c in channels else "":
            name = (_MOVED if which == "e" else _LOCKED) if head[0] not in "qdt" else str(1 + "ew".index(which))
            columns[head.format(name)] = [f"{unit * y:.8g}" for y in (channels if which == "e" else still)[c]]
    return _table(columns)


def described(rng: Rng, rig: Rig, free: bool) -> tuple[dict[str, str], list[str]]:
    """The arm's model by the name of its file, MJCF or URDF, and the options. free : no more than are necessary."""
    inertia, _, pull, _, _ = map(float, rig.b)
    if not rig.driven:
        if free:
            return {}, []
        inertia *= 1.0 - ROTOR
    # what is level at the joint's zero, and how far out the mass is that gravity and inertia ask for
    mass = 2.0 * pull**2 / (_G**2 * inertia) if pull else 4.0 * inertia
    far, hand = (pull / (_G * mass) if pull else 0.1), rng.uniform(0.1, 0.3)
    turning, tip = inertia - (mass if pull else hand * mass) * far**2, 0.05 * inertia
    up = -rig.zero - 0.5 * np.pi if pull else rng.uniform(-3.0, 3.0)
    out = (np.cos(up), 0.0, np.sin(up)) if pull else (np.cos(up), np.sin(up), 0.0)
    axis = (0.0, -1.0, 0.0) if pull else (0.0, 0.0, 1.0)
    centre = [far * one for one in out] if pull else [0.0, 0.0, 0.0]
    arm = ((1.0 - hand) * mass, centre, turning - tip), (hand * mass, [far * one for one in out], tip)
    text, name = (_mjcf(arm, axis, out), "robot.xml") if rng.random() < 0.5 else (_urdf(arm, axis, out), "robot.urdf")
    servo = [] if rig.driven else ["--servo", "sts3215:16"]
    return {name: text}, [*servo, "--robot", name, *([] if free else ["--joint", _MOVED])]


_Body = tuple[float, Sequence[float], float]
"""Mass, centre of mass (of the second body: its joint, through which it goes), inertia about it, alike in all axes."""
_Three = Sequence[float]


def _said(three: _Three) -> str:
    return " ".join(f"{one:.9g}" for one in three)


def _mjcf(arm: tuple[_Body, _Body], axis: _Three, along: _Three) -> str:
    (mass, centre, turning), (hand, at, tip) = arm
    return f"""<mujoco model="arm">
  <compiler angle="radian"/>
  <option gravity="0 0 -{_G}"/>
  <worldbody>
    <body name="forearm" pos="0 0 1">
      <joint name="{_MOVED}" type="hinge" axis="{_said(axis)}"/>
      <inertial pos="{_said(centre)}" mass="{mass:.9g}" diaginertia="{_said([turning] * 3)}"/>
      <body name="hand" pos="{_said(at)}">
        <joint name="{_LOCKED}" type="hinge" axis="{_said(along)}"/>
        <inertial pos="0 0 0" mass="{hand:.9g}" diaginertia="{_said([tip] * 3)}"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def _urdf(arm: tuple[_Body, _Body], axis: _Three, along: _Three) -> str:
    (mass, centre, turning), (hand, at, tip) = arm

    def link(name: str, mass: float, at: _Three, turning: float) -> str:
        turns = " ".join(f'i{a}="{turning if a[0] == a[1] else 0.0:.9g}"' for a in ("xx", "yy", "zz", "xy", "xz", "yz"))
        origin = f'<origin xyz="{_said(at)}" rpy="0 0 0"/>'
        inertial = f'<inertial>{origin}<mass value="{mass:.9g}"/><inertia {turns}/></inertial>'
        return f'  <link name="{name}">{inertial}</link>'

    def joint(name: str, ends: tuple[str, str], at: _Three, axis: _Three) -> str:
        origin = f'<origin xyz="{_said(at)}" rpy="0 0 0"/><axis xyz="{_said(axis)}"/>'
        whose = f'<parent link="{ends[0]}"/><child link="{ends[1]}"/>'
        return f'  <joint name="{name}" type="continuous">{whose}{origin}</joint>'

    lines = [
        '<robot name="arm">',
        '  <link name="base"/>',
        link("forearm", mass, centre, turning),
        link("hand", hand, (0.0, 0.0, 0.0), tip),
        joint(_MOVED, ("base", "forearm"), (0.0, 0.0, 1.0), axis),
        joint(_LOCKED, ("forearm", "hand"), at, along),
        "</robot>",
    ]
    return "\n".join(lines) + "\n"
