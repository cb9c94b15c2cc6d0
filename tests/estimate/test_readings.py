"""Readings of an encoder: what stands for a run of them errs by no more than its weight claims."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.arrays import FloatArray
from harness.estimate.readings import words

T: FloatArray = np.arange(4000) / 1000.0


def off(x: FloatArray) -> FloatArray:
    """Errors of the middles of runs in units of what their weights claim."""
    read = np.round(x)
    weight = words(read)
    found: FloatArray = ((read - x) * math.sqrt(12.0) * weight)[weight > 1.0]
    return found


def test_readings_of_a_steady_speed_are_worth_as_many_as_they_are() -> None:
    read = np.round(0.04 * np.arange(2000.0) + 0.02)
    worth = words(read) ** 2
    inner = slice(100, -100)
    assert float(np.sum(worth[inner])) == pytest.approx(1800.0, rel=0.01)
    # in their middle the sensor is on its level, to half a sample
    assert np.max(np.abs(off(0.04 * np.arange(2000.0) + 0.02))) < 0.5


@given(speed=st.floats(5.0, 40.0), stops=st.floats(2.0, 3.9), zero=st.floats(0.0, 1.0))
def test_where_a_slider_slows_to_a_stop_no_reading_claims_more_than_it_knows(
    speed: float, stops: float, zero: float
) -> None:
    x = zero + np.where(stops > T, speed * T - speed / stops * T**2 / 2.0, 0.5 * speed * stops)
    # of a deviation of one claimed, four in none of some hundred
    assert np.max(np.abs(off(x)), initial=0.0) < 4.0
