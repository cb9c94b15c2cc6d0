"""A robot's joint as its user has it: the log of an arm with the other joint locked, and the arm's model.

The log has a torque, or of a servo its goals.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.proof.paths.forms import Rng
from harness.proof.paths.rigs import Rig

_DEG = 180.0 / np.pi
_G = 9.81
_MOVED, _LOCKED = "elbow", "wrist"
Layout = tuple[str, float, str, float, str, str, bool]
"""Header of the time and its unit over s, of positions and theirs, of speeds and torques; whether the last joint of an
arm is the first."""
_LAYOUTS: Sequence[Layout] = (
    ("t [s]", 1.0, "{}.position [rad]", 1.0, "{}.velocity [rad/s]", "{}.effort [N*m]", False),
    ("__time", 1.0, "/joint_states/{}/position", 1.0, "/joint_states/{}/velocity", "/joint_states/{}/effort", True),
    ("time_ms", 1e3, "{}.position [deg]", _DEG, "{}.velocity [rad/s]", "{}_torque", False),
    ("timestamp", 1.0, "q{}", 1.0, "dq{}", "tau{}", False),
)
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


def layout(rng: Rng) -> Layout:
    """One of those that loggers have."""
    return _LAYOUTS[int(rng.integers(len(_LAYOUTS)))]


def _of_torque(rng: Rng, t: FloatArray, channels: Mapping[str, FloatArray]) -> str:
    chosen = layout(rng)
    at, weight, n = rng.uniform(-1.0, 1.0), rng.uniform(-0.05, 0.05) * float(np.std(channels["u"])), t.size
    still = {
        "x": at + 2e-6 * np.round(rng.standard_normal(n)),
        "v": 1e-4 * rng.standard_normal(n),
        "u": weight + 0.002 * abs(weight) * rng.standard_normal(n),
    }
    return torques(chosen, t, {_MOVED: channels, _LOCKED: still})


def torques(layout: Layout, t: FloatArray, channels: Mapping[str, Mapping[str, FloatArray]]) -> str:
    """A log: channels of the first joint, from the base, are those of all."""
    time, ms, place, degrees, speed, torque, backwards = layout
    stamps = (_EPOCH if time == "__time" else 0.0) + ms * t
    columns = {time: [f"{one:.6f}" for one in stamps]}
    names = list(channels)
    for head, c, unit in ((place, "x", degrees), (speed, "v", 1.0), (torque, "u", 1.0)):
        for name in (reversed(names) if backwards else names) if c in channels[names[0]] else ():
            called = name if head[0] not in "qdt" else str(1 + names.index(name))
            columns[head.format(called)] = [f"{unit * y:.8g}" for y in channels[name][c]]
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
    none = (0.0, 0.0, 0.0)
    end = (far * out[0], far * out[1], far * out[2])
    links = (
        Link(
            "forearm", _MOVED, (0.0, 0.0, 1.0), axis, (1.0 - hand) * mass, end if pull else none, (turning - tip,) * 3
        ),
        Link("hand", _LOCKED, end, out, hand * mass, none, (tip,) * 3),
    )
    text, name = (mjcf(links), "robot.xml") if rng.random() < 0.5 else (urdf(links), "robot.urdf")
    servo = [] if rig.driven else ["--servo", "sts3215:16"]
    return {name: text}, [*servo, "--robot", name, *([] if free else ["--joint", _MOVED])]


_Three = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Link:
    """A body and the hinge that it is on.

    at : the hinge, in the body before, m. axis : its own, in both. mass : kg. centre : of mass, m. turning : inertia
    about it, kg m^2. rotor : kg m^2 at the hinge. long : to the next hinge, m.
    """

    body: str
    joint: str
    at: _Three
    axis: _Three
    mass: float
    centre: _Three
    turning: _Three
    rotor: float = 0.0
    long: float = 0.0

    @property
    def numbers(self) -> list[float]:
        """As a chain has them."""
        return [*self.at, *self.axis, self.mass, *self.centre, *self.turning, self.rotor]


def _said(three: Sequence[float]) -> str:
    return " ".join(f"{one:.9g}" for one in three)


def mjcf(links: Sequence[Link]) -> str:
    """A chain."""
    lines, ends = list[str](), list[str]()
    for depth, link in enumerate(links):
        space = "  " * (2 + depth)
        rotor = f' armature="{link.rotor:.9g}"' if link.rotor else ""
        lines += [
            f'{space}<body name="{link.body}" pos="{_said(link.at)}">',
            f'{space}  <joint name="{link.joint}" type="hinge" axis="{_said(link.axis)}"{rotor}/>',
            f'{space}  <inertial pos="{_said(link.centre)}" mass="{link.mass:.9g}"'
            f' diaginertia="{_said(link.turning)}"/>',
        ]
        ends.insert(0, f"{space}</body>")
    head = ['<mujoco model="arm">', '  <compiler angle="radian"/>', f'  <option gravity="0 0 -{_G}"/>', "  <worldbody>"]
    return "\n".join([*head, *lines, *ends, "  </worldbody>", "</mujoco>"]) + "\n"


def urdf(links: Sequence[Link]) -> str:
    """The same; a rotor has no word."""
    lines = ['<robot name="arm">', '  <link name="base"/>']
    for link in links:
        about = dict(zip("xyz", link.turning, strict=True))
        pairs = ("xx", "yy", "zz", "xy", "xz", "yz")
        turns = " ".join(f'i{a}="{about[a[0]] if a[0] == a[1] else 0.0:.9g}"' for a in pairs)
        origin = f'<origin xyz="{_said(link.centre)}" rpy="0 0 0"/>'
        inertial = f'<inertial>{origin}<mass value="{link.mass:.9g}"/><inertia {turns}/></inertial>'
        lines.append(f'  <link name="{link.body}">{inertial}</link>')
    for before, link in zip(("base", *(one.body for one in links)), links, strict=False):
        origin = f'<origin xyz="{_said(link.at)}" rpy="0 0 0"/><axis xyz="{_said(link.axis)}"/>'
        whose = f'<parent link="{before}"/><child link="{link.body}"/>'
        lines.append(f'  <joint name="{link.joint}" type="continuous">{whose}{origin}</joint>')
    return "\n".join([*lines, "</robot>"]) + "\n"
