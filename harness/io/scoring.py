"""What each column of a table may be, by its unit, its name and its numbers; the readings that follow, the best first.

Unit goes before name: rad/s is a speed whatever it is called. Numbers rule out: a time rises, and what stays, counts
or has no value is no channel; and a column that follows the slope of another is its speed. What was commanded is never
taken for what was measured. Columns that share a mark (``Run 1:``, ``#2``, a number) belong together; where each mark
has a time of its own, each is a run.
"""

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.io.columns import (
    CHANNELS,
    is_angle,
    is_commanded,
    is_electrical,
    is_magnitude,
    is_no_motion,
    is_of_a_turn,
    is_period,
    is_rate,
    is_torque,
    marked,
    meaning,
    unit_ending,
    word_of,
)
from harness.io.table import Table
from harness.io.times import SCALES, clock_unit, unrolled
from harness.io.units import RAW, STEPS, is_unit_of, of_a_turn, parse_unit

_MOST_COLUMNS, _MOST_SAMPLES, _MOST_SPEEDS = 64, 20_000, 16
"""Columns that are looked at; of these, samples and columns at which slopes are compared."""
_MOST_CELLS, _FEWEST = 50_000_000, 5
"""Numbers that are looked at, 400 MB, and columns however long they are."""
_RISES = 0.99
"""Share of its steps by which a time goes on: a clock may be set back once."""
_BARE = 2
"""Columns of which nothing is known beside those that are read."""
_HALF = 0.5
"""Share of values that a channel has at least, within its run."""
_MARGIN = 2.0
"""Times the spread of the next one that a column must move to be taken for the one meant: an axis beside the one of the
motion shows less than half of it up to 26 degrees between them."""
_FOLLOWS, _GAIN = 0.9, 0.05
"""Correlation with another's slope from which a column is its speed, and by how much it may differ from it."""
TURNING = {"x": "rad", "v": "rad/s"}
"""Units of what turns, where nothing says one."""
_SI = {"x": "m", "v": "m/s", "a": "m/s^2", "u": "N"}
_PARTS, _FALLS, _LEFT, _ROUGH = 20, 0.02, 0.25, 0.1
"""Parts of a column whose means fall, but for so much of its largest value, to so much of it at the end, with so little
scatter about them, where it is a speed that runs down: no swing does so."""
_ENDS = 5
"""Parts of a column of which the first is the largest, where it may be such a speed at all."""
_MG = 700, 1300
"""Whole numbers that all lie so far from 0 may be mg of an accelerometer that feels its weight: asked, never taken."""
_LONG_TURN = 1e4
"""ms of a turn, 6 rpm, that nobody waits for."""
_TURN, _CIRCLE, _SIDE = 2.0 * np.pi, 360.0, 0.05
_GYRO = 35.0
"""rad/s, 2000 deg/s: more than gyroscopes show; larger numbers of one are deg/s."""
_OF_SOUND, _OF_ROADS = 340.0, 60.0
"""m/s that nothing on rails, wheels or springs reaches, and no car that is let roll, 216 km/h."""
_BENCH, _OF_SWINGS = 200.0, 20.0
"""m that nothing on a bench goes, and m/s that nothing on a spring reaches: it would swing 3 m at 1 Hz."""
_STRIDES = 200
"""Parts of a position between whose means it is seen how fast it goes: noise of single samples is none."""
GYRO_COUNTS = 4000.0
"""deg/s that none shows: its own counts."""
_SCALED, _NUMBERS, _NAME, _UNIT = range(-1, 3)
"""By what a column's channel is told, the strongest last; a voltage or a count needs its scale first."""
_COUNTS = {"row", "index", "idx", "sample", "frame", "count", "id", "nr", "no", "cycle", "step", "line", "iteration"}
"""Words of a column that counts rows."""
_IN_VOLTS = re.compile(r"volt|spannung|percent|prozent|duty|pwm|(?<![a-z])(?:ecg|eeg|emg)(?![a-z])")
"""Words of what is no motion before somebody says its scale."""
CONVERTER = re.compile(r"(?<![a-z])(?:counts?|cts|ticks?|raw|adc|lsb|pulses?|pixels?|px)(?![a-z])", re.IGNORECASE)
"""In the name of a column whose numbers are no lengths yet."""
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])")
_ENCODER = re.compile(r"(?<![a-z])enc(?:oder)?s?(?![a-z])")
"""In the name of what turns, where nothing says that it is a length."""
TURN_OF_4096 = 0.00153398
"""rad of a step where 4096 are a turn, as most sensors of an angle have."""
_NO_SIGN = re.compile(r"absolute|magnitude|norm|\bsigma|\bstd|uncertainty", re.IGNORECASE)


