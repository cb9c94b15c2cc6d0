"""Which columns of a table are which channels: as --columns says, else by their names, else by what they hold."""

import re
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import FEWEST_STEADY, MINIMUM_SAMPLES
from harness.io.columns import (
    CHANNELS,
    Mapping,
    candidates,
    is_angle,
    is_commanded,
    is_electrical,
    is_rate,
    is_torque,
    meaning,
    parse_columns,
    unit_ending,
)
from harness.io.options import UNSAID, ReadOptions, RefusedError
from harness.io.scoring import CONVERTER, GYRO_COUNTS, TURN_OF_4096, TURNING, Reading, likelier_unit, runs_of
from harness.io.table import Table
from harness.io.times import clock_unit, unrolled
from harness.io.units import RAW, STEPS, NoUnitError, OtherUnitError, TwofoldUnitError, Unit, is_unit_of, parse_unit

_STEP_TIME = re.compile(r"(?:dt|delta_?t|time_?step|sample_?time)(?:_[a-zµ]{1,2})?$")
"""The name of a column of times from row to row."""
_ONE_WAY = 0.9
"""Share of the rows of a friction curve, at least, in which the force has the sign of the speed."""
_MOST_CHOICES, _SHOWN, _LONG = 6, 8, 60
"""Readings that are tried, columns that are named at most, and characters of a name."""


@dataclass(frozen=True, slots=True)
class Chosen:
    """What is read of a table.

    mappings : by channel. guessed : channels that no option and no name of the channel's own gives. notes : what else
    there was to choose. runs : that stand side by side. commanded : a goal stands beside, and no force.
    """

    mappings: dict[str, Mapping]
    guessed: frozenset[str] = frozenset()
    notes: tuple[str, ...] = ()
    runs: int = 1
    commanded: bool = False


def chosen(table: Table, options: ReadOptions) -> Chosen:
    """What to read for each channel: as --columns says, as names say, or as one reading is clearly the best.

    Raises RefusedError, with readings to try, where the table leaves it open.
    """
    columns, rate = options.columns, options.rate
    if columns is None:
        found = _by_names(table, rate)
        if found is None or found.guessed:
            found = _by_score(table, options) or found or _several(table, options)
    else:
        found = Chosen(parse_columns(columns))
        if "t" not in found.mappings and rate is None and "t" in table.names:
            found.mappings["t"] = Mapping("t", ("t",))
    mappings = found.mappings
    if not set(mappings) & {"x", "v", "a"}:
        raise _no_motion(table, options)
    if "t" not in mappings and rate is None and set(mappings) != {"v", "u"}:
        hint = "a column t, or its sampling rate by --rate HZ"
        others = _others(table, options) if columns is None else ()
        raise RefusedError(str(table.path), f"no time among the columns {table.listed()}", hint, others)
    if "t" in mappings and rate is not None:
        accepted = "one of the two (--columns without t leaves the column out)"
        raise InputError("--rate", f"given although a column of {table.path} gives the time", accepted)
    commanded = _commanded(table, mappings)
    return replace(found, notes=(*found.notes, *commanded), commanded=bool(commanded))


def _no_motion(table: Table, options: ReadOptions) -> RefusedError:
    """What a table has in place of columns of a motion, and how it may be read."""
    hint = "columns named t and one or more of x, v, a, or a choice of them by --columns"
    what = f"the columns {table.listed()}"
    counts = (i for i in range(len(table.headers)) if STEPS.match(table.units.get(i, "")) or _is_converted(table, i))
    counted = next((table.headers[i] for i in counts), None)
    if counted is not None:
        what = f"{what}; {counted} is what a sensor counts"
    if options.columns is None and (bare := _without_unit(table)):
        what = f"{what}; {bare}"
    if (field := next(filter(is_electrical, table.headers), None)) is not None:
        what = f"{what}; {field} is of the motor's field: times 1/7 for 7 pole pairs"
    if force := next((h for i, h in enumerate(table.headers) if _is_force(table, i)), ""):
        what = f"{what}: {force[:_LONG]} is a force, and no motion was recorded with it"
    if options.columns is None and _nameless(table):
        what = f"{table.columns([0])[0].size} rows, too few for a motion, and no names that say a friction curve"
    others = _others(table, options)
    if others and f"={TURN_OF_4096}*" in others[0]["columns"]:
        what = f"{what}; {TURN_OF_4096} rad are a step where 4096 are a turn"
    return RefusedError(str(table.path), what, hint, others)


