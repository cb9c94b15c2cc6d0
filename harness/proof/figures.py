"""What is asked of a proof, figure by figure, and what came out."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from harness.proof.statistics import Median, Rate

if TYPE_CHECKING:
    from harness.proof.score import Scores


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure of the scores.

    label : what it counts. asked : what is asked of it, "" for one that is only shown. met : None where nothing is
    asked. share : whether it is a share of cases.
    """

    key: str
    label: str
    asked: str
    found: Rate | Median
    met: bool | None

    @property
    def share(self) -> bool:
        """Whether it is a share of cases, and not a median."""
        return isinstance(self.found, Rate)

    @property
    def sentence(self) -> str:
        """What falls short, in a sentence."""
        low = self.found.low if self.key == "named" else self.found.value
        shown = "unknown" if low is None else f"{100.0 * low:.1f} %" if self.share else f"{low:.3g}"
        bound = "lower bound " if self.key == "named" else ""
        return f"{self.label}: {bound}{shown}, {self.asked} is asked"


def _within(value: float | None, low: float, high: float) -> bool:
    return value is not None and low <= value <= high


def figures(scores: "Scores") -> list[Figure]:
    """Every figure in the order in which it is shown."""
    rows: list[tuple[str, str, str, Callable[[Rate | Median], bool] | None]] = [
        ("named", "single effects named", "lower bound above 88 %", lambda f: _within(f.low, 0.88, 1.0)),
        ("listed", "single effects named or not ruled out", "", None),
        ("both_named", "pairs, both named", "", None),
        ("false_alarms", "false alarms", "at most 2 %", lambda f: _within(f.value, -1.0, 0.02)),
        (
            "wrong_family",
            "outside the catalogue, called a wrong family",
            "at most 10 %",
            lambda f: _within(f.value, -1.0, 0.1),
        ),
        (
            "misled",
            "outside the catalogue, called that or nothing",
            "at most 10 %",
            lambda f: _within(f.value, -1.0, 0.1),
        ),
        (
            "covered",
            "true values within two standard errors",
            "92.5 to 98 %",
            lambda f: _within(f.value, 0.925, 0.98),
        ),
        ("parameter_error", "relative error of parameters, median", "", None),
        ("overlap", "overlap of the place with the true one, median", "", None),
        (
            "holdout",
            "held-out rmse after over before, median",
            "at most 0.5",
            lambda f: _within(f.value, -1.0, 0.5),
        ),
        (
            "engines_improved",
            "fit improved in MuJoCo and PyBullet",
            "at least 95 %",
            lambda f: _within(f.value, 0.95, 1.0),
        ),
    ]
    made = []
    for key, label, asked, holds in rows:
        found: Rate | Median = getattr(scores, key)
        made.append(Figure(key, label, asked, found, None if holds is None else holds(found)))
    return made
