"""A file of any accepted format as a validated core Recording."""

import hashlib
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.apart import Found, read_apart
from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.bounded import MOST_BYTES, check_file, check_size
from harness.core.errors import InputError
from harness.core.recording import CHANNELS, LARGEST, LONGEST_TIME, MINIMUM_SAMPLES, Recording
from harness.io.choose import as_angles, chosen, products, quoted_of, said, unscaled
from harness.io.columns import Mapping, is_current, is_magnitude, is_no_motion, parse_columns
from harness.io.encoders import at_clocked_edges, at_edges, unwrapped
from harness.io.join import joined
from harness.io.logs.suspicions import FACTORS, NEAR, ratio, unsigned
from harness.io.options import ReadOptions, RefusedError, tried
from harness.io.registry import BAGS, formats, kind_of, reader_for
from harness.io.table import Table
from harness.io.times import (
    counted_from,
    even_rate,
    evened,
    rising,
    sampling_notes,
    since_first,
    unrolled,
    whole_numbers,
)
from harness.io.units import Unit

_MOST_LOST = 0.05
"""Share of the samples that may be left out unasked: rows written twice, a clock set back once, an empty cell."""
_WITH_TIME = 2
"""Columns, a time and a channel, of which a row that lacks the channel may have lost it."""
_AGAIN = 0.1
"""Share of a run's length behind its start up to which the time goes back where another run begins."""
_BACKWARDS = 0.99
"""Share of the steps of a time that go back, from which its rows stand with the latest first."""
_NO_GAIN = 2.0
"""Times the slope of a position, or one over that, from which a channel is not its speed."""
RrdReader = Callable[[Path], Recording]
"""Reads our own .rrd; passed in, since this room does not know the viewer's library."""


def sha256(path: Path) -> str:
    """The hash of a file, in hex."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _open(path: Path, options: ReadOptions) -> Table:
    kind = kind_of(path)
    reader = reader_for(path)
    if reader is not None and reader.text:
        return reader.open(path, options.skip_rows)
    if options.skip_rows:
        raise InputError("--skip-rows", f"given for the {kind} file {path}", "it goes with text tables alone")
    if reader is None:
        beside = ", and a bag of a robot's joints with --robot FILE" if kind in BAGS else ""
        raise InputError(str(path), f"the format {kind or 'without a name'}", f"{formats()}{beside}")
    return reader.open(path)


def _check_rows(table: Table, channel: str, values: FloatArray, rows: IntArray) -> None:
    """rows : the file's row of each value, from 0."""
    largest = LONGEST_TIME if channel == "t" else LARGEST
    bad = np.flatnonzero(~(np.abs(values) <= largest))  # that of nan is not
    if bad.size:
        value = values[bad[0]]
        where = f"{table.path}: {table.row(int(rows[bad[0]]))}, column {channel}"
        found = "no value or nan" if np.isnan(value) else f"{value:g}"
        accepted = f"at most {largest:g} in size" if np.isfinite(value) else "a finite number"
        raise RefusedError(where, found, accepted, () if np.isfinite(value) else [{"drop_nan": True}])


def _in_order(
    table: Table, t: FloatArray, rows: IntArray, values: Sequence[FloatArray]
) -> tuple[FloatArray, BoolArray, str | None]:
    """Times (n,), s, which samples stay so that they rise, and the sentence that says what was done.

    values : of each column (m,), by the file's rows. A few that do not come after the one before are left out, and so
    are all that repeat it, values and all; where a clock is too coarse for its samples, those of an even one that it
    agrees with throughout take its place. Raises InputError where none of these will do.
    """
    after = rising(t)
    lost = np.flatnonzero(~after)
    if lost.size == 0:
        return t, after, None
    row = table.row(int(rows[lost[0]]))
    if lost.size <= max(_MOST_LOST * t.size, 1):
        many = f"{lost.size} sample{'s' if lost.size > 1 else ''}"
        return t, after, f"{many} whose time does not come after the one before ({row}) not used."
    same = [np.array_equal(t[lost], t[lost - 1]), *(np.array_equal(y[rows[lost]], y[rows[lost - 1]]) for y in values)]
    if all(same):
        return t, after, f"{lost.size} rows repeat the one before, values and all ({row}): not used."
    rate = even_rate(t)
    if rate is not None:
        again = int(np.count_nonzero(np.diff(t) == 0.0))
        said = f"{again} of {t.size} times repeat the one before ({row}): an even clock of {rate:.6g} Hz is taken"
        even = t[0] + np.abs(rows - rows[0]) / rate
        return even, np.ones(t.size, bool), f"{said}, from which none is further off than its own step."
    i = int(lost[0])
    found = f"time {t[i]:.9g} s does not come after {t[i - 1]:.9g} s"
    raise InputError(f"{table.path}: {row}, column t", found, "times that increase")


