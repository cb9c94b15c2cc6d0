"""The table of what several recordings of one machine say of its numbers."""

from collections.abc import Mapping
from pathlib import PurePath

from harness.results.common import RepeatedResult
from harness.show import blocks as b
from harness.show.numbers import NONE, number


def repeated_table(together: Mapping[str, RepeatedResult], fitted: str) -> b.Table:
    """What recordings say together of each parameter, and with what it changes. fitted : how each was read, in a
    sentence.
    """
    every = [trend for one in together.values() for trend in one.trends]
    columns = [
        b.Column(
            "of all", lambda one: b.measured(one[1].value), "", "its error (type A) counts the spread between them"
        ),
        b.Column("U", lambda one: number(one[1].expanded, 2), "", "expanded uncertainty of both types, k = 2"),
        b.Column(
            "type B",
            lambda one: number(one[1].value.systematic, 2),
            "",
            "what hidden effects could shift it by; the sensors' calibration counts beside it",
        ),
        b.Column(
            "error of one", lambda one: number(one[1].within, 2), "", "standard error of a single recording's value"
        ),
        b.Column("spread between", lambda one: number(one[1].between, 2), "", "standard deviation beyond those errors"),
        b.Column("stands out", lambda one: ", ".join(PurePath(file).name for file in one[1].outliers) or "none"),
        *(b.Column(f"per {name}", b.by(name, _slope)) for name in dict.fromkeys(t.name for t in every)),
    ]
    changes = [f"{name}: {t.said}." for name, one in together.items() for t in one.trends if t.differs]
    caption = " ".join([fitted, *changes])
    rows = list(together.items())
    return b.tabulated("parameter", columns, rows, lambda one: f"{one[0]}, {one[1].value.unit}", caption=caption)


def _slope(one: tuple[str, RepeatedResult], name: str) -> b.Cell:
    trend = next((trend for trend in one[1].trends if trend.name == name), None)
    return b.Cell(NONE) if trend is None else b.measured(trend.slope, grade=4 if trend.differs else None)
