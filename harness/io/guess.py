"""Column names as people write them: which channel a name means, and the unit its ending gives."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

ANGLES = frozenset({"angle", "theta", "phi"})
"""Names that say an angle; without a unit they are read in rad."""
_NAMES: dict[str, str] = {
    "t": "t time times stamp timestamp sec secs seconds elapsed",
    "x": "x q qpos pos position displacement disp angle theta phi",
    "v": "v dq qd qvel vel velocity speed omega theta_dot thetadot dtheta",
    "a": "a ddq qdd qacc acc accel acceleration alpha theta_ddot",
    "u": "u f tau force torque effort",
}
_CHANNEL = {name: channel for channel, names in _NAMES.items() for name in names.split()}
COMMANDED = frozenset(
    {"cmd", "xcmd", "command", "commanded", "target", "goal", "desired", "des", "ref", "reference", "setpoint"}
    | {"error", "err", "action"}
)
"""Words of a name by which it is not what was measured."""
_CLOCKS = {"millis": "ms", "micros": "us", "msec": "ms", "usec": "us", "nsec": "ns"}
"""Names of a time that say its unit."""
ENDINGS: dict[str, dict[str, str]] = {
    "t": {"s": "s", "sec": "s", "ms": "ms", "us": "us", "ns": "ns"},
    "x": {"m": "m", "mm": "mm", "cm": "cm", "um": "um", "rad": "rad", "deg": "deg", "mrad": "mrad"},
    "v": {"m_s": "m/s", "mm_s": "mm/s", "cm_s": "cm/s", "rad_s": "rad/s", "deg_s": "deg/s", "rpm": "rpm", "mps": "m/s"},
    "a": {"m_s2": "m/s^2", "mm_s2": "mm/s^2", "rad_s2": "rad/s^2", "deg_s2": "deg/s^2", "g": "g", "mg": "mg"},
    "u": {"n": "N", "mn": "mN", "kn": "kN", "nm": "N*m", "n_m": "N*m", "mnm": "mN*m", "lbf": "lbf"},
}
"""Units that the ending of a name gives, by channel."""
_SHELLS = frozenset("'\"$`\\!")
"""Signs that would not come through quotes as they are."""
_INDEX = re.compile(r"(\[\d{1,4}\]|\.\d{1,4}|_\d{1,4})$")
_PLAIN = re.compile(r"^[^\W\d][\w.]*(?: [\w.]+)*$")


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a column's name means: its channel, and the unit the name gives (None: it gives none)."""

    channel: str
    unit: str | None = None
    angle: bool = False


def is_commanded(name: str) -> bool:
    """Whether a name says what was asked for, and not what was measured ("goal.position", "xcmd1_rad")."""
    return bool(COMMANDED & set(re.split(r"[^a-z]+", name.lower())))


def meaning(name: str) -> Meaning | None:
    """The channel of a column ("Position 1", "/joint_states/position[0]", "x_rad"); None for any other name."""
    if is_commanded(name):
        return None
    last = re.split(r"[/.](?=[^\d])", name.strip())[-1]
    stem = re.sub(r"[\s-]+", "_", _INDEX.sub("", last.strip().lower()).strip()).strip("_")
    stem = _INDEX.sub("", stem)
    if stem in _CLOCKS:
        return Meaning("t", _CLOCKS[stem])
    if stem in _CHANNEL:
        return Meaning(_CHANNEL[stem], None, stem in ANGLES)
    for cut in (i for i, letter in enumerate(stem) if letter == "_"):
        front, ending = _INDEX.sub("", stem[:cut]), stem[cut + 1 :]
        channel = _CHANNEL.get(front)
        if channel is not None and ending in ENDINGS[channel]:
            return Meaning(channel, ENDINGS[channel][ending], front in ANGLES)
    return None


def candidates(names: Sequence[str]) -> dict[str, list[int]]:
    """Positions of the columns that may be each channel, by name; one that has the channel's own stands alone."""
    found: dict[str, list[int]] = {}
    for i, name in enumerate(names):
        means = meaning(name)
        if means is not None:
            found.setdefault(means.channel, []).append(i)
    for channel, positions in found.items():
        own = [i for i in positions if names[i] == channel or (channel == "u" and names[i] == "F")]
        found[channel] = own[:1] or positions
    return found


def quoted(name: str, position: int) -> str:
    """A column as --columns takes it between double quotes of a shell: its name, in quotes where it needs them, #N
    where it has none or holds what a shell reads.
    """
    if _PLAIN.match(name):
        return name
    return f"'{name}'" if name and not _SHELLS & set(name) else f"#{position + 1}"