def _commanded(table: Table, mappings: dict[str, Mapping]) -> list[str]:
    """A note where somebody commanded what is read, and no force tells how it was obeyed."""
    goals = [i for i, name in enumerate(table.names) if is_commanded(name)]
    if "u" in mappings or not goals:
        return []
    moved = [i for i, y in zip(goals, table.columns(goals), strict=True) if y.size and np.nanmin(y) < np.nanmax(y)]
    name = table.headers[moved[0]][:_LONG] if moved else ""
    said = f"{name} was commanded: with the position it is a servo's, by harness diagnose; a torque, as u, tells more."
    return [said] if moved else []


def _others(table: Table, options: ReadOptions) -> list[dict[str, Any]]:
    """Choices of columns to try, with a rate to be given where no column is a time."""
    run, timed = (options.run or 1) - 1, options.rate is None
    told = table.said_rate or _rate_of_steps(table) or UNSAID
    if options.rate is None and (held := _nameless(table)):
        return [{"columns": held[0].columns, "run": None}]
    for rate, runs in ((options.rate, runs_of(table, timed)), (told, runs_of(table, False) if timed else [])):
        if run < len(runs) and runs[run]:
            said = {} if rate is None else {"rate": rate}
            return [{"columns": one.columns, "run": None, **said} for one in runs[run][:_MOST_CHOICES]]
    return []


def _rate_of_steps(table: Table) -> float | None:
    """Hz, where a column holds the time from row to row and that is always the same; None for any other table."""
    for i, name in enumerate(table.names):
        if not _STEP_TIME.match(name.lower()):
            continue
        with suppress(InputError):
            steps = table.columns([i])[0]
            unit = table.units.get(i) or (unit_ending(name, "t") or ("t", "s"))[1]
            if steps.size and steps[0] > 0.0 and np.all(steps == steps[0]) and is_unit_of("t", unit):
                return 1.0 / (float(steps[0]) * parse_unit("", "t", unit).factor)
    return None


def _by_names(table: Table, rate: float | None) -> Chosen | None:
    """The columns that the names of channels, as people write them, say; None where they leave it open, or the unit of
    an angle or of its rate, or where a sensor's own steps are no unit.
    """
    found = candidates(table.names)
    clock = table.names[found["t"][0]] if "t" in found and rate is None else None
    # each of several runs has its own clock
    if (clock is not None and table.names.count(clock) > 1) or any(len(positions) > 1 for positions in found.values()):
        return None
    bare = {c: at[0] for c, at in found.items() if at[0] not in table.units}
    if "x" in bare and is_angle(table.names[bare["x"]]):
        return None
    if any(c in bare and _wants_unit(table, c, bare[c], found) for c in ("x", "v")):
        return None
    raw = any(STEPS.match(table.units[at[0]]) for at in found.values() if at[0] in table.units)
    if not table.own or raw or ({"x", "v"} & set(bare) and "u" in found and is_torque(table.names[found["u"][0]])):
        return None
    steady = set(found) == {"v", "u"}
    if not set(found) & {"x", "v", "a"} or ("t" not in found and rate is None and not steady):
        return None
    mappings = {c: Mapping(c, (f"#{found[c][0] + 1}",)) for c in CHANNELS if c in found}
    own = {c for c in found if table.names[found[c][0]] in ((c, "F") if c == "u" else (c,))}
    return Chosen(mappings, frozenset(set(found) - own), _namesakes(table, found))


def _is_force(table: Table, position: int) -> bool:
    unit, means = table.units.get(position), meaning(table.names[position])
    of_force = unit is not None and is_unit_of("u", unit) and not is_unit_of("a", unit)
    return of_force if unit is not None else means is not None and means.channel == "u"


def _wants_unit(table: Table, channel: str, position: int, found: dict[str, list[int]]) -> bool:
    """Whether a speed is one of turning, or numbers are none in m or m/s, and the name says no unit."""
    name = table.names[position]
    if channel == "v" and (is_rate(name) or name == "v"):
        return is_rate(name) and not unit_ending(name, "v")
    means = meaning(name)
    if unit_ending(name, channel) or (means is not None and means.unit):
        return False
    try:
        values, *clock = table.columns([position, *found.get("t", ())[:1]])
    except InputError:
        return False
    if clock:
        clock = [np.where(np.isinf(clock[0]), np.nan, clock[0])]
    unit = _unit_of_clock(table, found["t"][0], clock[0]) if clock else "s"
    if not is_unit_of("t", unit):
        return False
    t = unrolled(clock[0]) * parse_unit("", "t", unit).factor if clock else None
    return bool(likelier_unit(channel, name, values, t))