@dataclass(frozen=True, slots=True, eq=False)
class Column:
    """A column that can be a channel.

    position : from 0. said : as --columns takes it, name : without its mark and unit. channel : the one that unit, name
    or numbers say, "" where nothing does; told : by which of them. unit : its text, "" where nothing says one; given :
    whether that must stand beside it. mark : what a run or a joint shares. rises : whether it can be a time.
    values (n,) : as they stand.
    """

    position: int
    said: str
    name: str
    channel: str
    told: int
    unit: str
    given: bool
    mark: tuple[str, ...]
    rises: bool
    values: FloatArray = field(repr=False)

    @property
    def spread(self) -> float:
        """Standard deviation of its values."""
        return float(np.nanstd(self.values))

    @property
    def finer(self) -> int:
        """How many different values it has: of a stamp in two columns, whole seconds have few."""
        return int(np.unique(self.values).size)

    @property
    def angular(self) -> bool | None:
        """Whether its unit is one of an angle; None where none is told."""
        return parse_unit("", self.channel, self.unit).angular if self.unit and self.channel in CHANNELS else None

    @property
    def axis(self) -> str:
        """The letter at the end of its name, of x, y and z."""
        found = re.search(r"(?:^|[\W_])([xyz])\W*$", self.name.lower())
        return found[1] if found else ""

    def as_channel(self, channel: str) -> str:
        """One entry of --columns."""
        return f"{channel}={self.said}" + (f"[{self.unit}]" if self.given and self.unit else "")


@dataclass(frozen=True, slots=True)
class Reading:
    """One way to read a table. columns : the text of --columns. clear : whether no other is nearly as good."""

    columns: str
    clear: bool


def runs_of(table: Table, timed: bool = True) -> list[list[Reading]]:
    """The runs of a table, each with its readings, the likeliest first; one where there are none side by side.

    timed : whether a column must give the time; there is no run where none can.
    """
    columns = _with_turning(_without_noise(_with_gravity(_without_norms(list(_columns(table))))))
    periods = [one for one in columns if one.channel == "period"]
    columns = [one for one in columns if one.channel != "period"]
    unknown = [one for one in columns if not one.channel and not one.rises]
    if len(unknown) == 1 and (of_file := word_of(table.path.stem)):  # a signal in a file of its name
        columns = [replace(one, channel=of_file, told=_NAME) if one is unknown[0] else one for one in columns]
    if any(one.name.strip() == "x" for one in columns):  # then what is called y is another axis of it
        axes = [one.name.strip() in ("y", "z") and not one.channel for one in columns]
        columns = [replace(one, channel="x", told=_NAME) if y else one for one, y in zip(columns, axes, strict=True)]
    times = [one for one in columns if one.channel == "t" and one.rises]
    times = times or sorted((one for one in columns if not one.channel and one.rises), key=_unevenness)[:1]
    moving = [one for one in columns if one not in times and one.channel != "t"]
    if len(times) == 1:
        moving = _in_their_unit(moving, times[0])
    if not timed:
        return [list(_readings([one for one in map(_perhaps_falling, columns) if one.channel != "t"], None))]
    clocks = {one.mark: one for one in sorted(times, key=lambda one: one.told)}
    own = [mark for mark in dict.fromkeys(one.mark for one in times) if any(one.mark == mark for one in moving)]
    if len(own) < max(len(clocks), 2):
        t = max(times, key=lambda one: (one.told, one.finer)) if times else None
        counted = all(one.channel == "count" for one in moving)
        if len(periods) == 1 and counted and (t is None or _parts(t, periods[0])):
            return [[Reading(f"{periods[0].as_channel('t')},x=#0[rev]", periods[0].told == _UNIT)]]
        alone = len(table.headers) == 1 + len(moving) and counted
        return [list(_readings(moving, t)) or (list(_events(moving, t)) if alone else [])] if t else []
    return [list(_readings([one for one in moving if one.mark == mark], clocks[mark])) for mark in own]


