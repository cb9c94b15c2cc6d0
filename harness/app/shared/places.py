"""Places of a mismatch in the form of the results."""

from harness.diagnosis.explain.locate import Place
from harness.results.common import Where


def where_of_place(place: Place) -> Where:
    """Spans, regime, condition and share."""
    return Where.model_validate(
        {
            "time_s": [list(span) for span in place.spans],
            "regime": place.regime,
            "condition": place.condition,
            "share": place.share,
        }
    )
