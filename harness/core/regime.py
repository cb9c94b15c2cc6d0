"""The regimes of a motion in which something may act, by the names that results use."""

from typing import Literal, TypeAlias

Regime: TypeAlias = Literal[
    "reversal",
    "stick",
    "low-speed",
    "high-speed",
    "large-displacement",
    "one-direction",
    "one-side",
    "early",
    "late",
    "throughout",
    "channel",
]
