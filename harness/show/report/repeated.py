"""The table of what several recordings of one machine say of its numbers."""

from collections.abc import Mapping
from pathlib import PurePath

from harness.results.common import P, RepeatedResult
from harness.show import blocks as b
from harness.show.numbers import NONE, SHOWN, shown_number, shown_unit


def repeated_table(together: Mapping[str, RepeatedResult], fitted: str) -> b.Table:
    """What recordings say together of each parameter, and with what it changes. fitted : how each was read, in a
    sentence.
    """
    every = [trend for one in together.values() for trend in one.trends]
    columns = [
        b.Column(
            "of all", lambda one: b.measured(one[1].value), "", "its error (type A) counts the spread between them"
        ),
        b.Column("U", lambda one: _number(one, one[1].expanded), "", "expanded uncertainty of both types, k = 2"),
        b.Column(
            "type B",
            lambda one: _number(one, one[1].value.systematic),
            "",
            "what hidden effects could shift it by; the sensors' calibration counts beside it",
        ),
        b.Column(
            "error of one", lambda one: _number(one, one[1].within), "", "standard error of a single recording's value"
        ),
        b.Column(
            "spread between", lambda one: _number(one, one[1].between), "", "standard deviation beyond those errors"
        ),
        b.Column("stands out", lambda one: ", ".join(PurePath(file).name for file in one[1].outliers) or "none"),
        *(b.Column(f"per {name}", b.by(name, _slope)) for name in dict.fromkeys(t.name for t in every)),
    ]
    changes = [f"{name}: {t.said}." for name, one in together.items() for t in one.trends if t.differs]
    caption = " ".join([fitted, *changes])
    rows = list(together.items())
    return b.tabulated("parameter", columns, rows, _name, caption=caption)


def _name(one: tuple[str, RepeatedResult]) -> str:
    return ", ".join(filter(None, (one[0], shown_unit(one[1].value.unit))))


def _number(one: tuple[str, RepeatedResult], value: float | None) -> str:
    """A number of a parameter in the unit that stands at its name."""
    return shown_number(value, one[1].value.unit, 2)


def _slope(one: tuple[str, RepeatedResult], name: str) -> b.Cell:
    trend = next((trend for trend in one[1].trends if trend.name == name), None)
    if trend is None:
        return b.Cell(NONE)
    factor = SHOWN.get(one[1].value.unit, ("", 1.0))[1]  # as the value beside it is shown
    said = {key: None if known is None else known * factor for key, known in _both(trend.slope).items()}
    return b.measured(trend.slope.model_copy(update=said), grade=4 if trend.differs else None)


def _both(p: P) -> dict[str, float | None]:
    return {"value": p.value, "stderr": p.stderr}
