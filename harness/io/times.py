"""Times as loggers write them: dates, stamps since 1970, repeated or late ones; what their spacing is like."""

import re
from datetime import UTC, date, datetime

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import InputError
from harness.io.columns import Mapping
from harness.io.table import Table
from harness.io.units import Unit

_DAY, _HOUR, _MINUTE = 86_400.0, 3600.0, 60.0
_STAMP = re.compile(
    r"(?:(?P<day>\d{4}-\d\d-\d\d|\d\d?[./]\d\d?[./]\d{4}|\d\d?-[A-Z][a-z]{2}-\d{4})[T ]|(?P<days>\d{1,5}) days? )?"
    r"(?P<h>\d\d?):(?P<m>\d\d):(?P<s>\d\d(?:[.,:]\d{1,12})?)(?P<half> ?[AP]M)?(?P<zone>Z|[+-]\d\d:?\d\d)?"
)


_BASIC = re.compile(r"(\d{4})(\d\d)(\d\d)T(\d\d)(\d\d)(?=\d\d)")
"""A date and a time of day without what parts their numbers."""
_NOON = _MONTHS = 12
_MINUTES = re.compile(r"(?P<m>\d{1,3}):(?P<s>[0-5]\d[.,]\d{1,9})")
"""Of a stop watch; hours and minutes have no fraction."""


def _day(text: str) -> int:
    """Number of a day; which of the two is the month does not matter within one. Raises ValueError for none."""
    if text[-5] == "-":  # 05-Jan-2024
        return datetime.strptime(text, "%d-%b-%Y").toordinal()
    if "-" in text:
        return date.fromisoformat(text).toordinal()
    one, other, year = map(int, re.split(r"[./]", text))
    return (date(year, other, one) if "." in text or one > _MONTHS else date(year, one, other)).toordinal()


class Clock:
    """Turns stamps into seconds from the first."""

    def __init__(self) -> None:
        self.first = ""
        self._day, self._seconds, self._last, self._nights = 0, 0.0, 0.0, 0

    def seconds(self, text: str) -> float | None:
        """From the first stamp that was asked for; None for what is no date with a time of day, nor a time of day.

        Days and seconds are subtracted apart: seconds since 1970 have no more than seven digits behind the point.
        """
        found = _STAMP.fullmatch(_BASIC.sub(r"\1-\2-\3T\4:\5:", text.strip()))
        if found is None:
            return self._of_a_stop_watch(text.strip())
        try:
            day = _day(found["day"]) if found["day"] else int(found["days"] or 0)
        except ValueError:
            return None
        seconds = _HOUR * int(found["h"]) + _MINUTE * int(found["m"]) + float(re.sub("[,:]", ".", found["s"]))
        if found["half"]:
            seconds += _HOUR * (12.0 * ("P" in found["half"]) - 12.0 * (int(found["h"]) == _NOON))
        if found["zone"] not in (None, "Z"):
            zone = found["zone"].replace(":", "")
            ahead = _HOUR * int(zone[1:3]) + _MINUTE * int(zone[3:5])
            seconds += -ahead if zone[0] == "+" else ahead
        if not found["day"] and not found["days"]:  # past midnight a time of day begins again
            self._nights += seconds < self._last - 0.5 * _DAY
            day, self._last = self._nights, seconds
        if not self.first:
            self.first, self._day, self._seconds = text.strip(), day, seconds
        return (day - self._day) * _DAY + (seconds - self._seconds)

    def _of_a_stop_watch(self, text: str) -> float | None:
        short = _MINUTES.fullmatch(text)
        if short is None:
            return None
        seconds = _MINUTE * int(short["m"]) + float(short["s"].replace(",", "."))
        if not self.first:
            self.first, self._seconds = text, seconds
        return seconds - self._seconds


def counted_from(table: Table, mappings: dict[str, Mapping]) -> str | None:
    """The first stamp, where times are dates; None where they are numbers. Raises InputError for dates elsewhere."""
    first = None
    for channel, mapping in mappings.items():
        dated = [table.dated[i] for i in map(table.position, mapping.names) if i in table.dated]
        if dated and (channel != "t" or len(mapping.names) > 1):
            where = f"{table.path}: channel {channel}"
            raise InputError(where, f"the time '{dated[0]}'", "numbers; times are for t alone")
        first = dated[0] if dated else first
    return first


_EPOCHS: tuple[tuple[float, float, str, float], ...] = (
    (3e8, 1e10, "s", 1.0),
    (3e11, 1e13, "ms", 1e-3),
    (3e14, 1e16, "us", 1e-6),
    (3e17, 1e19, "ns", 1e-9),
)
"""Stamps of 1979 to 2286 in each unit; no two overlap, and no experiment lasts ten years."""

_FACTOR = {name: factor for _, _, name, factor in _EPOCHS}