def _without_unit(table: Table) -> str:
    """What is said of a column whose numbers without a unit are none in m or m/s; "" where there is none."""
    found = candidates(table.names)
    for channel in ("x", "v"):
        for position in found.get(channel, ()):
            name = table.names[position]
            if position not in table.units and not is_rate(name) and _wants_unit(table, channel, position, found):
                return (
                    f"{table.headers[position][:_LONG]} says no unit, and goes too fast or too far for {_SI[channel]}"
                )
    return ""


def _unit_of_clock(table: Table, position: int, t: FloatArray) -> str:
    """The unit of the times (n,) of a column, by its header, its name or its numbers."""
    means = meaning(table.names[position])
    told = "s" if position in table.dated else table.units.get(position) or (means.unit if means is not None else "")
    return told or clock_unit(t) or "s"


def _namesakes(table: Table, found: dict[str, list[int]]) -> tuple[str, ...]:
    """A note where columns have one name, of which the first is read."""
    last = {c: max(i for i, name in enumerate(table.names) if name == table.names[at[0]]) for c, at in found.items()}
    again = [c for c in CHANNELS if c in found and last[c] != found[c][0]]
    paste = ",".join(f"{c}=#{last[c] + 1}" for c in CHANNELS if c in found)
    named = " and ".join(table.names[found[c][0]] for c in again)
    said = f'Several columns are called {named}: the first is read, --columns "{paste}" reads the last.'
    return (said,) if again else ()


def _by_score(table: Table, options: ReadOptions) -> Chosen | None:
    """The reading that is clearly the best, of the run that is asked for; none where two are nearly as good."""
    runs = runs_of(table, options.rate is None)
    number = (options.run or 1) if len(runs) > 1 else 1
    if number > max(len(runs), 1):
        found = f"{number} of {len(runs)} in {table.path}"
        raise InputError("--run", found, "a run that the file holds")
    readings = runs[number - 1] if runs else []
    readings = readings if options.rate is not None else _held(table, bool(readings)) or readings
    readings = sorted(readings, key=lambda one: not one.clear)
    if not readings or not readings[0].clear:
        return None
    mappings = parse_columns(readings[0].columns)
    notes = [f"The file holds {len(runs)} runs: run {number} is read, --run N reads another."] if len(runs) > 1 else []
    notes += [f'Next best: --columns "{one.columns}".' for one in readings[1:2]]
    return Chosen(mappings, frozenset(mappings), tuple(notes), len(runs))


def _held(table: Table, timed: bool) -> list[Reading]:
    """Readings of a friction curve, a speed and the force that held it, where nothing can be a time, or there are fewer
    rows than a motion has.
    """
    held = [one for run in runs_of(table, False) for one in run if set(parse_columns(one.columns)) == {"v", "u"}]
    if held and timed:
        speed = table.position(parse_columns(held[0].columns)["v"].names[0])
        held = held if table.columns([speed])[0].size < MINIMUM_SAMPLES else []
    return held or _nameless(table)


def _nameless(table: Table) -> list[Reading]:
    """A friction curve of two columns whose names say nothing, of fewer rows than a motion has; the one that is meant
    where the force turns its sign with the speed.
    """
    if len(table.names) != 2 or any(map(meaning, table.names)) or table.units:
        return []
    try:
        v, u = table.columns([0, 1])
    except InputError:
        return []
    both = float(np.nanmin(v, initial=0.0)) < 0.0 < float(np.nanmax(v, initial=0.0))
    if not FEWEST_STEADY <= v.size < MINIMUM_SAMPLES or np.nanmean(v * u >= 0.0) < _ONE_WAY:
        return []
    return [Reading("v=#1,u=#2", both)]


def _several(table: Table, options: ReadOptions) -> Chosen:
    """No choice; raises RefusedError where a channel has several columns by name, which it says."""
    for channel, positions in candidates(table.names).items():
        if len(positions) > 1 and channel != "t":
            named = ", ".join(table.headers[i] or f"#{i + 1}" for i in positions[:_SHOWN])
            named += ", ..." if len(positions) > _SHOWN else ""
            found = f"{len(positions)} columns that may be {channel}: {named}"
            raise RefusedError(str(table.path), found, "one of them by --columns", _others(table, options))
    return Chosen({})


