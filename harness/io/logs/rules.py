"""How columns of a robot's log are named: the words, and the shapes of names that hold them."""

import re
from dataclasses import dataclass
from typing import Literal

from harness.io.guess import ENDINGS, is_commanded

Field = Literal["position", "velocity", "effort", "current", "magnitude"]
CHANNEL: dict[Field, str] = {"position": "x", "velocity": "v", "effort": "u", "current": "i", "magnitude": "u"}
"""What is logged of a joint, and the channel whose units it has; a magnitude is an effort without its sign."""
SI_UNITS: dict[Field, str] = {
    "position": "rad",
    "velocity": "rad/s",
    "effort": "N m",
    "current": "A",
    "magnitude": "N m",
}
"""What is assumed where nothing says a unit (a slide: m, m/s, N)."""
WORDS: dict[Field, tuple[str, ...]] = {
    "position": ("position", "positions", "pos", "q", "qpos", "angle", "x", "theta"),
    "velocity": ("velocity", "velocities", "vel", "dq", "qd", "qvel", "speed", "v", "omega"),
    "effort": ("effort", "efforts", "torque", "torques", "tau", "tau_j", "u"),
    "current": ("current", "currents", "cur"),
    "magnitude": ("absu", "abstau", "abseffort", "abstorque"),
}
"""Words for each; where a file has several of them, the first is taken."""
SHORT = frozenset({"x", "v", "u"})
"""Words that say nothing behind the name of something (base.x)."""
TOPICS = frozenset({"joint_states", "joint_state", "field", "observation", "robot", "state"})
"""Names before a field that are no joint's."""

FIELD_OF: dict[str, Field] = {word: field for field, words in WORDS.items() for word in words}
_ENDINGS = {**ENDINGS, "i": {"a": "A", "ma": "mA"}}


def _any(words: "frozenset[str] | set[str]") -> str:
    return "|".join(sorted(words, key=lambda word: (-len(word), word)))


_WORD = f"(?P<word>{_any(set(FIELD_OF))})"
_LONG = f"(?P<word>{_any(set(FIELD_OF) - SHORT)})"
_UNIT = f"(?:_(?P<unit>{_any({ending for found in _ENDINGS.values() for ending in found})}))?"
_ACTUAL = "(?:actual_|measured_|meas_)?"
_ACTUAL_AFTER = "(?:_(?:actual|act|measured|meas|fb))?"

RULES: tuple[tuple[str, re.Pattern[str]], ...] = tuple(
    (said, re.compile(pattern, re.IGNORECASE))
    for said, pattern in (
        # position[0], /joint_states/effort[12], field.position0, actual_qd_0, x1_rad, tau1, q.7, pos_meas1
        ("numbered", rf"^(?:.*[./])?{_ACTUAL}{_WORD}{_ACTUAL_AFTER}[\[_.]?(?P<number>\d{{1,3}})\]?{_UNIT}$"),
        # elbow.position, elbow/velocity, /joint_states/elbow/effort, elbow.pos
        ("named", rf"^(?P<joint>\S.*?)[./]{_LONG}{_UNIT}$"),
        # q, dq, tau, x_rad: a log of one joint
        ("single", rf"^(?:(?:.*[./])?(?:{_any(TOPICS)})[./])?{_ACTUAL}{_WORD}{_ACTUAL_AFTER}{_UNIT}$"),
        # elbow_pos, joint1_torque_Nm
        ("named", rf"^(?P<joint>\S.*?)[_ -]{_LONG}{_UNIT}$"),
    )
)
"""Shapes of names, the first that fits is taken. numbered: joints in the model's order, from 0 or from 1."""


@dataclass(frozen=True, slots=True)
class Named:
    """What a column's name says: how it says it, the field, the word for it, whose, and the unit it ends with."""

    style: str
    field: Field
    word: str
    joint: str = ""
    number: int = 0
    unit: str | None = None


def named(name: str) -> Named | None:
    """What the name of a column says of a joint ("elbow.position", "actual_qd_0", "u1_Nm"); None for any other."""
    text = name.strip()
    if is_commanded(text):
        return None
    for style, pattern in RULES:
        found = pattern.match(text)
        if found is None:
            continue
        parts = found.groupdict()
        word, ending = parts["word"].lower(), (parts["unit"] or "").lower()
        units = _ENDINGS[CHANNEL[FIELD_OF[word]]]
        joint = (parts.get("joint") or "").rstrip("/").rpartition("/")[2]
        if (ending and ending not in units) or (style == "named" and joint.lower() in {"", *TOPICS}):
            continue
        return Named(style, FIELD_OF[word], word, joint, int(parts.get("number") or 0), units.get(ending))
    return None
