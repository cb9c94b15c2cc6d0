"""Where a named effect acts, as results say it: spans of time, a regime, a plain condition."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from harness.diagnosis.outcome import Mechanism, Outcome
from harness.model.model import ModelTerm
from harness.results.common import Regime, Where

Said: TypeAlias = Callable[[ModelTerm], str]


def _fixed(text: str) -> Said:
    return lambda entry: text


def _stop(entry: ModelTerm) -> str:
    side = {"": "|x| >", "positive": "x >", "negative": "x < -"}[entry.term.variant]
    return f"{side} {entry.value('gap'):.4g} m".replace("- ", "-")


_ACTS: dict[str, tuple[Regime, Said]] = {
    "end-stop": ("large-displacement", _stop),
    "backlash": ("throughout", lambda e: f"|x| < {e.value('gap'):.4g} m"),
    "sensor-clipping": ("channel", lambda e: f"|a| at its limit of {e.value('limit'):.4g} m/s^2"),
    "impulse": ("early", lambda e: f"from t = {e.value('time'):.4g} s on"),
    "stribeck": ("low-speed", lambda e: f"|v| below about {2.0 * e.value('v_s'):.3g} m/s"),
    "regularised-friction": ("low-speed", lambda e: f"|v| < {e.value('v_r'):.3g} m/s"),
    "presliding": ("reversal", _fixed("after each reversal, until the bristles slide")),
    "static-friction": ("stick", _fixed("v = 0")),
    "quadratic-drag": ("high-speed", _fixed("as v^2")),
    "cubic-stiffness": ("large-displacement", _fixed("as x^3")),
    "quadratic-stiffness": ("large-displacement", _fixed("as x^2")),
    "pendulum-stiffness": ("large-displacement", _fixed("as x - sin x")),
    "friction-drift": ("late", _fixed("in proportion to t")),
    "stiffness-drift": ("late", _fixed("in proportion to t")),
    "sensor-lag": ("channel", _fixed("channel x")),
    "sensor-drift": ("channel", _fixed("channel x")),
    "sensor-gain": ("channel", _fixed("channel a")),
    "sensor-bias": ("channel", _fixed("channel a")),
}
_EVERYWHERE: tuple[Regime, Said] = ("throughout", _fixed("always"))


def where_of(mechanism: Mechanism, outcome: Outcome) -> Where:
    """Place of a mechanism; its share is of the baseline's mean square mismatch, in units of the noise."""
    regime, say = _ACTS.get(mechanism.name, _EVERYWHERE)
    t = outcome.problem.t
    if mechanism.name == "end-stop" and mechanism.entry.term.variant:
        regime = "one-side"
    if mechanism.name == "impulse" and mechanism.entry.value("time") > 0.5 * float(t[0] + t[-1]):
        regime = "late"
    inside = np.zeros(t.size, dtype=np.bool_)
    for low, high in mechanism.spans:
        inside |= (t >= low) & (t <= high)
    squares = outcome.base.residual.reshape(-1, t.size) ** 2
    total = float(squares.sum())
    share = float(squares[:, inside].sum()) / total if total > 0.0 else None
    return Where(
        time_s=[[low, high] for low, high in mechanism.spans],
        regime=regime,
        condition=say(mechanism.entry),
        share=share,
    )
