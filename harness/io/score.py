"""What each column of a table may be, by its unit, its name and its numbers; and the --columns that follow from it.

Unit goes before name: rad/s is a speed whatever it is called. Numbers rule out: a time rises, and what stays, counts
or has no value is no channel. What was commanded is never taken for what was measured.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.io.columns import CHANNELS
from harness.io.guess import is_commanded, meaning
from harness.io.table import Table
from harness.io.units import parse_unit

_MOST_COLUMNS = 64
"""Columns that are looked at."""
_RISES = 0.99
"""Share of its steps by which a time goes on: a clock may be set back once."""
_HALF = 0.5
"""Share of values that a channel has at least; of the largest spread, that tells a moving axis from one at rest."""
_DERIVATIVE, _GAIN = 0.9, 0.05
"""Correlation with another's slope from which a column is its speed, and by how much it may differ from it."""
_STEP_S = (1e-4, 2.0)
"""Between samples, s, of a time that is written in whole numbers of an unknown unit."""
_SCALES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_WORDS = {
    "x": {"position", "displacement", "angle", "winkel", "deflection", "distance", "theta", "height"},
    "v": {"velocity", "speed", "gyroscope", "gyro", "omega", "geschwindigkeit"},
    "a": {"acceleration", "accelerometer", "accel", "beschleunigung"},
    "u": {"force", "torque", "kraft"},
    "t": {"time", "zeit", "timestamp"},
}
"""Words that say a channel within a longer name."""
_COUNTS = {"row", "index", "idx", "sample", "frame", "count", "id", "nr", "no", "cycle", "step", "line"}
"""Words of a column that counts rows."""
_NO_SIGN = re.compile(r"^abs|absolute|magnitude|norm", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Column:
    """A column that can be a channel.

    position : from 0. said : as --columns takes it. channel : the one that unit or name says, "" where neither does.
    unit : the text that must be given beside it. group : numbers in its name, which a run or a joint shares. rises :
    whether it can be a time. values (n,) : as they stand.
    """

    position: int
    said: str
    channel: str
    unit: str
    group: tuple[str, ...]
    rises: bool
    values: FloatArray = field(repr=False)

    @property
    def spread(self) -> float:
        """Standard deviation of its values."""
        return float(np.nanstd(self.values))

    def as_channel(self, channel: str) -> str:
        """One entry of --columns."""
        return f"{channel}={self.said}{self.unit}"


def choices(table: Table, timed: bool = True) -> Iterator[str]:
    """Texts of --columns that may be meant, the likeliest first. timed : whether a column must give the time."""
    columns = _columns(table)
    times = [one for one in columns if one.channel == "t" and one.rises]
    times = times or [one for one in columns if not one.channel and one.rises][:1]
    if timed and not times:
        return
    moving = [one for one in columns if one not in times and one.channel != "t"]
    for leading in _leading(moving, len(times) > 1):
        channel = leading.channel or "x"
        t = next((one for one in times if one.group == leading.group), times[0]) if timed else None
        beside = {channel: leading}
        for one in moving:
            if one.channel in CHANNELS and one.channel not in beside and one.group == leading.group:
                beside[one.channel] = one
        if not leading.channel and t is not None:
            speed = next((one for one in moving if not one.channel and _is_speed(t, leading, one)), None)
            beside |= {} if speed is None else {"v": speed}
        clock = [] if t is None else [t.as_channel("t")]
        whole = ",".join([*clock, *(beside[c].as_channel(c) for c in CHANNELS if c in beside)])
        yield whole
        alone = ",".join([*clock, leading.as_channel(channel)])
        if alone != whole:
            yield alone


def _leading(moving: list[Column], runs: bool) -> Iterator[Column]:
    """Columns of the motion to begin with: position before speed before acceleration, then what says nothing.

    runs : whether there are several, each with its own time, so that the first one is meant; else the first that moves.
    """
    for channel in ("x", "v", "a", ""):
        those = [one for one in moving if one.channel == channel]
        most = max((one.spread for one in those), default=0.0)
        yield from sorted(those, key=lambda one: bool(channel) and not runs and one.spread < _HALF * most)


def _columns(table: Table) -> list[Column]:
    found = []
    for i in range(min(len(table.names), _MOST_COLUMNS)):
        header = table.headers[i]
        if is_commanded(header) or _NO_SIGN.search(header):
            continue
        try:
            values = table.read([i])[0]
        except InputError:
            continue
        channel, unit = _by_name(table, i)
        told = values[np.isfinite(values)]
        if told.size < max(_HALF * values.size, 2) or np.all(told == told[0]) or channel == "other":
            continue
        steps = np.diff(told)
        rises = float(np.mean(steps > 0.0)) >= _RISES or (channel == "t" and float(np.mean(steps >= 0.0)) >= _RISES)
        if _counts(header, told, steps):
            continue
        if channel in ("", "t") and rises and not unit and i not in table.units:
            unit = _clock_unit(table, i, told, steps)
        found.append(
            Column(i, table.quoted(i), channel, unit, tuple(re.findall(r"\d+", table.names[i])), rises, values)
        )
    return found


def _by_name(table: Table, i: int) -> tuple[str, str]:
    """The channel of a column and the unit to give beside it; "other" for what is none, "" where nothing is said."""
    name, unit = table.names[i], table.units.get(i)
    means = meaning(name)
    words = set(re.split(r"[^a-z]+", name.lower()))
    named = means.channel if means is not None else next((c for c, those in _WORDS.items() if words & those), "")
    if unit is not None:
        fits = [c for c in CHANNELS if _is_unit_of(c, unit)]
        return (named if named in fits else fits[0] if fits else "other"), ""
    ending = next((u for c, u in _endings(name) if not named or c == named), None) if means is None else None
    if ending is not None:
        return next(c for c, u in _endings(name) if u == ending and (not named or c == named)), f"[{ending}]"
    return named, ""


def _endings(name: str) -> list[tuple[str, str]]:
    """Channels and units that the ending of a name gives ("x1_rad", "knee_deg_s")."""
    from harness.io.guess import ENDINGS

    stem = name.strip().lower()
    tails = [stem[i + 1 :] for i, letter in enumerate(stem) if letter == "_"]
    return [(c, ENDINGS[c][tail]) for tail in tails for c in CHANNELS if tail in ENDINGS[c] and len(tail) > 1]


def _is_unit_of(channel: str, unit: str) -> bool:
    try:
        parse_unit("", channel, unit)
    except InputError:
        return False
    return True


def _counts(header: str, told: FloatArray, steps: FloatArray) -> bool:
    """Whether a column numbers its rows."""
    whole = bool(np.all(told == np.round(told)))
    named = bool(_COUNTS & set(re.split(r"[^a-z]+", header.lower())))
    return whole and (bool(np.all((steps == 0.0) | (steps == 1.0))) or (named and bool(np.all(steps >= 0.0))))


def _clock_unit(table: Table, i: int, told: FloatArray, steps: FloatArray) -> str:
    """The unit of a time in whole numbers whose name gives none: the largest that makes it no slow clock."""
    means = meaning(table.names[i])
    if (means is not None and means.unit) or not np.all(told == np.round(told)):
        return ""
    step = float(np.median(steps))
    fits = [unit for unit, scale in _SCALES.items() if _STEP_S[0] <= step * scale <= _STEP_S[1] and step > 1.0]
    return f"[{fits[0]}]" if fits and fits[0] != "s" else ""


def _is_speed(t: Column, x: Column, other: Column) -> bool:
    """Whether a column is the slope of another over time, factor and all."""
    if other is x or other is t:
        return False
    scale = _SCALES.get(t.unit.strip("[]"), 1.0)
    with np.errstate(all="ignore"):
        slope = np.gradient(x.values, t.values * scale)
    both = np.isfinite(slope) & np.isfinite(other.values)
    if np.count_nonzero(both) < 2:
        return False
    s, y = slope[both], other.values[both]
    power = float(s @ s)
    gain = float(s @ y) / power if power > 0.0 else 0.0
    return abs(gain - 1.0) < _GAIN and float(np.corrcoef(s, y)[0, 1]) > _DERIVATIVE