_OFF = 1.0
"""Steps of a coarse clock by which its stamps of even samples are off at most: half of one, and as much again."""


SCALES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "day": _DAY}
_SLOWEST = 2.0
"""s between samples at which nobody records a motion."""
_CALENDARS = ((36_525.0, 73_050.0), (730_000.0, 767_000.0))
"""Days of 2000 to 2099 as spreadsheets count them, and as MATLAB does."""
_FINEST = 1.0 / _DAY
"""Of which nobody records so many a second: samples of less than a second, in days."""


def _are_whole(t: FloatArray) -> bool:
    """Whether times (n,) are whole numbers, but for what a computation of them left."""
    return bool(np.all(np.abs(t - np.round(t)) <= 4.0 * np.spacing(np.abs(t).max())))


def clock_unit(t: FloatArray) -> str:
    """The unit of times (n,) that no name tells: that of stamps since 1970, of days of a calendar, of whole numbers too
    far apart for s; "" where it may be s.
    """
    if t.size < 2:
        return ""
    step = float(np.median(np.diff(t)))
    if any(low <= t[0] and t[-1] < high for low, high in _CALENDARS) and 0.0 < step < _FINEST:
        return "day"
    if not _are_whole(t):
        return ""
    if since := next((unit for low, high, unit, f in _EPOCHS if low <= t[0] < high and step * f < _MINUTE), ""):
        return since
    return next((unit for unit in ("ms", "us", "ns") if step * SCALES[unit] < _SLOWEST), "") if step >= _SLOWEST else ""


def _several_units(t: FloatArray) -> list[tuple[str, BoolArray]]:
    """Units in which stamps (n,) count from 1970, each with which of them, where that is more than one; else none."""
    found = [(name, (low <= t) & (t < high)) for low, high, name, _ in _EPOCHS]
    found = [(name, of) for name, of in found if np.any(of)]
    return found if len(found) > 1 and sum(int(np.count_nonzero(of)) for _, of in found) == t.size else []


def since_first(t: FloatArray, unit: Unit) -> tuple[FloatArray, str | None]:
    """Stamps of shape (n,) as read, in s: from the first where they count from 1970, and the sentence that says so.

    unit : what the header says; where it says nothing, the size of the stamps tells, or that they are whole numbers.
    """
    if (several := _several_units(t)) and not unit.text:
        units = ", ".join(name for name, _ in several)
        seconds, said = since_first(sum((np.where(of, t * _FACTOR[name], 0.0) for name, of in several), 0.0 * t), unit)
        return seconds, f"Stamps count since 1970 in {units} by turns. {said or ''}".strip()
    first = float(t[0]) if t.size else 0.0
    step = float(np.median(np.diff(t))) if t.size > 1 else 0.0
    if (clock_unit(t) if not unit.text else "day" if unit.factor == _DAY else "") == "day":
        return (t - first) * _DAY, "Times are days of a calendar: t is counted from the first."
    for low, high, name, factor in _EPOCHS:
        told = step * factor < _MINUTE if not unit.text else np.isclose(unit.factor, factor, rtol=1e-9, atol=0.0)
        if told and low <= first < high:
            when = datetime.fromtimestamp(first * factor, UTC).strftime("%Y-%m-%d %H:%M:%S")
            said = f"Stamps count {name} since 1970: t is counted from the first, {when} UTC."
            return (t - first) * factor, said
    if not unit.text and (whole := clock_unit(t)):
        return t * SCALES[whole], f"Times are whole numbers without a unit, too far apart for s: read as {whole}."
    return t * unit.factor, None


_ROLLS = (1e9, 2.0**32, 2.0**16)
"""At which nanoseconds of a second, and counters of 32 and 16 bits, begin again."""


def unrolled(stamps: FloatArray) -> FloatArray:
    """Whole stamps (n,) that begin again at a second or at the end of a counter, in one course; others as they are."""
    steps = np.diff(stamps)
    back = steps < 0.0
    if not np.any(back) or np.any(stamps < 0.0) or np.any(stamps != np.round(stamps)):
        return stamps
    usual = float(np.median(steps[~back])) if np.any(~back) else 0.0
    for roll in _ROLLS:
        over = steps[back] + roll
        if float(stamps.max()) < roll and np.all((over > 0.0) & (over <= GAP * usual)):
            return stamps + roll * np.concatenate(([0.0], np.cumsum(back)))
    return stamps


def rising(t: FloatArray) -> BoolArray:
    """Which of the times (n,) come after all before them: a row that was written twice and a clock that was set back
    leave few that do not.
    """
    before = np.maximum.accumulate(np.concatenate(([-np.inf], t[:-1])))
    found: BoolArray = t > before
    return found


