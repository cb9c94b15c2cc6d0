"""Which columns of a table are which channels: as --columns says, else by their names.

What each column of a table may be, by its unit, its name and its numbers; and the --columns that follow from it.

Unit goes before name: rad/s is a speed whatever it is called. Numbers rule out: a time rises, and what stays, counts
or has no value is no channel. What was commanded is never taken for what was measured.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.io.columns import CHANNELS, ENDINGS, Mapping, candidates, is_commanded, meaning, parse_columns
from harness.io.options import UNSAID, RefusedError
from harness.io.table import Table
from harness.io.units import Unit, parse_unit

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


_MOST_CHOICES, _SHOWN = 6, 8
"""Choices of columns that are tried, and columns that are named at most."""


def chosen(table: Table, columns: str | None, rate: float | None) -> tuple[dict[str, Mapping], frozenset[str]]:
    """What to read for each channel, and the channels that were guessed from names that are not the channel's own.

    columns : the text of --columns. rate : Hz, that of --rate. Raises RefusedError where names leave it open.
    """
    guessed: frozenset[str] = frozenset()
    if columns is not None:
        mappings = parse_columns(columns)
        if "t" not in mappings and rate is None and "t" in table.names:
            mappings["t"] = Mapping("t", ("t",))
    else:
        mappings, guessed = _channels_named(table, rate)
    if not set(mappings) & {"x", "v", "a"}:
        hint = "columns named t and one or more of x, v, a, or a choice of them by --columns, is accepted"
        raise RefusedError(str(table.path), f"the columns {table.listed()}", hint, _others(table, rate))
    if "t" not in mappings and rate is None:
        hint = "a column t, or its sampling rate by --rate HZ, is accepted"
        others = _others(table, rate) if columns is None else ()
        raise RefusedError(str(table.path), f"no time among the columns {table.listed()}", hint, others)
    if "t" in mappings and rate is not None:
        accepted = "one of the two is accepted (--columns without t leaves the column out)"
        raise InputError("--rate", f"given although a column of {table.path} gives the time", accepted)
    return mappings, guessed


def _others(table: Table, rate: float | None) -> list[dict[str, Any]]:
    """Choices of columns to try, with a rate to be given where no column is a time."""
    found: list[dict[str, Any]] = [{"columns": text} for text in islice(choices(table, rate is None), _MOST_CHOICES)]
    if found or rate is not None:
        return found
    return [{"columns": text, "rate": UNSAID} for text in islice(choices(table, timed=False), _MOST_CHOICES)]


def _channels_named(table: Table, rate: float | None) -> tuple[dict[str, Mapping], frozenset[str]]:
    found = candidates(table.names)
    mappings, guessed = {}, set()
    for channel in (c for c in CHANNELS if c in found):
        positions = found[channel]
        if len(positions) > 1:
            named = ", ".join(table.headers[i] or f"#{i + 1}" for i in positions[:_SHOWN])
            named += ", ..." if len(positions) > _SHOWN else ""
            found_too = f"{len(positions)} columns that may be {channel}: {named}"
            raise RefusedError(str(table.path), found_too, "one of them by --columns is accepted", _others(table, rate))
        name = table.names[positions[0]]
        mappings[channel] = Mapping(channel, (f"#{positions[0] + 1}",))
        if name not in ((channel, "F") if channel == "u" else (channel,)):
            guessed.add(channel)
    return mappings, frozenset(guessed)


def unit_of(table: Table, mapping: Mapping, positions: list[int], constants: list[bool]) -> Unit:
    """The unit of a mapping: its own, else what the header of its one column says, in brackets or by its ending."""
    if mapping.unit is not None:
        return parse_unit(f"--columns, channel {mapping.channel}", mapping.channel, mapping.unit)
    moving = [i for i, constant in zip(positions, constants, strict=True) if not constant]
    if len(moving) != 1 or any(constants):
        return parse_unit("", mapping.channel, None)
    header = table.units.get(moving[0])
    means = meaning(table.names[moving[0]])
    if header is None and means is not None and means.channel == mapping.channel:
        header = means.unit or ("rad" if means.angle else None)
    where = f"{table.path}: column {'*'.join(table.names[i] or f'#{i + 1}' for i in positions)}"
    return parse_unit(where, mapping.channel, header)


def quoted_of(table: Table, mapping: Mapping, header: Unit | None = None) -> str:
    """A mapping's product as --columns takes it. header : its unit by the file, for a mapping that says none."""
    product = "*".join(table.quoted(table.position(name)) for name in mapping.names)
    factor = "" if mapping.factor == 1.0 else f"{mapping.factor:.9g}*"
    unit = mapping.unit if mapping.unit is not None or header is None or not header.text else header.text
    return factor + product + ("" if unit is None else f"[{unit}]")


def said(table: Table, mappings: dict[str, Mapping], units: dict[str, Unit], guessed: frozenset[str]) -> str | None:
    """What was guessed, in one sentence that ends with the --columns that says the same; None where nothing was."""
    if not guessed:
        return None
    parts, paste = [], []
    for channel in (c for c in CHANNELS if c in mappings):
        position = table.position(mappings[channel].names[0])
        unit = units[channel].text
        shown = unit or {"t": "s", "x": "m", "v": "m/s", "a": "m/s^2", "u": "N"}[channel]
        paste.append(f"{channel}={table.quoted(position)}[{shown}]")
        if channel in guessed:
            parts.append(f"{channel} from {table.headers[position]} in {shown}{'' if unit else ' (no unit given)'}")
    return f'Read {", ".join(parts)}; to say otherwise: --columns "{",".join(paste)}".'


def products(table: Table, mappings: dict[str, Mapping]) -> dict[str, tuple[FloatArray, Unit]]:
    """The values of every channel in SI, those of t as they stand, and the unit they came in; the file is read once.

    Raises InputError where columns of one product are of several lengths, or a unit is none.
    """
    at = {name: table.position(name) for mapping in mappings.values() for name in mapping.names}
    positions = sorted(set(at.values()))
    columns = dict(zip(positions, table.read(positions), strict=True))
    return {channel: _product(table, mapping, at, columns) for channel, mapping in mappings.items()}


def _product(
    table: Table, mapping: Mapping, at: dict[str, int], read: dict[int, FloatArray]
) -> tuple[FloatArray, Unit]:
    positions = [at[name] for name in mapping.names]
    columns = [read[i] for i in positions]
    constants = [column.size == 1 for column in columns]
    unit = unit_of(table, mapping, positions, constants)
    factor = mapping.factor * (1.0 if mapping.channel == "t" else unit.factor)
    values = columns[0]
    with np.errstate(over="ignore", invalid="ignore"):  # what becomes of it is looked at when the rows are checked
        for column in columns[1:]:
            if column.size not in (1, values.size) and values.size != 1:
                found = f"columns of {values.size} and {column.size} values"
                where = f"{table.path}: channel {mapping.channel}"
                raise InputError(where, found, "columns of one length are accepted")
            values = values * column
        return (values if factor == 1.0 else values * factor), unit
