"""What a sweep shows of solver effort: settings as people train policies with, against what ships."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from harness.fidelity.kind import Row, kind, release
from harness.fidelity.matrix import TRAINED
from harness.fidelity.scores import distance, figures_of
from harness.show import blocks as b
from harness.show.numbers import engine_name, number
from harness.show.plots import axes, plain

_CREEPS = (1e-6, 1e-5, 1e-4, 1e-3)
"""m/s at which the colour changes; the second is rest for people."""
_SHARES = (1e-4, 2e-3, 1e-2, 5e-2)
_ALIKE, _FLOOR = 1.1, 1e-6
"""As good as full effort: no figure that many times as large. m/s and shares below which none counts."""
_LINE = 3
"""Efforts that a line needs."""
_COLORS = ("#2b7fd6", "#e4632d", "#1f9e77", "#a45bc2", "#b58900", "#777777")
_FULL = (100, 50)
COMMON = (4, 8)
"""With which policies are often trained."""
_SHOWN = ("creep_m_s", "rest_error_m", "zeta_rel_error")
"""Metrics that a section has."""
_LEFT = ("iterations", "ls_iterations", "solimpfriction", "solreffriction", "integrator")


@dataclass(slots=True)
class Effort:
    """A set of settings. rest, slid : creep from rest, and the largest after a slide, m/s. decay : of the free decay.

    worst : the largest distance from exact, and the label of its figure.

    steps_per_s : the most of its rows. recommended : the least iterations that are as good as full effort.
    """

    row: Row
    rest: float | None = None
    slid: float | None = None
    decay: Row | None = None
    errors: list[str] = field(default_factory=list)
    worst: tuple[float, str] = (0.0, "")
    steps_per_s: float = 0.0
    recommended: bool = False

    def add(self, row: Row) -> None:
        if row["error"] is not None:
            self.errors.append(f"{row['scenario']}: {row['error']}")
            return
        self.steps_per_s = max(self.steps_per_s, row["steps_per_s"] or 0.0)
        shown = (figure for figure in figures_of(row["scenario"]) if figure.metric in _SHOWN)
        far = ((distance(row, figure), figure.label) for figure in shown)
        self.worst = max((self.worst, *((value, label) for value, label in far if value is not None)))
        creep = row["metrics"].get("creep_m_s")
        if row["scenario"] == "free-decay":
            self.decay = row
        elif kind(row["scenario"]).part == "suite":
            self.rest = creep
        else:
            self.slid = max(self.slid or 0.0, abs(creep))

    @property
    def effort(self) -> tuple[int, int]:
        changed = self.row["changed"]
        return int(changed.get("iterations", _FULL[0])), int(changed.get("ls_iterations", _FULL[1]))

    @property
    def others(self) -> str:
        """Settings beside the effort, in words."""
        row = self.row
        said = [row["integrator"]] + [f"{n} {v:g}" if isinstance(v, float) else f"{n} {v}"
                                      for n, v in row["changed"].items() if n not in _LEFT]  # fmt: skip
        return ", ".join(said)

    def off(self, metric: str) -> float | None:
        """A share by which the free decay is off; a length over the release."""
        value = None if self.decay is None else self.decay["metrics"].get(metric)
        return value if value is None or self.decay is None or metric[-2:] != "_m" else value / release(self.decay)

    @property
    def figures(self) -> list[float]:
        """Creeps in m/s, and how far the decay is off: its place of rest over the release, zeta."""
        found = (self.rest, self.slid, self.off("rest_error_m"), self.off("zeta_rel_error"))
        return [float("inf") if value is None else abs(value) for value in found]


def efforts(rows: Sequence[Row]) -> list[Effort]:
    """Those of a sweep in its order, with the recommended ones found."""
    found: dict[tuple[Any, ...], Effort] = {}
    for row in rows:
        if row["preset"] == TRAINED:
            key = (row["engine"], row["version"], row["environment"], row["route"], repr(row["changed"]), row["dt_s"])
            found.setdefault(key, Effort(row)).add(row)
    every = list(found.values())
    groups: dict[tuple[Any, ...], list[Effort]] = {}
    for one in every:
        where = (one.row["engine"], one.row["version"], one.row["environment"], one.row["route"], one.row["dt_s"])
        groups.setdefault((*where, one.others), []).append(one)
    for group in groups.values():
        full = next((one for one in group if one.effort == _FULL), None)
        # a search that happened to converge here is none to rely on
        searched = [one for one in group if one.effort[1] >= _FULL[1]]
        if full is not None and len(searched) > 1:
            alike = (one for one in searched if _as_good(one, full))
            min(alike, key=lambda one: one.effort).recommended = True
    return every


def _as_good(one: Effort, full: Effort) -> bool:
    return all(own <= _ALIKE * most + _FLOOR for own, most in zip(one.figures, full.figures, strict=True))


def effort_section(every: Sequence[Effort], name: Callable[[str, str], str]) -> list[b.Section]:
    """The section of a page; none where a sweep has no such rows. name : of an engine, by its name and version."""
    if not every:
        return []

    def creep(of: str) -> Callable[[Effort], b.Cell]:
        def cell(one: Effort) -> b.Cell:
            value = getattr(one, of)
            return b.Cell(number(None if value is None else value * 1e6, 3), grade=b.grade(value, _CREEPS))

        return cell

    def decay(metric: str) -> Callable[[Effort], b.Cell]:
        def cell(one: Effort) -> b.Cell:
            share = one.off(metric)
            return b.Cell(number(None if share is None else 100.0 * share, 2), grade=b.grade(share, _SHARES))

        return cell

    columns = [
        b.Column("from rest", creep("rest"), "µm/s", "creep at half of break-away, held from rest"),
        b.Column("after a slide", creep("slid"), "µm/s", "the same after sliding to a stop, the worst of three speeds"),
        b.Column("rest", decay("rest_error_m"), "%", "free decay: place of rest off, over the release"),
        b.Column("zeta", decay("zeta_rel_error"), "%", "free decay: damping ratio as estimated, off"),
        b.Column("x_k", decay("x_k_rel_error"), "%", "free decay: friction as estimated, off"),
        b.Column("steps", lambda one: number(one.steps_per_s / 1e3 or None, 3), "1000/s", "measured"),
    ]

    def head(one: Effort) -> str:
        iterations, search = one.effort
        star = ", recommended" if one.recommended else ""
        return f"{name(one.row['engine'], one.row['version'])} {one.row['route']} {iterations}/{search}{star}"

    caption = (
        "iterations/ls_iterations: 100/50 ships, 4/8 and 1/4 are what policies are often trained with. The joint's"
        " friction is as stiff as its step allows. Recommended is the least that is as good as 100/50 in every figure;"
        " joints that move one another want an iteration each and one more."
    )
    notes = [f"{head(one)}: {text}" for one in every for text in one.errors]
    table = b.tabulated("effort", columns, every, head, lambda one: one.others, caption=caption, footnotes=notes)
    told = {head(one).partition(",")[0] + f", {one.others}": _told(one) for one in every if one.recommended}
    folded = b.Folded(f"All {len(every)} settings", [table])
    blocks: list[b.Block] = [b.Text(_said(every)), b.Facts(told, said=True), *_figures(every, name), folded]
    return [b.Section("As people train", blocks)]


def _told(one: Effort) -> str:
    """What is recommended, what it does, and at what cost."""
    rest, slid = (number(None if value is None else value * 1e6, 3) for value in (one.rest, one.slid))
    rests, zeta = (number(_percent(one.off(metric)), 2) for metric in _SHOWN[1:])
    speed = number(one.steps_per_s / 1e3, 3)
    return (
        f"Recommended: creep of {rest} µm/s from rest and {slid} µm/s after a slide, rest off by {rests} %,"
        f" zeta by {zeta} %, at {speed} thousand steps a second."
    )


def _figures(every: Sequence[Effort], name: Callable[[str, str], str]) -> list[b.Figure]:
    """Creep, rest and decrement against effort, a line for settings that differ in effort alone."""
    groups: dict[str, list[Effort]] = {}
    for one in sorted(every, key=lambda one: one.effort[::-1]):
        groups.setdefault(f"{name(one.row['engine'], one.row['version'])} {one.row['route']}, {one.others}", []).append(
            one
        )
    shown = {what: own for what, own in groups.items() if len(own) >= _LINE}
    order = list(dict.fromkeys(one.effort for one in sorted(every, key=lambda one: one.effort[::-1])))
    drawn: tuple[tuple[str, str, Callable[[Effort], float | None], str], ...] = (
        ("creep", "creep after a slide / (µm/s)", lambda one: one.slid and 1e6 * one.slid, "Half of break-away."),
        ("rest", "rest off / %", lambda one: _percent(one.off("rest_error_m")), "Free decay, over the release."),
        ("decrement", "zeta off / %", lambda one: _percent(one.off("zeta_rel_error")), "Free decay, as estimated."),
    )
    figures = []
    for what, axis, of, caption in drawn:
        traces = []
        for place, (group, own) in enumerate(shown.items()):
            x, y = [f"{one.effort[0]}/{one.effort[1]}" for one in own], [of(one) for one in own]
            marks = ["star" if one.recommended else "circle" for one in own]
            marker = {"symbol": marks, "size": [13 if one.recommended else 7 for one in own]}
            line = {"color": _COLORS[place % len(_COLORS)], "dash": ("solid", "dot")[place // len(_COLORS) % 2]}
            traces.append(plain(group, x, y, "ink", mode="lines+markers", marker=marker, line=line))
        layout = axes("iterations/ls_iterations", axis, margin={"l": 70, "r": 16, "t": 64, "b": 44})
        layout["xaxis"] |= {"type": "category", "categoryarray": [f"{first}/{last}" for first, last in order]}
        layout["yaxis"] |= {"type": "log", "exponentformat": "power", "dtick": 1}
        said = f"{caption} A star is what is recommended."
        figures += [b.Figure(f"effort-{what}", traces, layout, said, height=330)] if traces else []
    return figures


def _percent(share: float | None) -> float | None:
    return None if share is None else 100.0 * abs(share)


def _said(every: Sequence[Effort]) -> str:
    """What a cut search costs, and what mends it, of the first engine that shows it."""
    right = next((one for one in every if one.recommended), None)
    if right is None:
        return "No setting was run beside full effort."
    own = (right.row["engine"], right.row["route"], right.others)
    beside = [one for one in every if (one.row["engine"], one.row["route"], one.others) == own]
    cut = next((one for one in beside if one.effort == (4, 8)), None)
    text = "The line search decides, not the iterations: a hold from rest can miss it, one that slid first does not."
    if cut is not None and cut.slid is not None and right.slid is not None:
        engine, slid, mended = engine_name(right.row["engine"]), *(number(1e6 * y, 3) for y in (cut.slid, right.slid))
        effort = "/".join(map(str, right.effort))
        text += f" {engine} with 4/8 creeps at {slid} µm/s after a slide, with {effort} at {mended} µm/s."
    return text
