"""A log as it was read, before anybody has looked at what is in it.

How columns of a robot's log are named: the words, and the shapes of names that hold them.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from harness.core.apart import Found
from harness.core.arrays import FloatArray
from harness.core.errors import InputError, did_you_mean
from harness.io.columns import ENDINGS, is_commanded
from harness.io.options import ReadOptions
from harness.io.units import parse_unit

Field = Literal["position", "velocity", "effort", "current", "magnitude", "goal", "voltage", "driven", "temperature"]
CHANNEL: dict[Field, str] = {
    "position": "x",
    "velocity": "v",
    "effort": "u",
    "current": "i",
    "magnitude": "u",
    "goal": "x",
    "voltage": "e",
    "driven": "n",
    "temperature": "h",
}
"""What is logged of a joint, and the channel whose units it has; a magnitude is an effort without its sign, a goal the
position that is asked of a servo, driven whether it drives (1 or 0)."""
SI_UNITS: dict[Field, str] = {
    "position": "rad",
    "velocity": "rad/s",
    "effort": "N m",
    "current": "A",
    "magnitude": "N m",
    "goal": "rad",
    "voltage": "V",
    "driven": "1",
    "temperature": "degC",
}
"""What is assumed where nothing says a unit (a slide: m, m/s, N)."""
WORDS: dict[Field, tuple[str, ...]] = {
    "position": ("position", "positions", "pos", "q", "qpos", "angle", "x", "theta"),
    "velocity": ("velocity", "velocities", "vel", "dq", "qd", "qvel", "speed", "v", "omega", "dtheta", "thetadot"),
    "effort": ("effort", "efforts", "torque", "torques", "tau", "tau_j", "u", "tau_est", "tauest", "qfrc_actuator"),
    "current": ("current", "currents", "cur"),
    "magnitude": ("absu", "abstau", "abseffort", "abstorque"),
    "goal": ("goal", "action"),
    "voltage": ("voltage", "volts", "input_volts", "input_voltage", "vin"),
    "driven": ("torque_enable", "torque_enabled", "enabled"),
    "temperature": ("temperature", "temperatures", "temp", "motor_temperature", "motor_temp", "joint_temperatures"),
}
"""Words for each; where a file has several of them, the first is taken."""
SHORT = frozenset({"x", "v", "u"})
"""Words that say nothing behind the name of something (base.x)."""
TOPICS = frozenset({"joint_states", "joint_state", "field", "observation", "robot", "state"})
"""Names before a field that are no joint's."""

FIELD_OF: dict[str, Field] = {word: field for field, words in WORDS.items() for word in words}
_ENDINGS = {
    **ENDINGS,
    "i": {"a": "A", "ma": "mA"},
    "e": {"v": "V", "mv": "mV"},
    "n": {},
    "h": {"c": "degC", "degc": "degC", "k": "K"},
}


_TOPIC = re.compile("^/?(?:joint_states?/|observation[./]state[./])")
"""What stands before a joint's name and is the topic's."""


def _any(words: "frozenset[str] | set[str]") -> str:
    return "|".join(sorted(words, key=lambda word: (-len(word), word)))


_WORD = f"(?P<word>{_any(set(FIELD_OF))})"
_LONG = f"(?P<word>{_any(set(FIELD_OF) - SHORT)})"
_UNIT = f"(?:_(?P<unit>{_any({ending for found in _ENDINGS.values() for ending in found})}))?"
_ACTUAL = "(?:(?:actual|measured|meas|present)[_ ])?"
_JOINT = "(?:(?<=[_.])(?:j|jnt|joint|axis|a)[_.]?)?"
_ACTUAL_AFTER = "(?:_(?:actual|act|measured|meas|fb))?"

RULES: tuple[tuple[str, re.Pattern[str]], ...] = tuple(
    (said, re.compile(pattern, re.IGNORECASE))
    for said, pattern in (
        # position[0], /joint_states/effort[12], field.position0, actual_qd_0, x1_rad, tau1, q.7, pos_meas1, position_j1
        ("numbered", rf"^(?:.*[./])?{_ACTUAL}{_WORD}{_ACTUAL_AFTER}[\[_.]?{_JOINT}(?P<number>\d{{1,3}})\]?{_UNIT}$"),
        # elbow.position, elbow/velocity, /joint_states/elbow/effort, elbow.pos
        ("named", rf"^(?P<joint>\S.*?)[./]{_ACTUAL}{_LONG}{_UNIT}$"),
        # q, dq, tau, x_rad: a log of one joint
        ("single", rf"^(?:(?:.*[./])?(?:{_any(TOPICS)})[./])?{_ACTUAL}{_WORD}{_ACTUAL_AFTER}{_UNIT}$"),
        # elbow_pos, joint1_torque_Nm
        ("named", rf"^(?P<joint>\S.*?)[_ -]{_ACTUAL}{_LONG}{_UNIT}$"),
    )
)
"""Shapes of names, the first that fits is taken. numbered: joints in the model's order, from 0 or from 1."""