def unit_of(table: Table, mapping: Mapping, positions: list[int], constants: list[bool]) -> Unit:
    """The unit of a mapping: its own, else what the header of its one column says, in brackets or by its ending."""
    if mapping.unit is not None:
        return parse_unit(f"--columns, channel {mapping.channel}", mapping.channel, mapping.unit)
    moving = [i for i, constant in zip(positions, constants, strict=True) if not constant]
    if len(moving) != 1 or any(constants) or moving[0] < 0:
        return parse_unit("", mapping.channel, None)
    header = table.units.get(moving[0])
    means = meaning(table.names[moving[0]])
    if header is None and means is not None and means.channel == mapping.channel:
        header = means.unit or (TURNING.get(mapping.channel) if means.angle else None)
    where = f"{table.path}: column {'*'.join(table.names[i] or f'#{i + 1}' for i in positions)}"
    return parse_unit(where, mapping.channel, header)


def quoted_of(table: Table, mapping: Mapping, header: Unit | None = None) -> str:
    """A mapping's product as --columns takes it. header : its unit by the file, for a mapping that says none."""
    product = "*".join(table.quoted(table.position(name)) for name in mapping.names)
    factor = "" if mapping.factor == 1.0 else f"{mapping.factor:.9g}*"
    unit = mapping.unit if mapping.unit is not None or header is None or not header.text else header.text
    return factor + product + ("" if unit is None else f"[{unit}]")


_FEWEST_STEPS = 50
"""Whole numbers that a column goes through, from which they are a converter's, where its unit is no small one."""


def unscaled(table: Table, mappings: dict[str, Mapping], read: dict[str, tuple[FloatArray, Unit]]) -> list[str]:
    """A caution for each channel that takes a sensor's own steps for a unit: by name, unit, or since they are whole."""
    found = []
    for channel, unit in _SI.items():
        mapping = mappings.get(channel)
        if mapping is None or len(mapping.names) > 1 or mapping.factor != 1.0:
            continue
        position = table.position(mapping.names[0])
        values, told = read[channel]
        of_rate = channel == "v" and told.angular and float(np.nanmax(np.abs(values))) / told.factor > GYRO_COUNTS
        counts = (of_rate or told.factor == 1.0) and _whole_steps(values / told.factor)
        if position < 0 or not (counts or RAW.match(table.units.get(position, "m")) or _is_converted(table, position)):
            continue
        said, shown = table.quoted(position), told.text or unit
        turn = f", or {channel}={TURN_OF_4096}*{said}[rad] where 4096 are a turn" if channel == "x" else ""
        found.append(
            f"{channel} is read as if one step of {table.headers[position][:_LONG] or said} were 1 {shown}: where it "
            f"is a sensor's count, --columns gives its worth, as {channel}=0.001*{said}[{shown}]{turn}."
        )
    return found


def _whole_steps(values: FloatArray) -> bool:
    known = values[np.isfinite(values)]
    return bool(known.size and np.all(known == np.round(known)) and np.ptp(known) >= _FEWEST_STEPS)


def _is_converted(table: Table, position: int) -> bool:
    return position not in table.units and bool(CONVERTER.search(table.headers[position].replace("_", " ")))


def said(table: Table, mappings: dict[str, Mapping], units: dict[str, Unit], guessed: frozenset[str]) -> str | None:
    """What was guessed, in one sentence that ends with the --columns that says the same; None where nothing was."""
    if not guessed:
        return None
    parts, paste = [], []
    for channel in (c for c in CHANNELS if c in mappings):
        position = table.position(mappings[channel].names[0])
        unit = units[channel].text
        shown = unit or _SI.get(channel, "s")
        why = "" if unit or position in table.dated else " (no unit given)"
        if channel == "v" and mappings[channel].unit and position not in table.units:
            name = table.names[position]
            why = "" if unit_ending(name, channel) or not is_rate(name) else " (no unit given: by name and size)"
        paste.append(f"{channel}={table.quoted(position)}[{shown}]")
        if channel in guessed:
            parts.append(f"{channel} from {_header(table, position)} in {shown}{why}")
    return f'Read {", ".join(parts)}; to say otherwise: --columns "{",".join(paste)}".'


def _header(table: Table, position: int) -> str:
    return (table.headers[position][:_LONG] if position >= 0 else "") or table.quoted(position)


_SI = {"x": "m", "v": "m/s", "a": "m/s^2", "u": "N"}
_TURNS = {"x": "", "v": "/s", "a": "/s^2"}
"""Behind the unit of an angle."""


