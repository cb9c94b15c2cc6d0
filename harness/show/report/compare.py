"""The page of two traces: what differs, where, and whether each agrees with itself."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any, ClassVar

import numpy as np

from harness.core.arrays import FloatArray
from harness.show.decimate import keep
from harness.show.report.curves import POINTS
from harness.show.report.figure import Figure
from harness.show.report.identify import ANGLES, CHANNELS
from harness.show.report.motion import GROUP
from harness.show.report.numbers import NONE, number, sentence_quantity
from harness.show.report.section import Section
from harness.show.report.sources import MadeWith
from harness.show.report.table import Cell, Column, Row, Table
from harness.show.report.verdict import Verdict

_SIM = "#e4632d"
_SHADE = "rgba(228, 99, 45, 0.12)"
_MOST_SHADES = 80


def compare_title(result: Mapping[str, Any]) -> tuple[str, str]:
    """Title and subtitle."""
    sim, real = (PurePath(file).name for file in result["files"])
    return f"{sim} against {real}", f"shift {sentence_quantity(result['aligned']['shift_s'])}"


def compare_sections(
    t: FloatArray,
    shown: Mapping[str, tuple[FloatArray, FloatArray]],
    noise: Mapping[str, float],
    angular: bool,
    result: Mapping[str, Any],
) -> list[Section]:
    """Sections of a comparison.

    t : shared times (n,), s. shown : (sim, real) of each channel, (n,). noise : of the difference, SI units.
    result : CompareResult.model_dump(by_alias=True).
    """
    return [
        Verdict(compare_headline(result), result["sentences"]),
        Places(result),
        Overlay(t, shown, noise, angular, result["where"]),
        MadeWith(result["machine"], result["outputs"], result["command"]),
    ]


def compare_headline(result: Mapping[str, Any]) -> str:
    """The verdict, and the place that holds most."""
    if result["verdict"] != "different":
        return "The two traces are the same within noise."
    first = result["where"][0]
    share = "" if first["share"] is None else f", which holds {100.0 * first['share']:.0f} % of the mismatch"
    return f"The two traces differ, most clearly at {first['condition']}{share}."


@dataclass(frozen=True)
class Places(Section):
    """Where they part, and whether the channels of each trace agree with one another."""

    template: ClassVar[str] = "table.html.j2"
    result: Mapping[str, Any]

    @property
    def title(self) -> str:
        """The heading."""
        return "Where they part"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        tables = []
        rows = [
            Row(
                one["condition"],
                [
                    Cell(one["regime"]),
                    Cell(NONE if one["share"] is None else f"{100.0 * one['share']:.0f}"),
                    Cell(str(len(one["time_s"]))),
                    Cell(number(sum(b - a for a, b in one["time_s"]))),
                ],
            )
            for one in self.result["where"]
        ]
        if rows:
            hint = "of the mean square mismatch above noise"
            columns = [Column("regime"), Column("share", "%", hint), Column("spans"), Column("together", "s")]
            tables.append(Table("condition", columns, rows))
        pairs = [
            Row(
                f"{name}: {pair.replace('-', ' and ')}",
                [Cell(sentence_quantity(found[key])) for key in ("gain", "lag_s", "offset")]
                + [Cell("yes" if found["consistent"] else "no", [found["sentence"]])],
            )
            for name, members in self.result["consistent_channels"].items()
            for pair, found in members.items()
        ]
        if pairs:
            columns = [Column("gain"), Column("lag"), Column("offset"), Column("agree")]
            caption = "What one channel of a trace says of another, from the data alone, with one standard error."
            tables.append(Table("channels", columns, pairs, caption))
        return {"tables": tables}


@dataclass(frozen=True)
class Overlay(Section):
    """Both traces, and their difference in units of the noise, with the places shaded."""

    template: ClassVar[str] = "motion.html.j2"
    t: FloatArray
    shown: Mapping[str, tuple[FloatArray, FloatArray]]
    noise: Mapping[str, float]
    angular: bool
    where: Sequence[Mapping[str, Any]]

    @property
    def title(self) -> str:
        """The heading."""
        return "The two traces"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        figures = []
        shades = self._shades()
        budget = POINTS // (4 * len(self.shown))
        for channel, (sim, real) in self.shown.items():
            name, unit, factor = (ANGLES if self.angular else CHANNELS)[channel]
            chosen = keep(self.t, (real, real - sim), np.empty(0), budget)
            t = self.t[chosen]
            layout = {"xaxis": {"title": {"text": "time / s"}}, "hovermode": "closest", "shapes": shades}
            figures.append(
                Figure(
                    f"compare-{channel}",
                    [
                        _line("real", t, real[chosen] * factor, "ink", unit),
                        _line("sim", t, sim[chosen] * factor, _SIM, unit),
                    ],
                    layout | {"yaxis": {"title": {"text": f"{name} / {unit}"}}, "showlegend": True},
                    "",
                    GROUP,
                )
            )
            left = (real - sim)[chosen] / self.noise[channel]
            figures.append(
                Figure(
                    f"difference-{channel}",
                    [_line("real minus sim", t, left, _SIM, "times the noise")],
                    layout | {"yaxis": {"title": {"text": f"{name}: difference / noise"}}},
                    "Real minus sim in units of the noise of both; the shaded stretches hold the mismatch.",
                    GROUP,
                    240,
                )
            )
        return {"figures": figures, "buttons": [], "group": GROUP}

    def _shades(self) -> list[dict[str, Any]]:
        spans = self.where[0]["time_s"][:_MOST_SHADES] if self.where else []
        line = {"width": 0}
        return [
            {
                "type": "rect",
                "x0": a,
                "x1": b,
                "y0": 0,
                "y1": 1,
                "yref": "paper",
                "fillcolor": _SHADE,
                "line": line,
                "layer": "below",
            }
            for a, b in spans
        ]


def _line(name: str, t: FloatArray, y: FloatArray, color: str, unit: str) -> dict[str, Any]:
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": t,
        "y": y,
        "line": {"color": color, "width": 1.4},
        "hovertemplate": f"%{{y:.6g}} {unit}<br>%{{x:.6f}} s",
    }