def even_rate(t: FloatArray) -> float | None:
    """The rate in Hz of samples whose times (n,), s, stand still but never go back; None where they are not even.

    A clock that is too coarse is never further off an even one than its own step; a gap is.
    """
    steps = np.diff(t)
    if not np.any(steps == 0.0) or float(steps.min()) < 0.0 or t[-1] <= t[0]:
        return None
    count = np.arange(t.size) - 0.5 * (t.size - 1)
    interval = float(count @ t) / float(count @ count)
    # its own step is that beside a sample: stamps of three digits grow coarser as they grow
    moved = np.flatnonzero(steps > 0.0)
    after = np.searchsorted(moved, np.arange(t.size))
    beside = np.maximum(steps[moved[np.minimum(after, moved.size - 1)]], steps[moved[np.maximum(after - 1, 0)]])
    off = t - interval * count
    return 1.0 / interval if bool(np.all(np.abs(off - off.mean()) <= _OFF * beside)) else None


def evened(t: FloatArray, y: FloatArray) -> tuple[FloatArray, str | None]:
    """Times (n,), s, that were rounded, on the even clock that they round, and the sentence that says so.

    y : (n,), a channel. Steps of 16 and 17 ms may be those of 60 Hz to whole ms, or what a scheduler did; y is smoother
    over the clock that it was sampled by. Samples may lack; others are given back as they are.
    """
    steps = np.diff(t)
    if steps.size < _FEWEST:
        return t, None
    median = float(np.median(steps))
    apart = np.diff(np.sort(steps))
    apart = apart[apart > _TICK * UNEVEN * median]
    tick = float(apart.min()) if apart.size else 0.0
    if tick < UNEVEN * median or np.any(np.abs(steps / tick - np.round(steps / tick)) > _WHOLE):
        return t, None
    usual = float(np.mean(steps[steps < _LACKS * median]))
    count = np.concatenate(([0.0], np.cumsum(np.maximum(np.round(steps / usual), 1.0))))
    about = count - count.mean()
    interval = float(about @ t) / float(about @ about)
    even = t.mean() + interval * about
    off = float(np.ptp(t - even)) / tick
    if not _WHOLE < off <= 1.0 + _WHOLE or roughness(even, y) > roughness(t, y):
        return t, None
    said = (
        f"Stamps are rounded to {tick * 1e3:.3g} ms: the even clock of {1.0 / interval:.6g} Hz is taken in their place."
    )
    return even, said


def roughness(t: FloatArray, y: FloatArray) -> float:
    """Mean square of what the cubic through two samples on either side leaves of values (n,) at times (n,), n >= 5."""
    near = [slice(i, t.size - 4 + i) for i in range(5)]
    at, others = t[near[2]], [near[i] for i in (0, 1, 3, 4)]
    left = y[near[2]].copy()
    for one in others:
        weight = np.ones(at.size)
        for other in others:
            weight *= 1.0 if other is one else (at - t[other]) / (t[one] - t[other])
        left -= weight * y[one]
    return float(np.mean(left**2))


def whole_numbers(t: FloatArray, unit: Unit) -> str | None:
    """A caution where times without a unit are whole numbers and count no seconds, as samples or ms would."""
    if unit.text or t.size < 2 or float(np.median(np.diff(t))) < 1.0 or not _are_whole(t):
        return None
    return "Times are whole numbers without a unit, read as s; --columns with t=NAME[ms], or --rate, says otherwise."


GAP = 5.0
"""An interval longer than this many medians is a gap."""
UNEVEN = 0.01
"""Intervals that vary by less than this share of their median are even."""
_FEWEST = 5
"""Steps in which a rounding shows."""
_TICK, _WHOLE, _LACKS = 0.1, 0.05, 1.5
"""Of the least tick that shows, by which steps differ that are one; of a tick, by which whole ones may be off; medians
of a step after which a sample lacks."""


def sampling_notes(t: FloatArray) -> tuple[str, ...]:
    """Say what is irregular about times of shape (n,) in s, n >= 2; nothing when they are even."""
    steps = np.diff(t)
    median = float(np.median(steps))
    gaps = np.flatnonzero(steps > GAP * median)
    rest = steps[steps <= GAP * median]
    notes = []
    if rest.size and float(rest.max() - rest.min()) > UNEVEN * median + 4.0 * float(np.spacing(np.abs(t).max())):
        low, high = rest.min() * 1e3, rest.max() * 1e3
        notes.append(f"Sampling is irregular: intervals of {low:.3g} to {high:.3g} ms, median {median * 1e3:.3g} ms.")
    if gaps.size:
        longest = gaps[np.argmax(steps[gaps])]
        count = "is 1 gap" if gaps.size == 1 else f"are {gaps.size} gaps"
        notes.append(f"There {count} in time, the longest of {steps[longest]:.3g} s at t = {t[longest]:.4g} s.")
    return tuple(notes)
