"""How much of what a model leaves of an acceleration must be the sensor's own for it to be told from there."""

import math

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.diagnosis.baseline.residual_noise import residual_noise
from harness.diagnosis.problems import force_noise
from harness.estimate.noise import channel_noise

_SAMPLES, _DRAWS, _OMEGA = 1200, 400, 15.0


def test_the_share_is_where_both_ways_are_as_sure() -> None:
    t: FloatArray = np.arange(float(_SAMPLES)) * 0.013
    moves = 50.0 * np.sin(_OMEGA * t)
    random = np.random.default_rng(0)
    alone, left = np.empty(_DRAWS), np.empty(_DRAWS)
    for i in range(_DRAWS):
        noise = random.standard_normal(_SAMPLES)
        alone[i] = channel_noise(t, noise).sigma ** 2
        left[i] = residual_noise(t, noise, moves + noise, 2.0 * math.pi / _OMEGA).sigma ** 2
    off_alone, off_left = (float(np.std(v) / np.mean(v)) * math.sqrt(_SAMPLES) for v in (alone, left))
    # one standard error of a scatter of 400 draws is 3.5 % of it
    assert off_alone == pytest.approx(6.1, rel=0.1)
    assert off_left == pytest.approx(1.7, rel=0.1)
    assert pytest.approx(off_left / off_alone, abs=0.05) == force_noise._MOSTLY
