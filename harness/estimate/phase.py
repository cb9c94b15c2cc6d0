"""The phase by which the accelerometer leads the displacement sensor (0.216 rad in the paper's experiment)."""

import math

import numpy as np

from harness.core.quantity import Quantity
from harness.estimate.channel import ChannelFit
from harness.estimate.result import quantity
from harness.estimate.tied import OMEGA, T0
from harness.estimate.turning import reversal_times


def _time_error(fit: ChannelFit, index: float) -> float:
    """Variance of the reversal time at (fractional) ``index`` in a tied fit, s^2."""
    covariance = fit.tied.covariance[np.ix_([T0, OMEGA], [T0, OMEGA])] * fit.variance
    gradient = np.array([1.0, -index * math.pi / fit.omega**2])
    return max(float(gradient @ covariance @ gradient), 0.0)


def sensor_lead(acceleration: ChannelFit, displacement: ChannelFit) -> tuple[Quantity, float]:
    """Phase lead of the accelerometer in rad, and the same in s: x is late against a by that time.

    Each channel is fitted with reversals of its own; the lead is how far theirs are apart. Methods that read one
    channel
    at that channel's own reversals need no further correction: this is how the lead is removed.
    """
    ours, theirs = reversal_times(acceleration), reversal_times(displacement)
    half = math.pi / acceleration.omega
    gaps, index = [], []
    for i, time in enumerate(ours):
        near = theirs[np.argmin(np.abs(theirs - time))]
        if abs(near - time) < 0.45 * half:
            gaps.append(float(near - time))
            index.append(i + 1.0)
    if not gaps:
        return Quantity.refused("rad", "the two channels have no reversal in common"), 0.0
    if acceleration.holds and displacement.holds:
        middle = float(np.mean(index))
        error = math.sqrt(_time_error(acceleration, middle) + _time_error(displacement, middle))
        lag = float(np.mean(gaps))
    else:
        lag = float(np.median(gaps))
        error = float(np.std(gaps)) / math.sqrt(len(gaps)) if len(gaps) > 1 else math.inf
    return quantity(acceleration.omega * lag, acceleration.omega * error, "rad"), lag