def _unevenness(one: Column) -> float:
    steps = np.diff(one.values[np.isfinite(one.values)])
    return round(float(np.std(steps) / np.mean(steps)), 2) if np.mean(steps) > 0.0 else np.inf


def _readings(columns: Sequence[Column], t: Column | None) -> Iterator[Reading]:
    columns = [one for one in columns if t is None or one.values.size == t.values.size]
    moving = [one for one in (columns if t is None else _with_speeds(columns, t)) if one.channel != "count"]
    clock = [] if t is None else [t.as_channel("t")]
    for leading, clear in _leading(moving):
        channel = leading.channel or "x"
        beside = {channel: leading}
        for other in CHANNELS[1:]:
            found = None if other in beside else _beside(leading, other, moving, t)
            beside |= {} if found is None else {other: found}
        whole = ",".join([*clock, *(beside[c].as_channel(c) for c in CHANNELS if c in beside)])
        yield Reading(whole, clear)
        alone = ",".join([*clock, leading.as_channel(channel)])
        if alone != whole:
            yield Reading(alone, False)


def _events(counts: Sequence[Column], t: Column) -> Iterator[Reading]:
    """Where times stand alone, or beside what counts them: one for each turn."""
    yield Reading(",".join([t.as_channel("t"), f"x={counts[0].said if counts else '#0'}[rev]"]), False)


def _parts(t: Column, period: Column) -> bool:
    """Whether periods are what lies between times."""
    if t.values.size != period.values.size:
        return False
    steps = np.diff(t.values) * parse_unit("", "t", t.unit or "s").factor
    lasted = period.values[1:] * parse_unit("", "t", period.unit).factor
    return bool(np.allclose(steps, lasted, rtol=_GAIN, equal_nan=True))


def _leading(moving: Sequence[Column]) -> Iterator[tuple[Column, bool]]:
    """Columns of the motion to begin with, and whether each is the one that is meant.

    Position goes before speed before acceleration before what says nothing; among those of one channel what is told
    better, then what moves more.
    """
    # of columns without names, a speed belongs to the position, an acceleration and a force may
    bare = [one.channel for one in moving if one.told == _NUMBERS]
    least = _NUMBERS if bare.count("v") > 1 or bare.count("") > _BARE else _SCALED
    none = True
    for channel in ("x", "v", "a", ""):
        those = sorted((one for one in moving if one.channel == channel), key=lambda one: (-one.told, -one.spread))
        most = those[0] if those else None
        if not channel or len({one.unit for one in those}) > 1:  # nothing says that they are of one kind
            those.sort(key=lambda one: (-one.told, one.position))
        others = [one for one in those if one is not most and most and one.told == most.told]
        alike = [
            one
            for one in others
            if most
            and (most.spread <= _MARGIN * one.spread or one.unit != most.unit or not channel or one.told == _NUMBERS)
        ]
        for one in those:
            yield one, none and not alike and one is most and one.told > least
        none = none and (not those or (channel == "x" and those[0].told == _SCALED))  # a speed needs no scale


