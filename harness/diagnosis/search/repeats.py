"""Whether a law that repeats or relaxes is seen to do so: less than a period, or a relaxation, is any slow change."""

import math

from harness.diagnosis.rules import RELAXATION_SEEN
from harness.model.model import ModelTerm


def repeats(entry: ModelTerm, travel: float, span: float, least: float = 1.0) -> bool:
    """Whether travel (m) holds a whole period of a law, and span (s) at least this share of one; other laws pass."""
    period, omega = entry.repeats("travel"), entry.repeats("time")
    return (period is None or period <= travel) and (omega is None or omega >= 2.0 * math.pi * least / span)


def relaxes(entry: ModelTerm, span: float) -> bool:
    """Whether a law that relaxes does so within so many s; other laws pass."""
    return entry.relaxation is None or entry.relaxation <= RELAXATION_SEEN.value * span
