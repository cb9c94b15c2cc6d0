"""A log from the columns of a table."""

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.apart import Found
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.io.choose import products
from harness.io.columns import Mapping, Meaning, meaning, parse_columns, quoted, word_of
from harness.io.logs.raw import CHANNEL, FIELD_OF, SI_UNITS, WORDS, Field, Fields, LogOptions, Named, Raw, named
from harness.io.registry import formats, kind_of, reader_for
from harness.io.table import Table
from harness.io.times import since_first, whole_numbers
from harness.io.units import Unit

ACCEPTED = (
    "t and NAME.position, NAME.velocity, NAME.effort or NAME.current as a product of column names, #N and numbers, "
    'such as "t=t,elbow.position=q3[deg],elbow.effort=7.1*cur3[N*m]"'
)
_FIELDS: tuple[Field, ...] = ("position", "velocity", "effort", "current", "goal", "voltage", "driven", "temperature")


@dataclass(frozen=True, slots=True)
class Target:
    """A field of a joint and the product of columns that gives it; ``headers`` as they stand in the file."""

    field: Field
    joint: str
    mapping: Mapping
    header: str


def by_option(text: str) -> tuple[list[Target], Mapping | None]:
    """What --columns names, and the time. Raises InputError for anything else than it takes."""
    targets, t = [], None
    for name, mapping in parse_columns(text, _is_target, ACCEPTED).items():
        joint, _, kind = name.rpartition(".")
        if joint:
            field = FIELD_OF[kind]
            targets.append(Target(field, joint, replace(mapping, channel=CHANNEL[field]), "*".join(mapping.names)))
        else:
            t = mapping
    return targets, t


def _is_target(name: str) -> bool:
    """Whether --columns may give this: t, and NAME.position and so on."""
    joint, _, kind = name.rpartition(".")
    return name == "t" or (bool(joint) and kind in _FIELDS)


_NAME = re.compile(r"^(?:.*[./])?names?[\[_.]?(?P<number>\d{1,3})\]?$", re.IGNORECASE)
"""A column that says what a joint is called: field.name3, of a message written to a table."""


def _called(table: Table) -> dict[int, str]:
    """What columns say that numbered joints are called, by their numbers; nothing where rows differ."""
    numbers = {i: int(found["number"]) for i, name in enumerate(table.names) if (found := _NAME.match(name.strip()))}
    names = dict(zip(numbers.values(), table.texts(list(numbers)), strict=True)) if numbers else {}
    return names if all(names.values()) and len({*names.values()}) == len(names) else {}


def by_name(table: Table) -> tuple[list[Target], bool]:
    """The targets that names of columns say, and whether joints are numbered, in the model's order.

    Raises InputError where two columns may be the same.
    """
    said = {i: found for i, name in enumerate(table.names) if (found := named(name)) is not None}
    styles = {found.style for found in said.values() if found.field == "position"}
    style = next((style for style in ("named", "numbered", "single") if style in styles), "")
    said = {i: found for i, found in said.items() if found.style == style}
    base = min((found.number for found in said.values()), default=0)
    called = _called(table) if style == "numbered" else {}
    # what stands before a name is part of it where names are not told apart without it: left/elbow, right/elbow
    paths = {found.path for found in said.values()}
    whole = len({found.joint for found in said.values()}) < len(paths)
    taken: dict[tuple[Field, str], tuple[int, Named]] = {}
    for i, found in said.items():
        joint = (found.path if whole else found.joint) if style == "named" else called.get(found.number, "")
        joint = joint or f"joint{found.number - base + 1}"
        first = taken.setdefault((found.field, joint), (i, found))
        if first[0] != i and first[1].word == found.word:
            names = ", ".join(quoted(table.headers[at], at) for at in (first[0], i))
            accepted = f'one of them by --columns "{joint}.{found.field}=..."'
            raise InputError(str(table.path), f"two columns that may be {joint}.{found.field}: {names}", accepted)
        taken[found.field, joint] = min(first, (i, found), key=lambda one: WORDS[one[1].field].index(one[1].word))
    ordered = sorted(taken.items(), key=lambda item: (list(WORDS).index(item[0][0]), item[1][1].number, item[1][0]))
    targets = [
        Target(
            field,
            joint,
            Mapping(CHANNEL[field], (f"#{i + 1}",), 1.0, None if i in table.units else found.unit),
            table.headers[i],
        )
        for (field, joint), (i, found) in ordered
    ]
    return targets, style != "named" and not called


def time_of(table: Table) -> tuple[Mapping | None, str | None]:
    """The column of times, and a sentence where others may be it as well; header stamps go before receive times."""
    found = []
    for i, name in enumerate(table.names):
        means = meaning(name.lstrip("_% ")) or (
            Meaning("t") if name.strip().isalpha() and word_of(name) == "t" else None
        )
        if means is not None and means.channel == "t":
            found.append((i, name, means.unit))
    if not found:
        return None, None
    position, name, unit = min(found, key=lambda one: (one[1] != "t", "stamp" not in one[1].lower(), one[0]))
    others = ", ".join(table.headers[i] for i, _, _ in found if i != position)
    note = f"Time is read from {table.headers[position]}, not from {others}." if others else None
    return Mapping("t", (f"#{position + 1}",), 1.0, None if position in table.units else unit), note


_REST = "rest of t"
_SECONDS = re.compile(r"(?:^|[._/]|zeit|time)(?P<sec>secs?)$", re.IGNORECASE)