def _beside(leading: Column, channel: str, moving: Sequence[Column], t: Column | None) -> Column | None:
    """The column of another channel that belongs to a motion, of its mark and its kind of unit; None where several may.

    A speed without a unit that is the slope as the numbers stand has the unit of the position.
    """
    those = [one for one in moving if one.channel == channel and one.told > _SCALED]
    if len(those) > 1 or sum(one.channel == leading.channel for one in moving) > 1:  # else digits are a sensor's own
        those = [one for one in those if one.mark == leading.mark]
    if channel != "u":
        those = [one for one in those if None in (one.angular, leading.angular) or one.angular == leading.angular]
    if len(those) > 1 and leading.axis:
        those = [one for one in those if one.axis == leading.axis]
    if channel == "v" and t is not None:
        slopes = [one for one in those if _follows(t, leading, one)]
        those = [one for one in slopes if one.told == max(other.told for other in slopes)] or those
        if (
            len(those) == 1
            and leading.unit
            and (not those[0].unit or those[0].told < _UNIT)
            and _follows(t, leading, those[0], _GAIN)
        ):
            return replace(those[0], unit=f"{leading.unit}/s", given=True)
    return those[0] if len(those) == 1 else None


def _with_speeds(columns: Sequence[Column], t: Column) -> list[Column]:
    """The columns; one of an unknown channel that is the slope of another, or follows that of a count, is a speed."""
    found = list(columns)
    unknown = [i for i, one in enumerate(found) if not one.channel][:_MOST_SPEEDS]
    bases = [i for i, one in enumerate(found) if one.channel in ("", "x", "count")][:_MOST_SPEEDS]
    for j in bases:
        base = found[j]
        for i in unknown:
            gain = None if base.channel == "count" else _GAIN
            if (
                i != j
                and not found[i].channel
                and base.channel in ("", "x", "count")
                and _follows(t, base, found[i], gain)
            ):
                found[i] = replace(found[i], channel="v")
                found[j] = base if base.channel else replace(base, channel="x")
    return found


def _follows(t: Column, x: Column, other: Column, gain: float | None = None) -> bool:
    """Whether a column follows the slope of another over time; with ``gain``, whether it is that but for so much."""
    some = slice(None, _MOST_SAMPLES)
    with np.errstate(all="ignore"):
        slope = np.gradient(x.values[some], t.values[some] * SCALES.get(t.unit, 1.0))
    both = np.isfinite(slope) & np.isfinite(other.values[some])
    s, y = slope[both], other.values[some][both]
    power = float(s @ s)
    if s.size < 2 or power == 0.0 or np.ptp(y) == 0.0 or np.ptp(s) == 0.0:
        return False
    near = gain is None or abs(float(s @ y) / power - 1.0) < gain
    return near and float(np.corrcoef(s, y)[0, 1]) > _FOLLOWS