def _kept(path: Path, t: FloatArray, options: ReadOptions) -> slice:
    """The samples between --from and --to."""
    first = 0 if options.start is None else int(np.searchsorted(t, options.start, "left"))
    last = t.size if options.stop is None else int(np.searchsorted(t, options.stop, "right"))
    count = max(last - first, 0)
    if count < MINIMUM_SAMPLES:
        cut = "" if count == t.size else f" between --from and --to (the file runs from {t[0]:g} s to {t[-1]:g} s)"
        raise InputError(str(path), f"{count} sample{'' if count == 1 else 's'}{cut}", f"at least {MINIMUM_SAMPLES}")
    return slice(first, last)


def read_recording(path: Path, options: ReadOptions | None = None, read_rrd: RrdReader | None = None) -> Recording:
    """Read a recording of any accepted format, in SI units.

    With --columns only the channels it names are taken (and a column t, unless --rate is given); without it the columns
    whose names say t, x, v, a or u as people write them, and what was guessed is a note. Stamps that count from 1970
    are counted from the first. An angle that wraps is put together. Values are checked between --from and --to.

    Raises InputError naming the file, row, column or option that is wrong.
    """
    options = options or ReadOptions()
    if options.join:
        alone = replace(options, join=())
        others = [read_recording(one, replace(alone, columns=None), read_rrd) for one in options.join]
        return joined(read_recording(path, alone, read_rrd), others)
    check_file(path)
    reader = reader_for(path)
    try:
        if reader is not None and reader.text:
            check_size(path, MOST_BYTES)
        digest = sha256(path)
    except OSError as error:
        raise InputError(str(path), error.strerror or str(error), "a file that can be read") from None
    if path.suffix.lower() == ".rrd" and read_rrd is not None:
        return _from_rrd(path, digest, options, read_rrd)
    if reader is None or reader.text:
        return _read_or_propose(path, digest, options)
    accepted = f"a whole {kind_of(path)} file"
    columns, about = read_apart(
        "harness.io.recording:columns_of", path, accepted, digest=digest, options=asdict(options)
    )
    channels = {name: values for name, values in columns.items() if name in CHANNELS}
    beside = {name: columns[_COVARIATE + name] for name in options.covariates}
    return Recording(columns["t"], channels, str(path), digest, covariates=beside, **about)


def columns_of(path: Path, digest: str, options: dict[str, Any]) -> Found:
    """What ``read_recording`` finds, as a process of its own hands it on."""
    found = _read_or_propose(path, digest, ReadOptions(**options))
    beside = {_COVARIATE + name: values for name, values in found.covariates.items()}
    about = {"angular": found.angular, "steady": found.steady, "notes": found.notes, "mended": found.mended}
    about |= {"units": dict(found.units), "columns": dict(found.columns), "extra": dict(found.extra)}
    return {"t": found.t, **found.channels, **beside}, about


_COVARIATE = "covariate "
"""Before the name of a covariate, which may be that of a channel."""


def _read_or_propose(path: Path, digest: str, options: ReadOptions) -> Recording:
    try:
        return _read(path, digest, options)
    except InputError as error:
        raise tried(error, options, lambda other: _read(path, digest, other)) from None


_STEADY = "No time: each row is taken as a speed that was held, with the force that held it."