def _nanoseconds_beside(table: Table, clock: Mapping | None) -> Mapping | None:
    """The column of nanoseconds beside one of whole seconds, as a message's header has them; None where none is."""
    name = table.names[table.position(clock.names[0])] if clock is not None and len(clock.names) == 1 else ""
    found = _SECONDS.search(name)
    front = name[: found.start("sec")].lower() if found else ""
    ends = [front + one for one in ("nanosec", "nsecs", "nsec")] if found else []
    at = next((i for i, other in enumerate(table.names) if other.lower() in ends), None)
    return None if at is None else Mapping("t", (f"#{at + 1}",))


NO_POSITION = "no joint's position"
"""What is wrong with a table whose columns name none."""
MIXED = "the units of their headers"
"""Where columns of one field came in several units."""
NEEDED = "columns t and NAME.position, NAME.velocity, NAME.effort (or position[0], x1_rad, actual_q_0, q1)"


def columns_of(path: Path, options: dict[str, Any]) -> Found:
    """What ``raw_of_file`` finds, as a process of its own hands it on."""
    return raw_of_file(path, LogOptions(**options)).found()


def raw_of_file(path: Path, options: LogOptions) -> Raw:
    """The log in a file of any format of tables. Raises InputError for what cannot be read as one."""
    kind = kind_of(path)
    reader = reader_for(path)
    if reader is None:
        accepted = f"{formats()}, ROS bags (.bag, .db3, .mcap, a folder) and LeRobot data sets"
        raise InputError(str(path), f"the format {kind or 'without a name'}", accepted)
    return raw_of(reader.open(path, options.skip_rows) if reader.text else reader.open(path), options)


def raw_of(table: Table, options: LogOptions) -> Raw:
    """The log that the columns of a table make. Raises InputError where they make none."""
    clock, note = time_of(table)
    if options.columns is None:
        targets, numbered = by_name(table)
        if options.rate is not None and clock is not None:
            accepted = "one of the two (--columns without t leaves the column out)"
            raise InputError("--rate", f"given although a column of {table.path} gives the time", accepted)
    else:
        targets, said = by_option(options.columns)
        clock, note = (clock if said is None and options.rate is None else said), None
        numbered = False
    if not any(target.field == "position" for target in targets):
        found = f"{NO_POSITION} among the columns {table.listed()}"
        raise InputError(str(table.path), found, f'{NEEDED}, or --columns "t=...,NAME.position=..."')
    if clock is None and options.rate is None:
        found = f"no time among the columns {table.listed()}"
        raise InputError(str(table.path), found, "--rate HZ, or a column t")
    asked = {str(i): _with_unit(table, target, options) for i, target in enumerate(targets)}
    if clock is not None:
        asked["t"] = clock
    rest = _nanoseconds_beside(table, clock)
    if rest is not None:
        asked[_REST], note = rest, None
    read = products(table, asked)
    if rest is not None:
        (seconds, unit), (nanoseconds, _) = read["t"], read.pop(_REST)
        read["t"] = seconds - seconds[0] + 1e-9 * nanoseconds, unit
    sizes = {values.size for values, _ in read.values()}
    if len(sizes) > 1:
        found = f"columns of {min(sizes)} to {max(sizes)} values"
        raise InputError(str(table.path), found, "columns of one length")
    t, notes = _times(read.get("t"), sizes.pop(), options.rate)
    fields: Fields = {}
    told: dict[str, str] = {}
    for i, target in enumerate(targets):
        values, unit = read[str(i)]
        fields.setdefault(target.field, {})[target.joint] = values
        told[target.field] = unit.text if told.get(target.field, unit.text) == unit.text else MIXED
    notes = [*([] if note is None else [note]), *notes]
    if options.columns is None:
        notes.insert(0, _said(targets, told))
    return Raw(t, fields, {k: v for k, v in told.items() if v not in ("", MIXED)}, "row", numbered, tuple(notes))


def _with_unit(table: Table, target: Target, options: LogOptions) -> Mapping:
    """The product of a target, with the unit that --angle-unit gives where nothing else does."""
    mapping, unit = target.mapping, options.angle_unit
    told = mapping.unit is not None or any(table.position(name) in table.units for name in mapping.names)
    if told or unit is None or target.field not in ("position", "velocity", "goal"):
        return mapping
    return replace(mapping, unit=f"{unit}/s" if target.field == "velocity" else unit)


def _times(read: tuple[FloatArray, Unit] | None, size: int, rate: float | None) -> tuple[FloatArray, list[str]]:
    """Times in s, and what is said of them."""
    if read is None:
        assert rate is not None
        return np.arange(size) / rate, []
    stamps, unit = read
    with np.errstate(over="ignore", invalid="ignore"):  # whether it is finite is looked at with the rows
        t, counted = since_first(stamps, unit)
    return t, [note for note in (counted, whole_numbers(t, unit)) if note]


def _said(targets: list[Target], told: dict[str, str]) -> str:
    """Which columns were read as what, in one sentence."""
    parts = []
    for field in dict.fromkeys(target.field for target in targets):
        headers = [target.header for target in targets if target.field == field]
        span = headers[0] if len(headers) == 1 else f"{headers[0]} to {headers[-1]}"
        unit = told[field].replace("*", " ") or f"{SI_UNITS[field]} (no unit given)"
        parts.append(f"{span} as {_CALLED.get(field, field)} in {unit}")
    return f"Read {', '.join(parts)}."


_CALLED: dict[Field, str] = {"magnitude": "effort without its sign"}
