"""Whether a law that repeats, relaxes or bends does so within what was recorded: less of it is another law."""

import math

from harness.diagnosis.rules import PRESLIDING_SEEN, RELAXATION_SEEN
from harness.model.model import ModelTerm


def within(entry: ModelTerm, f_k: float, travel: float, span: float, least: float = 1.0) -> bool:
    """Whether a recording holds what a law repeats or forgets, or its slide; laws of neither kind pass.

    That is a whole period along the travel (m), within the span (s) this share of a period in time, and the time in
    which it relaxes; of a bristle under friction f_k (N) that it comes to slide.
    """
    period, omega, tau = entry.repeats("travel"), entry.repeats("time"), entry.relaxation
    bent = entry.presliding(f_k)
    return (
        (period is None or period <= travel)
        and (omega is None or omega >= 2.0 * math.pi * least / span)
        and (tau is None or tau <= RELAXATION_SEEN.value * span)
        and (bent is None or bent <= PRESLIDING_SEEN.value * travel)
    )