def _read(path: Path, digest: str, options: ReadOptions) -> Recording:
    table = _open(path, options)
    options, step = _with_own_rate(table, options)
    choice = chosen(table, options)
    mappings, guessed = choice.mappings, choice.guessed
    read, turns = as_angles(path, products(table, mappings)) if options.angle else (products(table, mappings), None)
    dated = counted_from(table, mappings)
    steady = "t" not in mappings and options.rate is None
    said_of = (said(table, mappings, {c: unit for c, (_, unit) in read.items()}, guessed), *choice.notes, step, turns)
    others = _beside(table, mappings, options) if steady else None
    notes: list[str | None] = [*said_of, _STEADY if steady else None, others, *unscaled(table, mappings, read)]
    named = [table.position(name) for name in options.covariates]
    beside = dict(zip(options.covariates, table.read(named) if named else (), strict=True))
    sizes = {name: values.size for name, values in (*((c, y) for c, (y, _) in read.items()), *beside.items())}
    if len(set(sizes.values())) > 1:
        found = ", ".join(f"{size} values of {channel}" for channel, size in sizes.items())
        raise InputError(str(path), found, "columns of one length")
    rows, mended = _whole(table, (*(values for values, _ in read.values()), *beside.values()), options)
    about: dict[str, Any] = {"runs": choice.runs}
    if steady or options.rate is not None:
        with np.errstate(over="ignore"):
            t = rows.astype(np.float64) / (options.rate or 1.0)
        _check_rows(table, "t", t, rows)
    else:
        stamps = unrolled(read["t"][0]) if dated is None else read["t"][0]
        rows, turned = _forward(stamps, rows)
        rows, below = _run_below(stamps, rows, options, choice.runs, str(path))
        t, notes_of_t = _stamped(stamps, read["t"][1], rows, dated)
        about = {"runs": max(below, choice.runs), **_clock(stamps[rows], t, dated)}
        notes += [f"{_BELOW.format(below)}: run {options.run or 1} is read." if below > 1 else None, *notes_of_t]
        mended.append(turned)
        _check_rows(table, "t", t, rows)
        t, after, lost = _in_order(
            table, t, rows, [y for c, (y, _) in read.items() if c != "t"] + list(beside.values())
        )
        t, rows = t[after], rows[after]
        mended.append(lost)
    keep = slice(None) if steady else _kept(path, t, options)
    channels = {channel: values[rows][keep] for channel, (values, _) in read.items() if channel != "t"}
    covariates = {name: values[rows][keep] for name, values in beside.items()}
    for name, values in (*channels.items(), *covariates.items()):
        _check_rows(table, name, values, rows[keep])
    t = t[keep]
    angular = _angular({channel: unit for channel, (_, unit) in read.items()})
    if "x" in channels and (angular or "v" in channels):
        channels["x"], wrapped = unwrapped(t, channels["x"], channels.get("v"), read["x"][1].factor)
        mended.append(wrapped)
    columns = {c: quoted_of(table, mappings[c], unit) for c, (_, unit) in read.items()}
    _check_channels(table, mappings, channels, columns)
    mended.append(_without_other_speed(t, channels, columns) if options.columns is None else None)
    if "t" in read:
        t, channels, covariates, edges = _between_counts(t, channels, covariates)
        t, rounded = evened(t, next(channels[c] for c in ("x", "v", "a") if c in channels))
        mended += [edges, rounded]
    return Recording(
        t,
        channels,
        file=str(path),
        sha256=digest,
        units={
            **{name: text for name in beside if (text := table.units.get(table.position(name)))},
            **{channel: read[channel][1].text for channel in columns if read[channel][1].text},
        },
        angular=angular,
        extra=about | ({"commanded": True} if choice.commanded else {}) | _current(table, columns, angular),
        notes=(*filter(None, notes), *filter(None, mended), *(() if steady else sampling_notes(t))),
        covariates=covariates,
        columns=columns,
        mended=tuple(filter(None, mended)),
        steady=steady,
    )


def _beside(table: Table, mappings: dict[str, Mapping], options: ReadOptions) -> str | None:
    """The conditions that a table of held speeds holds besides, as a temperature, which nobody asked to act."""
    read = {table.position(name) for one in mappings.values() for name in one.names}
    found = []
    for i in (i for i, name in enumerate(table.names) if i not in read and name and name not in options.covariates):
        with suppress(InputError):
            values = table.columns([i])[0]
            if is_no_motion(table.names[i]) and np.nanmax(values) > np.nanmin(values):
                found.append(table.names[i])
    if not found:
        return None
    options_of = " ".join(f"--covariate '{name}'" for name in found)
    return f"The table holds {' and '.join(found)} besides, whose effect counts as noise here: {options_of} asks it."


def _current(table: Table, columns: dict[str, str], angular: bool) -> dict[str, str]:
    """Under "current", what makes a motor's current, which no channel reads, the force that is missing."""
    if "u" in columns:
        return {}
    for i in (i for i, name in enumerate(table.names) if is_current(name, table.units.get(i, ""))):
        with suppress(InputError):
            values = table.columns([i])[0]
            told = values[np.isfinite(values)]
            if told.size and told.min() < told.max():
                torque = "Nm" if angular else "N"
                paste = ",".join([*(f"{c}={one}" for c, one in columns.items()), f"u=1*{table.quoted(i)}[{torque}]"])
                said = f'{table.headers[i]} is not read; if it drives this, try: --columns "{paste}"'
                worth = f"{torque} per {table.units.get(i) or 'unit'}, a motor's constant times the gear"
                return {"current": f"{said} with the {worth}, in place of 1"}
    return {}