def as_angles(
    path: Path, read: dict[str, tuple[FloatArray, Unit]]
) -> tuple[dict[str, tuple[FloatArray, Unit]], str | None]:
    """What was read of something that turns, channels without a unit in that of an angle, and a sentence on that.

    Raises InputError where a unit is that of a length, and where numbers are neither radians nor degrees of a swing.
    """
    bare = [c for c, (_, unit) in read.items() if c in _TURNS and not unit.text]
    far = next((unit.text for c, (_, unit) in read.items() if c in _TURNS and unit.text and not unit.angular), None)
    if far is not None:
        accepted = 'an angle; what hangs at 0.4 m turns by x / 0.4: "x=COLUMN*2.5[rad]" in --columns'
        raise InputError("--restoring", f"pendulum, but {path} holds no angle ({far})", accepted)
    if not bare:
        return read, None
    x = read["x"][0] if "x" in bare else np.zeros(1)
    turn = "deg" if float(np.nanmax(x) - np.nanmin(x)) > 2.0 * np.pi else "rad"
    if turn == "deg" and not float(np.nanmin(x)) < 0.0 < float(np.nanmax(x)):
        found = f"no unit, and values from {np.nanmin(x):.6g} to {np.nanmax(x):.6g}"
        accepted = f'an angle, "x=COLUMN[deg]" in --columns, or counts of 4096 a turn, "x=COLUMN*{TURN_OF_4096}[rad]"'
        raise InputError(f"{path}: column x", found, accepted)
    units = {c: parse_unit("", c, turn + _TURNS[c]) for c in bare}
    turned = {c: (read[c][0] * unit.factor, unit) for c, unit in units.items()}
    return {**read, **turned}, f"Of a pendulum {', '.join(bare)} without a unit is read as an angle, in {turn}."


def products(table: Table, mappings: dict[str, Mapping]) -> dict[str, tuple[FloatArray, Unit]]:
    """The values of every channel in SI, those of t as they stand, and the unit they came in; the file is read once.

    Raises InputError where columns of one product are of several lengths, or a unit is none.
    """
    at = {name: table.position(name) for mapping in mappings.values() for name in mapping.names}
    positions = sorted(set(at.values()))
    columns = dict(zip(positions, table.columns(positions), strict=True))
    read = {}
    for channel, mapping in mappings.items():
        try:
            read[channel] = _product(table, mapping, at, columns)
        except TwofoldUnitError as error:
            bare = replace(mapping, unit=None)
            other = (_pasted(table, mappings, channel, f"{quoted_of(table, bare)}[{unit}]") for unit in error.meant)
            raise RefusedError(error.where, error.found, error.accepted, [*other]) from None
        except (NoUnitError, OtherUnitError) as error:
            if mapping.unit is not None:
                raise
            no_unit = channel == "t" or isinstance(error, NoUnitError)
            turns = channel == "u" and any(is_torque(table.names[table.position(name)]) for name in mapping.names)
            unit = f"{quoted_of(table, mapping)}[{'Nm' if turns else _SI.get(channel, 's')}]"
            found = error.found if no_unit else f"{error.found}, whose scale goes in place of 1"
            others = [_pasted(table, mappings, channel, unit if no_unit else f"1*{unit}")]
            raise RefusedError(error.where, found, error.accepted, others) from None
    return read


def _pasted(table: Table, mappings: dict[str, Mapping], channel: str, said: str) -> dict[str, Any]:
    """The options that read these channels, one of them as ``said``."""
    paste = {c: quoted_of(table, one) for c, one in mappings.items()} | {channel: said}
    return {"columns": ",".join(f"{c}={one}" for c, one in paste.items())}


def _product(
    table: Table, mapping: Mapping, at: dict[str, int], read: dict[int, FloatArray]
) -> tuple[FloatArray, Unit]:
    positions = [at[name] for name in mapping.names]
    columns = [read[i] for i in positions]
    constants = [column.size == 1 for column in columns]
    unit = unit_of(table, mapping, positions, constants)
    factor = mapping.factor * (1.0 if mapping.channel == "t" else unit.factor)
    values = np.cumsum(columns[0]) if mapping.channel == "t" and unit.angular else columns[0]
    with np.errstate(over="ignore", invalid="ignore"):  # what becomes of it is looked at when the rows are checked
        for column in columns[1:]:
            if column.size not in (1, values.size) and values.size != 1:
                found = f"columns of {values.size} and {column.size} values"
                where = f"{table.path}: channel {mapping.channel}"
                raise InputError(where, found, "columns of one length")
            values = values * column
        return (values if factor == 1.0 else values * factor), unit
