"""The matrix a sweep's page begins with: how far each engine is from exact, as shipped and tuned, in one scale."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import groupby

from harness.fidelity.kind import Row, kind
from harness.fidelity.scores import COLUMNS, Card, distance, figures_of
from harness.show import blocks as b
from harness.show.numbers import engine_name, number
from harness.show.report.effort import COMMON, Effort
from harness.show.sentences import percent

STEPS = (1e-4, 2e-3, 1e-2, 5e-2)
"""Relative distances from exact at which the colour changes."""
_CONTACT, _TRAINED = "contact", "as people train"
_OF = {"free": "free decay", "hold": "hold", "belt": "belt", "harmonic": "harmonic"}
"""Columns of the joint's scenarios, by how their names begin."""
GROUPS = {
    **{column: column for column in _OF.values()},
    _CONTACT: "a box on a floor, and bodies with six freedoms: slopes, grips, what rolls and spins",
    _TRAINED: "few iterations of the solver: 4/8, often trained with, and in the second row what is recommended",
}
"""Columns, and what they mean. On a phone a long word is parted."""
_PRESETS = ("as-shipped", "tuned")
_SHORT = {"harmonic": "har\u00admonic", _CONTACT: "con\u00adtact"}
_CAPTION = "The largest distance from the exact answer, relative, and the figure that has it; a dash for none."
_EFFORT = " As people train: 4/8 iterations of solver and line search, and, as tuned, those that are recommended."
_LEAST, _MOST = 1e-4, 10.0
"""Shares beyond which a figure is not told."""


@dataclass(slots=True)
class Glance:
    """An engine as shipped, or tuned. worst : by column, the largest distance from exact and its figure's label."""

    card: Card
    worst: dict[str, tuple[float, str]] = field(default_factory=dict)

    @property
    def key(self) -> tuple[str, str, str]:
        return self.card.engine, self.card.version, self.card.environment

    def add(self, column: str | None, value: float | None, label: str) -> None:
        """Keep it where it is the worst of its column."""
        if column is not None and value is not None and value >= self.worst.get(column, (-1.0, ""))[0]:
            self.worst[column] = (value, label)

    @property
    def most(self) -> tuple[float, str]:
        """The worst of all columns but that of effort, with the label and the column."""
        found = ((value, f"{label}, {column}") for column, (value, label) in self.worst.items() if column != _TRAINED)
        return max(found, default=(0.0, ""))


def glances(rows: Sequence[Row], scored: Sequence[Card], efforts: Sequence[Effort]) -> list[Glance]:
    """Every engine as shipped and tuned, in the order of the scorecard."""
    lines: dict[tuple[str, ...], Glance] = {}
    for card in sorted(scored, key=lambda one: (one.engine, one.version, one.environment, one.preset)):
        line = lines.setdefault((card.engine, card.version, card.environment, card.preset), Glance(card))
        for scenario, figure in COLUMNS:
            column = _CONTACT if card.route == "contact" else _OF.get(scenario.partition("-")[0])
            line.add(column if card.route != "law" else None, card.values.get(figure.label), figure.label)
    for row in rows:
        bodies = kind(row["scenario"]).part == "bodies" and row["error"] is None and not row["changed"]
        found = lines.get((row["engine"], row["version"], row["environment"], row["preset"]))
        for figure in figures_of(row["scenario"]) if bodies and found is not None else ():
            found.add(_CONTACT, distance(row, figure), row["scenario"])  # type: ignore[union-attr]
    for one in efforts:
        wanted = "tuned" if one.recommended else "as-shipped" if one.effort == COMMON else ""
        found = lines.get((one.row["engine"], one.row["version"], one.row["environment"], wanted))
        if found is not None:
            found.add(_TRAINED, one.worst[0], f"{one.effort[0]}/{one.effort[1]}: {one.worst[1]}")
    return list(lines.values())


def glance_section(
    found: Sequence[Glance], name: Callable[[str, str], str], color: Callable[[str, str], str]
) -> b.Section:
    """The section. name, color : of an engine, by its name and version."""
    columns = [
        b.Column(_SHORT.get(one, one), b.by(one, _cell), "%", hint)
        for one, hint in GROUPS.items()
        if any(one in line.worst for line in found)
    ]
    table = b.tabulated(
        "engine",
        columns,
        found,
        lambda line: _named(line, name),
        lambda line: f"{line.card.version}, {line.card.preset.replace('-', ' ')}",
        lambda line: color(line.card.engine, line.card.version),
        caption=_CAPTION + _EFFORT * any(_TRAINED in line.worst for line in found),
        compact=True,
    )
    scale = ("below 0.01 %", "to 0.2 %", "to 1 %", "to 5 %", "more")
    said = dict(_sentences(found, name))
    blocks: list[b.Block] = [b.Text(_headline(found), "verdict"), b.Legend(scale), table]
    return b.Section("Every engine at a glance", [*blocks, b.Facts(said, said=True)])


def _named(line: Glance, name: Callable[[str, str], str]) -> str:
    """As its makers write it, with the environment where there are two of an engine."""
    engine = line.card.engine
    return engine_name(engine) + name(engine, line.card.version).removeprefix(engine)


def _cell(line: Glance, column: str) -> b.Cell | None:
    if column not in line.worst:
        return None
    value, label = line.worst[column]
    text = "<0.01" if value < _LEAST else ">1000" if value > _MOST else number(100.0 * value, 2)
    return b.Cell(text, (label,), b.grade(value, STEPS))


def _share(value: float) -> str:
    return "over 1000 %" if value > _MOST else percent(value)


def _headline(found: Sequence[Glance]) -> str:
    shipped, tuned = ([one.most[0] for one in found if one.card.preset == preset and one.worst] for preset in _PRESETS)
    said = [f"as shipped, every engine has a figure that is off by {_share(min(shipped))} or more"] if shipped else []
    said += [f"tuned, none has one that is off by more than {_share(max(tuned))}"] if tuned else []
    text = "; ".join(said) or "no row of a joint or a contact was run"
    return f"{text[0].upper()}{text[1:]}."


def _sentences(found: Sequence[Glance], name: Callable[[str, str], str]) -> Iterator[tuple[str, str]]:
    """One an engine."""
    for key, group in groupby(found, lambda one: one.key):
        lines = {one.card.preset: one for one in group}
        said = []
        for preset, line in lines.items():
            value, label = line.most
            said += [f"{preset.replace('-', ' ')} off by {_share(value)} at worst ({label})"] if label else []
        for value, label in (line.worst[_TRAINED] for line in lines.values() if _TRAINED in line.worst):
            effort, _, figure = label.partition(": ")
            said.append(f"with {effort} iterations by {_share(value)} ({figure})")
        text = "; ".join(said) or "no joint and no contact was run"
        yield f"{_named(next(iter(lines.values())), name)} {key[1]}", f"{text[0].upper()}{text[1:]}."
