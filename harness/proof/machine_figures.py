"""What is asked of a proof on recordings of machines, figure by figure, and what came out."""

from harness.proof.figures import Figure
from harness.proof.machines.score import LABELS, MachineScores
from harness.proof.statistics import Median, Rate

_LEAST = {"listed": 0.8, "better": 0.6}
_MOST = {"wrong": 0.04, "claimed": 0.03}
_CONTROLS = ("claimed", "unfounded", "small")
_SHOWN = ("listed", "named", "wrong", "silent", *_CONTROLS, "misled", "better", "holdout", "share_error")


def machine_figures(scores: MachineScores) -> list[Figure]:
    """Every figure in the order in which it is shown."""
    return [_figure(name, getattr(scores, name)) for name in _SHOWN]


def _figure(name: str, found: Rate | Median) -> Figure:
    asked, met = "", None
    if name in _LEAST:
        asked = f"at least {100.0 * _LEAST[name]:.0f} %"
        met = found.value is not None and found.value >= _LEAST[name]
    elif name in _MOST:
        asked = f"at most {100.0 * _MOST[name]:.0f} %"
        met = found.value is not None and found.value <= _MOST[name]
    return Figure(f"machines_{name}", LABELS[name], asked, found, met)
