"""Whether a law that repeats or relaxes does so within what was recorded: less than that is any slow change."""

import math

from harness.diagnosis.rules import RELAXATION_SEEN
from harness.model.model import ModelTerm


def within(entry: ModelTerm, travel: float, span: float, least: float = 1.0) -> bool:
    """Whether a recording holds what a law repeats or forgets; laws that do neither pass.

    That is a whole period along the travel (m), within the span (s) this share of a period in time, and the time in
    which it relaxes.
    """
    period, omega, tau = entry.repeats("travel"), entry.repeats("time"), entry.relaxation
    return (
        (period is None or period <= travel)
        and (omega is None or omega >= 2.0 * math.pi * least / span)
        and (tau is None or tau <= RELAXATION_SEEN.value * span)
    )
