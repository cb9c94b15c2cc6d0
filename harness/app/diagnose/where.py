"""Where a named effect acts, as results say it: spans of time, a regime, a plain condition."""

from harness.diagnosis.explain.locate import share_within
from harness.diagnosis.outcome import Mechanism, Outcome
from harness.results.common import Where


def where_of(mechanism: Mechanism, outcome: Outcome) -> Where:
    """Place of a mechanism; its share is of the baseline's mean square mismatch, in units of the noise."""
    place = mechanism.place
    share = share_within(place, outcome.base, outcome.problem)
    time_s = [[low, high] for low, high in place.spans]
    return Where(time_s=time_s, regime=place.regime, condition=place.condition, share=share)
