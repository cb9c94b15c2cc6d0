"""Numbers for people."""

import pytest

from harness.cli.output import with_error
from harness.results.common import P


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (P(value=0.0123188, stderr=0.0041, unit="rad"), "0.0123 +- 0.0041 rad"),
        (P(value=10.7596, stderr=0.0212, unit="rad/s"), "10.760 +- 0.021"),
        (P(value=0.05, stderr=3.2e-7, unit="1"), "0.05000000 +- 0.00000032"),
        (P(value=231.4, stderr=14.0, unit="m"), "231 +- 14 m"),
        (P(value=1.5, stderr=0.0, unit="m"), "1.5 m"),
        (P(value=1.5, stderr=None, unit="m", why="one reversal"), "1.5 m"),
        (P(value=None, stderr=None, unit="m", why="no reversal"), "-"),
    ],
)
def test_values_carry_the_digits_their_errors_give_meaning_to(number: P, text: str) -> None:
    assert with_error(number) == text