def _columns(table: Table) -> Iterator[Column]:
    some = [
        i
        for i, header in enumerate(table.headers[:_MOST_COLUMNS])
        if not (is_commanded(header) or is_magnitude(header) or _NO_SIGN.search(header))
    ]
    with suppress(InputError, IndexError):  # one of text, which is read, and left out, below
        some = some[: max(_MOST_CELLS // max(table.columns(some[:1])[0].size, 1), _FEWEST)]
        table.columns(some)
    for i in some:
        header = table.headers[i]
        try:
            values = table.columns([i])[0]
            values = np.where(np.isinf(values), np.nan, values)
        except InputError:
            continue
        known = np.flatnonzero(np.isfinite(values))
        told = values[known]
        if told.size < max(_HALF * (known[-1] + 1 if known.size else 0), 2) or np.all(told == told[0]):
            continue
        mark, name = marked(table.names[i])
        if again := table.names[:i].count(table.names[i]):  # of columns that repeat, a later run
            mark = (*mark, str(again + 1))
        channel, by, unit, said = _named(table, i, name, told)
        steps = np.diff(told)
        measured = channel in CHANNELS and by == _UNIT
        if channel != "t" and not measured and i not in table.dated and _is_count(header, told, steps):
            channel = "count"
        onward = float(np.mean(np.diff(unrolled(told)) >= 0.0 if channel == "t" else steps > 0.0))
        rises = onward >= _RISES
        if channel == "period":
            unit = unit if of_a_turn(unit) else f"{unit or _unit_of_periods(told)}/rev"
        if channel in ("", "t") and rises and not unit and i not in table.dated:
            unit = clock_unit(told)
        if channel == "x" and not unit and i not in table.units and is_angle(name):
            unit = "deg" if _in_degrees(told) else "rad"
        if not channel and _runs_down(told):  # under a name that says nothing it is asked
            channel, by = "v", _SCALED if header else _NUMBERS
        if channel == "v" and not unit and (other := likelier_unit(channel, name, told)):
            by, unit = _SCALED, other
        if not header and np.all(told == np.round(told)) and _MG[0] < np.abs(told).min() <= np.abs(told).max() < _MG[1]:
            channel, by, unit = "a", _SCALED, "mg"
        if channel != "other":
            given = unit != table.units.get(i)
            yield Column(i, said, name, channel, by, unit, given, mark, rises, values)


def _named(table: Table, position: int, name: str, told: FloatArray) -> tuple[str, int, str, str]:
    """As ``_by_name``, and the column as --columns takes it; steps (n,) of what turns are asked for in rad."""
    channel, by, unit = _by_name(name, table.units.get(position))
    said = table.quoted(position)
    if channel in ("", "x") and _counts_turns(name, table.units.get(position, unit), told):
        return "x", _SCALED, "rad", f"{TURN_OF_4096}*{said}"
    return channel, by, unit, said


def _counts_turns(name: str, unit: str, told: FloatArray) -> bool:
    """Whether values (n,) are an angle, or of an encoder, in steps that a sensor counts."""
    encoder = bool(_ENCODER.search(_CAMEL.sub(" ", name).lower())) and bool(np.all(told == np.round(told)))
    counts = STEPS.match(unit) if unit else encoder or CONVERTER.search(name.replace("_", " "))
    return bool(counts) and (encoder or is_angle(name))


def likelier_unit(channel: str, name: str, values: FloatArray, t: FloatArray | None = None) -> str:
    """In what values (n,) of a place or speed whose unit nothing says are likelier than in m or m/s, by how fast and
    how far it goes; "" where they may be in that.

    t : s, (n,), where it is known. A car goes further than a bench is long, and its log is in km/h.
    """
    if name in ("x", "v") or (t is not None and t.size != values.size):
        return ""
    known = np.isfinite(values) & (np.isfinite(t) if t is not None else True)
    values, t = values[known], None if t is None else t[known]
    if values.size < 2:
        return ""
    if channel == "v" and not is_rate(name):
        most = float(np.max(np.abs(values)))
        far = 0.0 if t is None else abs(float(np.trapezoid(values, t)))
        on_a_road = far > _BENCH or (most > _OF_ROADS and (t is not None or not name))
        return "rpm" if most > _OF_SOUND else "km/h" if on_a_road else ""
    length = channel == "x" and t is not None and not (is_angle(name) or CONVERTER.search(name.replace("_", " ")))
    return "mm" if length and t is not None and _fastest(t, values) > _OF_SWINGS else ""


def _in_their_unit(columns: Sequence[Column], clock: Column) -> list[Column]:
    """The columns; where one without a unit goes too fast or too far for m/s or m, those of its kind are in another,
    which is asked, and so is what says nothing beside it.
    """
    t = unrolled(clock.values) * SCALES.get(clock.unit, 1.0)
    bare = [one for one in columns if not one.unit and one.told == _NAME]
    of_motion = [one for one in columns if one.channel in ("x", "v", "a", "count") or not one.channel]
    if len(of_motion) == 1 and of_motion[0].name and not of_motion[0].channel:  # what moves is the position
        bare = [*bare, replace(of_motion[0], channel="x")]
    units = {one.channel: unit for one in bare if (unit := likelier_unit(one.channel, one.name, one.values, t))}
    kinds = {channel: (channel, "") if channel == "x" else (channel,) for channel in units}
    found = list(columns)
    for channel, unit in units.items():
        found = [
            replace(one, channel=channel, told=_SCALED, unit=unit, given=True)
            if one.channel in kinds[channel] and not one.unit and not is_angle(one.name)
            else one
            for one in found
        ]
    return found


def _fastest(t: FloatArray, x: FloatArray) -> float:
    """How fast a position x (n,) goes at times t (n,), from the means of parts that follow one another."""
    parts = np.array_split(np.arange(x.size), min(_STRIDES, x.size))
    at, place = (np.array([float(y[part].mean()) for part in parts]) for y in (t, x))
    steps = np.diff(at)
    return float(np.max(np.abs(np.diff(place)[steps > 0.0]) / steps[steps > 0.0], initial=0.0))


def _unit_of_periods(told: FloatArray) -> str:
    """The unit of periods (n,) of turns that no name tells: whole numbers are ms or us."""
    whole = bool(np.all(told == np.round(told)))
    return "us" if whole and np.median(told) > _LONG_TURN else "ms" if whole else "s"


def _in_degrees(told: FloatArray) -> bool:
    """Whether angles (n,) of an unknown unit, which turn to either side or begin again at 360, are degrees."""
    wraps = told.max() <= _CIRCLE and float(np.abs(np.diff(told)).max()) > 0.5 * _CIRCLE
    sides = min(-float(told.min()), float(told.max()))  # a wheel's turns are counted from about nought
    return float(np.ptp(told)) > _TURN and (bool(wraps) or sides > _SIDE * float(np.ptp(told)))


def _runs_down(told: FloatArray) -> bool:
    """Whether values (n,) are those of a speed that falls, however noisy it is from sample to sample."""
    parts = np.array_split(told, min(_PARTS, told.size))
    level, most = np.array([float(part.mean()) for part in parts]), float(told.max())
    rough = np.sqrt(np.mean((told - np.interp(np.arange(told.size), _middles(parts), level)) ** 2))
    falls = bool(np.all(np.diff(level) <= _FALLS * most)) and level[0] - level[-1] > _HALF * most
    return falls and told.min() > -_ROUGH * most and level[-1] < _LEFT * most and float(rough) < _ROUGH * most


def _perhaps_falling(one: Column) -> Column:
    """A column that nothing says, as a speed where it falls from its largest value to nearly nought and is never below
    it: it is asked for in any case.
    """
    told = one.values[np.isfinite(one.values)]
    parts = [float(part.mean()) for part in np.array_split(told, min(_ENDS, told.size))]
    falls = not one.channel and told.min() >= 0.0 and parts[0] == max(parts) and parts[-1] < _LEFT * parts[0]
    return replace(one, channel="v", told=_SCALED) if falls else one


def _middles(parts: Sequence[FloatArray]) -> FloatArray:
    sizes = np.array([part.size for part in parts])
    found: FloatArray = np.cumsum(sizes) - 0.5 * (sizes + 1.0)
    return found


_SAME = 1e-3
"""Of its largest value, by which a norm as it is written may differ from that of its components."""


def _without_norms(columns: Sequence[Column]) -> list[Column]:
    """The columns without those that are the norm of all others of their channel, as of three axes."""
    left_out = []
    for channel in ("x", "v", "a"):
        those = [one for one in columns if one.channel == channel][: _NORMED + 1]
        for one in those if 2 < len(those) <= _NORMED and len({other.values.size for other in those}) == 1 else ():
            norm = np.sqrt(np.sum([other.values**2 for other in those if other is not one], axis=0))
            if float(np.nanmax(np.abs(norm - one.values))) <= _SAME * float(np.nanmax(norm)):
                left_out.append(one)
    return [one for one in columns if one not in left_out]


_NOISE, _SMOOTH = 1.2, 0.5
"""Spread of its steps over its own, of a column from which it may be noise about a level, 1.41, and up to which one
moves from sample to sample.
"""


def _without_noise(columns: Sequence[Column]) -> list[Column]:
    """The columns without those of no unit that are noise about a level, where another of a motion moves."""
    rough = {one: _roughness(one.values) for one in columns if one.channel in ("", "x", "v", "a")}
    if not any(rough[one] < _SMOOTH and not one.rises for one in rough):
        return list(columns)
    return [one for one in columns if one.unit or rough.get(one, 0.0) < _NOISE]


def _roughness(values: FloatArray) -> float:
    told = values[np.isfinite(values)]
    return float(np.std(np.diff(told)) / np.std(told)) if told.size > 1 and np.ptp(told) > 0.0 else np.inf


_NORMED = 4
"""Columns among which a norm is looked for: three axes and it."""
_WEIGHTS = {"g": 1.0, "mg": 1e3, "m/s^2": 9.80665, "mm/s^2": 9806.65}
"""What an accelerometer at rest shows in each unit."""
_WEIGHT = 0.05
"""Share by which it may differ: offsets of cheap ones."""


def _with_gravity(columns: Sequence[Column]) -> list[Column]:
    """The columns; accelerations without a unit have the one in which together they feel their weight."""
    bare = [one for one in columns if one.channel == "a" and not one.unit]
    rest = float(np.linalg.norm([np.nanmedian(one.values) for one in bare])) if len(bare) > 1 else 0.0
    unit = next((u for u, size in _WEIGHTS.items() if abs(rest / size - 1.0) < _WEIGHT), "")
    return [replace(one, unit=unit, told=_UNIT, given=True) if unit and one in bare else one for one in columns]


def _with_turning(columns: Sequence[Column]) -> list[Column]:
    """The columns; rates of turning without a unit are in deg/s where one of them is too fast for rad/s, and beside a
    torque what says no unit turns.
    """
    if any(one.channel == "u" and (one.angular or is_torque(one.name)) for one in columns):
        columns = [
            replace(one, unit=TURNING[one.channel], given=True)
            if one.channel in TURNING and one.told == _NAME and not one.unit and not is_rate(one.name)
            else one
            for one in columns
        ]
    bare = [one for one in columns if one.channel == "v" and not one.unit and is_rate(one.name)]
    fastest = max((float(np.nanmax(np.abs(one.values))) for one in bare), default=0.0)
    unit, told = "deg/s" if fastest > _GYRO else "rad/s", _SCALED if fastest > GYRO_COUNTS else _NAME
    return [replace(one, unit=unit, given=True, told=told) if one in bare else one for one in columns]


def _by_name(name: str, unit: str | None) -> tuple[str, int, str]:
    """The channel of a column, what tells it, and the unit; "other" for what is none, "" where nothing is said."""
    if of_a_turn(unit or "") or (is_period(name) and (unit is None or is_unit_of("t", unit))):
        _, short = unit_ending(name, "t") or ("t", "")
        return "period", _UNIT if of_a_turn(unit or "") or is_of_a_turn(name) else _NAME, unit or short
    means = meaning(name)
    named = means.channel if means is not None else word_of(name) or ("v" if is_rate(name) else "")
    if means is None and is_no_motion(name) and (unit is None or RAW.match(unit)):
        return "other", _NAME, ""
    if unit is not None and not RAW.match(unit):
        fits = [c for c in CHANNELS if is_unit_of(c, unit)]
        return (named if named in fits else fits[0] if fits else "other"), _UNIT, unit
    if unit is not None:
        return (named if named in _SI else ""), _SCALED, _SI.get(named, "m")
    if means is not None:
        return named, _UNIT if means.unit else _NAME, means.unit or ""
    electric = is_electrical(name)
    ending = None if electric else unit_ending(name, named)
    by = _SCALED if electric or _IN_VOLTS.search(name.lower()) else _NAME if named else _NUMBERS
    bare = ("v", by, "rpm") if electric else (named, by, "")
    return (ending[0], _UNIT, ending[1]) if ending else bare


def _is_count(header: str, told: FloatArray, steps: FloatArray) -> bool:
    """Whether a column numbers its rows."""
    whole = bool(np.all(told == np.round(told)))
    words = _CAMEL.sub(" ", header).lower()
    named = bool(_COUNTS & set(re.split(r"[^a-z]+", words)))
    return whole and (bool(np.all((steps == 0.0) | (steps == 1.0))) or (named and bool(np.all(steps >= 0.0))))