Series = dict[str, FloatArray]


def _between_counts(
    t: FloatArray, channels: Series, covariates: Series
) -> tuple[FloatArray, Series, Series, str | None]:
    """Times, channels and covariates, where a count changed half way to each row, or half way to some, and what is
    said of it.
    """
    places = at_edges(t, channels["x"]) if set(channels) == {"x"} else None
    if places is None:
        marks = at_clocked_edges(t, channels["x"]) if set(channels) == {"x"} and not covariates else None
        if marks is None:
            return t, channels, covariates, None
        seen = f"The count stands at most samples: its {marks[0].size} steps are read, each half way to its sample."
        return marks[0], {"x": marks[1]}, covariates, seen
    beside = {name: values[1:] for name, values in covariates.items()}
    said = "Each stamp is that of a count that changed: x is half way between it and the one before."
    return t[1:], {"x": places}, beside, said


def _without_other_speed(t: FloatArray, channels: dict[str, FloatArray], columns: dict[str, str]) -> str | None:
    """Takes out a speed (n,) that is not the slope of the position, and says what it is to be multiplied by: that of a
    unit taken for another, a turned sign or a gear. No sensor's gain is so far off.
    """
    factor = ratio(t, channels["x"], channels["v"]) if {"x", "v"} <= set(channels) else None
    if factor is None or _NO_GAIN > factor > 1.0 / _NO_GAIN:
        return None
    value, looks = next(((f, f", as {text}") for f, text in FACTORS if abs(factor / f - 1.0) < NEAR), (factor, ""))
    both = ",".join(f"{c}={name}" for c, name in {**columns, "v": f"{1.0 / value:.6g}*{columns['v']}"}.items())
    for of in (channels, columns):
        del of["v"]
    found = f"The speed is {value:.4g} times the slope of the position{looks}: the position alone is read"
    return f'{found}; --columns "{both}" reads both.'


def _check_channels(
    table: Table, mappings: dict[str, Mapping], channels: dict[str, FloatArray], columns: dict[str, str]
) -> None:
    """Raise InputError where the force has lost its sign, by its name or by what it does beside the position, and, with
    the columns without it, where a channel of the motion stands still beside one that moves.
    """
    _check_signed(table, mappings, channels)
    spread = {c: float(np.ptp(channels[c])) for c in ("x", "v", "a") if c in channels and channels[c].size}
    still = [c for c, of in spread.items() if of == 0.0]
    if still and len(still) < len(spread):
        found = f"the constant {channels[still[0]][0]:g}"
        others = [{"columns": ",".join(f"{c}={name}" for c, name in columns.items() if c not in still)}]
        raise RefusedError(f"{table.path}: column {columns[still[0]]}", found, "a channel that moves", others)


def _check_signed(table: Table, mappings: dict[str, Mapping], channels: dict[str, FloatArray]) -> None:
    """Raise InputError where the force has lost its sign, by its name or by what it does beside the position."""
    places = [table.position(name) for name in mappings["u"].names] if "u" in mappings else []
    names = [table.names[at] for at in places if at >= 0]
    moved = {"": channels["x"]} if names and "x" in channels else {}
    if any(map(is_magnitude, names)) or (moved and unsigned(moved, {"": channels["u"]})):
        found = "values without a sign, which say nothing of friction"
        raise InputError(f"{table.path}: column {'*'.join(names)}, as u", found, "a force or torque with its sign")


def _forward(stamps: FloatArray, rows: IntArray) -> tuple[IntArray, str | None]:
    """The rows from the first, where they stand with the latest first, and the sentence that says so."""
    if np.count_nonzero(np.diff(stamps[rows]) < 0.0) > max(_BACKWARDS * rows.size, 1.0):
        return rows[::-1], "Rows stand with the latest first: they are read from the last."
    return rows, None


def _run_below(t: FloatArray, rows: IntArray, options: ReadOptions, beside: int, file: str) -> tuple[IntArray, int]:
    """The rows of the run that is asked for, where several stand one under another and each begins its time again; and
    how many there are.

    t : of the file, as it stands. beside : runs that stand side by side.
    """
    known = t[rows]
    back = np.flatnonzero(known[1:] < known[:-1]) + 1
    starts = [0]
    for at in back:
        begun = known[starts[-1]]
        if at - starts[-1] >= MINIMUM_SAMPLES and known[at] - begun < _AGAIN * (known[at - 1] - begun):
            starts.append(int(at))
    runs = np.split(rows, starts[1:])
    number = 1 if beside > 1 else options.run or 1
    if number > len(runs):
        raise InputError("--run", f"{number} of {len(runs)} in {file}", "a run that the file holds")
    return runs[number - 1], len(runs)


