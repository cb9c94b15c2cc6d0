"""Numbers in sentences: the error's digits decide the value's."""

import pytest

from harness.core.quantity import Quantity


@pytest.mark.parametrize(
    ("value", "stderr", "text"),
    [
        (20.0134, 0.0067, "20.013 +- 0.007 N/m"),
        (9.5032, 0.0126, "9.503 +- 0.013 N/m"),
        (0.0316, 2.5e-4, "0.03160 +- 0.00025 N/m"),
        (3.172e-5, 1.2e-6, "(3.17 +- 0.12)e-05 N/m"),
        (123456.0, 2345.0, "123500 +- 2300 N/m"),
        (1.2e9, 4e7, "(1.20 +- 0.04)e+09 N/m"),
        (0.1, 0.3, "0.1 +- 0.3 N/m"),
        (5.0, 0.0299, "5.00 +- 0.03 N/m"),
        (1.0, 9.96, "1 +- 10 N/m"),
        (-3.456, 0.25, "-3.46 +- 0.25 N/m"),
        (-0.04, 9.0, "0 +- 9 N/m"),
        (-4e-13, 9.1e-10, "(0 +- 9)e-10 N/m"),
    ],
)
def test_two_digits_of_an_error_that_begins_with_one_or_two_else_one(value: float, stderr: float, text: str) -> None:
    assert str(Quantity(value, stderr, "N/m")) == text


def test_a_number_without_error_or_without_value() -> None:
    assert str(Quantity(1.5, None, "1", "given")) == "1.5"
    assert str(Quantity.refused("s", "too few reversals")) == "unknown"
