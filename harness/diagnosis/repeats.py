"""Whether a law that repeats in time or over the travel is seen to: less than a period of it is any slow change."""

import math

from harness.model.model import ModelTerm


def repeats(entry: ModelTerm, travel: float, span: float, least: float = 1.0) -> bool:
    """Whether travel (m) holds a whole period of a law, and span (s) at least this share of one; other laws pass."""
    names = entry.term.names
    short = "period" not in names or entry.value("period") <= travel
    return short and ("Omega" not in names or entry.value("Omega") >= 2.0 * math.pi * least / span)