_BELOW = "The file holds {} runs one under another (--run N)"


def _clock(stamps: FloatArray, t: FloatArray, dated: str | None) -> dict[str, Any]:
    """What another file needs to be put on the clock of this one: the day or time of day of t = 0, or s since 1970."""
    if dated is not None:
        return {"dated": dated}
    with np.errstate(all="ignore"):
        scale = (t[-1] - t[0]) / (stamps[-1] - stamps[0]) if t.size else 1.0
        since = stamps[0] * scale - t[0] if t.size else 0.0
    return {"since": float(since)} if np.isfinite(since) else {}


def _with_own_rate(table: Table, options: ReadOptions) -> tuple[ReadOptions, str | None]:
    """The options, with the rate of a file that says its step in place of times, and the sentence that says so."""
    if table.rate is None or options.rate is not None or "t" in parse_columns(options.columns or "x=#1"):
        return options, None
    return replace(options, rate=table.rate), f"The file says the step between its samples: {1.0 / table.rate:.6g} s."


def _stamped(stamps: FloatArray, unit: Unit, rows: IntArray, dated: str | None) -> tuple[FloatArray, list[str | None]]:
    """Times of the rows (n,), s, and what is said of them. dated : the first, where they are dates or times of day."""
    t, counted = stamps[rows], f"Times are dates, times of day or spans: t is counted from the first, {dated}."
    if dated is not None:
        return t, [counted]
    with np.errstate(over="ignore", invalid="ignore"):
        t, since_1970 = since_first(t, unit)
    return t, [since_1970, whole_numbers(t, unit)]


def _whole(table: Table, columns: Sequence[FloatArray], options: ReadOptions) -> tuple[IntArray, list[str | None]]:
    """The rows in which every column (n,) has a value, where those that lack one are few, and what is said of them."""
    mended: list[str | None] = list(table.mended)
    rows = np.arange(columns[0].size)
    last = _last_value(columns)
    if last < rows.size:
        mended.append(f"The last {rows.size - last} rows, without a value in these columns, are skipped.")
        rows = rows[:last]
    others = rows[:0] if len(columns) <= _WITH_TIME else _of_other_signals(columns)
    if others.size:
        mended.append(f"{others.size} rows that hold other columns alone are skipped.")
        rows = np.setdiff1d(rows, others)
    told = np.isfinite if options.drop_nan else (lambda values: ~np.isnan(values))
    whole = rows[np.all([told(values[rows]) for values in columns], axis=0)]
    if rows.size > whole.size and (options.drop_nan or rows.size - whole.size <= max(_MOST_LOST * rows.size, 1)):
        first, many = table.row(int(np.setdiff1d(rows, whole)[0])), rows.size - whole.size
        mended.append(f"{many} rows without a value, the first of them {first}, are skipped.")
        rows = whole
    return rows, mended


def _of_other_signals(columns: Sequence[FloatArray]) -> IntArray:
    """The rows in which one of the columns (n,), as the time, has a value and none of the others."""
    return np.flatnonzero(np.sum([~np.isnan(values) for values in columns], axis=0) == 1)


def _last_value(columns: Sequence[FloatArray]) -> int:
    """How many samples there are up to the last at which any of the columns (n,) has a value, beside its time."""
    told = np.flatnonzero(~np.all([np.isnan(values) for values in columns], axis=0))
    return int(told[-1]) + 1 if told.size else 0


def _angular(units: dict[str, Unit]) -> bool:
    """Whether what moves is an angle: as position and acceleration say, else the speed."""
    by = [units[channel] for channel in ("x", "a") if channel in units]
    return any(unit.angular for unit in by or [units[c] for c in ("v",) if c in units])


def _from_rrd(path: Path, digest: str, options: ReadOptions, read_rrd: RrdReader) -> Recording:
    for option, value in (
        ("--columns", options.columns),
        ("--rate", options.rate),
        ("--skip-rows", options.skip_rows or None),
        ("--covariate", options.covariates or None),
    ):
        if value is not None:
            raise InputError(option, f"given for {path}", "a .rrd of ours says this itself; leave the option out")
    whole = read_rrd(path)
    kept = whole.cut(_kept(path, whole.t, options))
    return Recording(kept.t, kept.channels, str(path), digest, kept.units, kept.angular, kept.notes, kept.extra)