@dataclass(frozen=True, slots=True)
class Named:
    """What a column's name says: how it says it, the field, the word for it, whose, and the unit it ends with.

    path : the joint's name with what stands before it, "left/elbow" of elbow.
    """

    style: str
    field: Field
    word: str
    joint: str = ""
    number: int = 0
    unit: str | None = None
    path: str = ""


def named(name: str) -> Named | None:
    """What the name of a column says of a joint ("elbow.position", "actual_qd_0", "u1_Nm"); None for any other."""
    text = name.strip()
    if is_commanded(text):
        return _goal(text)
    for style, pattern in RULES:
        found = pattern.match(text)
        if found is None:
            continue
        parts = found.groupdict()
        word, ending = parts["word"].lower(), (parts["unit"] or "").lower()
        units = _ENDINGS[CHANNEL[FIELD_OF[word]]]
        path = _TOPIC.sub("", (parts.get("joint") or "").rstrip("/"))
        joint = path.rpartition("/")[2]
        if (ending and ending not in units) or (style == "named" and joint.lower() in {"", *TOPICS}):
            continue
        return Named(style, FIELD_OF[word], word, joint, int(parts.get("number") or 0), units.get(ending), path)
    return None


_ASKED = re.compile(
    r"(?<![a-z])(?:commanded|command|target|goal|desired|setpoint|reference|action|cmd|des|ref)(?![a-z])", re.IGNORECASE
)
"""The word of a name by which it is what was asked for."""


def _goal(text: str) -> Named | None:
    """What the name of a command says ("goal_position", "elbow.goal", "xcmd1_rad", "action/elbow.pos")."""
    bare = text.replace("xcmd", "x").replace("XCMD", "x")
    if bare == text:
        bare = re.sub(r"[ ._/-]{2,}", ".", _ASKED.sub("", text, count=1)).strip(" _./-")
        bare = f"position{bare}" if bare.startswith("[") else bare
    if is_commanded(bare):
        return None
    found = named(bare) or (named(f"{bare}.position") if bare else Named("single", "position", "goal"))
    if found is None or found.field != "position":
        return None
    return replace(found, field="goal", word="goal")


Fields = dict[Field, dict[str, FloatArray]]


@dataclass(frozen=True, slots=True, kw_only=True)
class LogOptions(ReadOptions):
    """How to read a log: as a recording, and

    joints : names in the model's order: they are chosen by name, and are the names where a log has none. topic : of a
    bag, or the episode of a data set. angle_unit : of positions that say none. names : of the log's joints, or of one
    field of them ("elbow.effort"), the model's; a shape of both ("a_joint{i}": "b_joint{i}"), or "*": "*" for their
    order. flip : joints that turn the other way. offset : what is added to a position, rad or m, by joint. join : here
    each file has a signal of all joints. calibration : LeRobot's file, by which positions are shares of ranges.
    """

    joints: tuple[str, ...] | None = None
    topic: str | None = None
    angle_unit: str | None = None
    names: Mapping[str, str] = field(default_factory=dict)
    flip: tuple[str, ...] = ()
    offset: Mapping[str, float] = field(default_factory=dict)
    calibration: Path | None = None

    def __post_init__(self) -> None:
        ReadOptions.__post_init__(self)
        if self.angle_unit is not None:
            parse_unit("--angle-unit", "x", self.angle_unit)
        # a list comes from a program, or from the process beside
        object.__setattr__(self, "joints", None if self.joints is None else tuple(self.joints))
        if self.calibration is not None and self.angle_unit is not None:
            raise InputError("--angle-unit", "given with --calibration", "one of the two")


@dataclass(frozen=True, slots=True)
class Raw:
    """Times and fields of joints as a file has them.

    t : (n,), s. fields : field, joint, values (n,) in SI; nan where nothing was logged. told : the unit a field came
    in, where the file or somebody says it. rows : what a row is called. numbered : joints have no names of their own.
    notes : what the reader did.
    """

    t: FloatArray
    fields: Fields
    told: Mapping[str, str] = field(default_factory=dict)
    rows: str = "row"
    numbered: bool = False
    notes: tuple[str, ...] = ()

    def found(self) -> Found:
        """As a process of its own hands it on."""
        columns = {f"{kind} {joint}": values for kind, of in self.fields.items() for joint, values in of.items()}
        about = {"told": dict(self.told), "rows": self.rows, "numbered": self.numbered, "notes": list(self.notes)}
        return {"t": self.t, **columns}, about


def from_found(columns: Mapping[str, FloatArray], about: Mapping[str, Any]) -> Raw:
    """What ``Raw.found`` gave."""
    fields: Fields = {}
    for key, values in columns.items():
        kind, _, joint = key.partition(" ")
        if kind in CHANNEL:
            fields.setdefault(kind, {})[joint] = values
    return Raw(columns["t"], fields, **{**about, "notes": tuple(about["notes"])})


def one_of(where: str, asked: str, known: list[str], what: str) -> InputError:
    """The error for a name that is not among those there are."""
    listed = ", ".join(known[:12]) + (", ..." if len(known) > 12 else "")
    listed = f"one of {listed}" if len(known) > 1 else listed or "none"
    return InputError(where, f"no {what} '{asked}'", f"{listed}{did_you_mean(asked, known)}")
