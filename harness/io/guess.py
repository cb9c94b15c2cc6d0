"""Column names as people write them: which channel a name means, and the unit its ending gives."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from harness.io.columns import CHANNELS

ANGLES = frozenset({"angle", "theta", "phi"})
"""Names that say an angle; without a unit they are read in rad."""
_NAMES: dict[str, str] = {
    "t": "t time times stamp timestamp sec secs seconds elapsed",
    "x": "x q pos position displacement disp angle theta phi",
    "v": "v dq qd vel velocity speed omega theta_dot thetadot dtheta",
    "a": "a ddq qdd acc accel acceleration alpha theta_ddot",
    "u": "u f tau force torque effort",
}
_CHANNEL = {name: channel for channel, names in _NAMES.items() for name in names.split()}
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
_INDEX = re.compile(r"(\[\d{1,4}\]|\.\d{1,4}|_\d{1,4})$")
_PLAIN = re.compile(r"^[^\W\d][\w.]*(?: [\w.]+)*$")


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a column's name means: its channel, and the unit the name gives (None: it gives none)."""

    channel: str
    unit: str | None = None
    angle: bool = False


def meaning(name: str) -> Meaning | None:
    """The channel of a column ("Position 1", "/joint_states/position[0]", "x_rad"); None for any other name."""
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


def _ending(name: str, channel: str) -> str | None:
    """The unit that the ending of a name gives a channel ("x1_rad"), whatever else the name says."""
    stem = name.strip().lower()
    cuts = (i for i, letter in enumerate(stem) if letter == "_")
    return next((ENDINGS[channel][stem[i + 1 :]] for i in cuts if stem[i + 1 :] in ENDINGS[channel]), None)


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
    """A column as --columns takes it: its name, in quotes where it needs them, #N where it has none."""
    if not name:
        return f"#{position + 1}"
    return name if _PLAIN.match(name) else "'" + name + "'" if "'" not in name else f"#{position + 1}"


def ready(headers: Sequence[str], units: Mapping[int, str]) -> str:
    """A --columns to paste: what the names say, the first columns in turn where they say nothing."""
    found = candidates(headers)
    taken = {positions[0] for positions in found.values()}
    free = [i for i in range(len(headers)) if i not in taken]
    chosen = {channel: positions[0] for channel, positions in found.items()}
    if "t" not in chosen and free and len(headers) > 1:
        chosen["t"] = free.pop(0)
    if not {"x", "v", "a"} & set(chosen) and free:
        chosen["x"] = free.pop(0)
    shown = []
    for channel in (c for c in CHANNELS if c in chosen):
        position = chosen[channel]
        unsaid = channel == "x" and position not in units and meaning(headers[position]) is None
        unit = f"[{_ending(headers[position], channel) or 'm'}]" if unsaid else ""
        shown.append(f"{channel}={quoted(headers[position], position)}{unit}")
    return f'--columns "{",".join(shown)}"'
