"""Which columns of a table are which field of which joint: as --columns says, else by their names."""

from collections.abc import Container
from dataclasses import dataclass

from harness.core.errors import InputError
from harness.io.columns import Mapping, parse_columns
from harness.io.guess import meaning, quoted
from harness.io.logs.rules import CHANNEL, WORDS, Field, Named, named
from harness.io.table import Table

ACCEPTED = (
    "t and NAME.position, NAME.velocity, NAME.effort or NAME.current as a product of column names, #N and numbers is "
    'accepted, e.g. "t=t,elbow.position=q3[deg],elbow.effort=7.1*cur3[N*m]"'
)
_FIELDS: tuple[Field, ...] = ("position", "velocity", "effort", "current")


@dataclass(frozen=True, slots=True)
class Target:
    """A field of a joint and the product of columns that gives it; ``headers`` as they stand in the file."""

    field: Field
    joint: str
    mapping: Mapping
    header: str


class _Targets(Container[str]):
    """Every name that --columns may give: t, and NAME.position and so on."""

    def __contains__(self, name: object) -> bool:
        joint, _, kind = str(name).rpartition(".")
        return name == "t" or (bool(joint) and kind in _FIELDS)


def by_option(text: str) -> tuple[list[Target], Mapping | None]:
    """What --columns names, and the time. Raises InputError for anything else than it takes."""
    found, targets = parse_columns(text, _Targets(), ACCEPTED), []
    for name, mapping in found.items():
        joint, _, kind = name.rpartition(".")
        if joint:
            field = next(field for field in _FIELDS if field == kind)
            product = Mapping(CHANNEL[field], mapping.names, mapping.factor, mapping.unit)
            targets.append(Target(field, joint, product, "*".join(mapping.names)))
    return targets, found.get("t")


def by_name(table: Table) -> tuple[list[Target], bool]:
    """The targets that names of columns say, and whether joints are numbered, in the model's order.

    Raises InputError where two columns may be the same.
    """
    said = {i: found for i, name in enumerate(table.names) if (found := named(name)) is not None}
    styles = {found.style for found in said.values() if found.field == "position"}
    style = next((style for style in ("named", "numbered", "single") if style in styles), "")
    base = min((found.number for found in said.values() if found.style == style == "numbered"), default=0)
    taken: dict[tuple[Field, str], tuple[int, Named]] = {}
    for i, found in said.items():
        if found.style != style:
            continue
        joint = found.joint if style == "named" else f"joint{found.number - base + 1}"
        other = taken.setdefault((found.field, joint), (i, found))
        if other[0] != i:
            _settle(table, taken, (found.field, joint), (i, found))
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
    return targets, style != "named"


def _settle(
    table: Table, taken: dict[tuple[Field, str], tuple[int, Named]], key: tuple[Field, str], second: tuple[int, Named]
) -> None:
    """Of two columns for one field of a joint, the one whose word stands first in the table of words."""
    first, order = taken[key], WORDS[key[0]]
    if first[1].word == second[1].word:
        names = ", ".join(quoted(table.headers[i], i) for i, _ in (first, second))
        accepted = f'one of them by --columns "{key[1]}.{key[0]}=..." is accepted'
        raise InputError(str(table.path), f"two columns that may be {key[1]}.{key[0]}: {names}", accepted)
    taken[key] = min(first, second, key=lambda one: order.index(one[1].word))


def time_of(table: Table) -> tuple[Mapping | None, str | None]:
    """The column of times, and a sentence where others may be it as well; header stamps go before receive times."""
    found = []
    for i, name in enumerate(table.names):
        means = meaning(name.lstrip("_% "))
        if means is not None and means.channel == "t":
            found.append((i, name, means.unit))
    if not found:
        return None, None
    position, name, unit = min(found, key=lambda one: (one[1] != "t", "stamp" not in one[1].lower(), one[0]))
    others = ", ".join(table.headers[i] for i, _, _ in found if i != position)
    note = f"Time is read from {table.headers[position]}, not from {others}." if others else None
    return Mapping("t", (f"#{position + 1}",), 1.0, None if position in table.units else unit), note
