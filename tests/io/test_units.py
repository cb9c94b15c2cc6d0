"""Units of columns."""

import pytest

from harness.io.units import is_unit_of, parse_unit

USUAL = "s ms us m mm cm um rad mrad deg ° m/s mm/s rad/s deg/s m/s^2 mm/s² rad/s^2 deg/s² N mN kN"


@pytest.mark.parametrize("channel", ["t", "x", "v", "a", "u"])
def test_units_that_need_no_library_are_what_the_library_says(channel: str) -> None:
    for text in USUAL.split(" "):
        asked = f"{text} "  # which is none of the usual ones
        assert is_unit_of(channel, text) == is_unit_of(channel, asked)
        if is_unit_of(channel, text):
            plain, known = parse_unit("", channel, text), parse_unit("", channel, asked)
            assert (plain.factor, plain.angular) == (known.factor, known.angular)
