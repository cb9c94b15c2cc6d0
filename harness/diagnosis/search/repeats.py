"""Whether a law that repeats in time or over the travel is seen to: less than a period of it is any slow change."""

import math

from harness.model.model import ModelTerm


def repeats(entry: ModelTerm, travel: float, span: float, least: float = 1.0) -> bool:
    """Whether travel (m) holds a whole period of a law, and span (s) at least this share of one; other laws pass."""
    period, omega = entry.repeats("travel"), entry.repeats("time")
    return (period is None or period <= travel) and (omega is None or omega >= 2.0 * math.pi * least / span)
