"""Whether a law that repeats, relaxes or bends does so within what was recorded: less or finer of it is another law."""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.rules import PRESLIDING_SEEN, RELAXATION_SEEN, SAMPLED
from harness.model.model import ModelTerm


@dataclass(frozen=True, slots=True)
class Recorded:
    """What a recording holds at most and at least: travel (m), span (s), stride (m), fastest (rad/s).

    stride : as far as a sample goes in the slower half of the way; none of a free swing, which turns slowly at every
    place in its time. fastest : half the rate of the samples.
    """

    travel: float
    span: float
    stride: float = 0.0
    fastest: float = math.inf

    @classmethod
    def of(cls, t: FloatArray, x: FloatArray, driven: bool) -> "Recorded":
        """By times t (n,) and positions x (n,)."""
        step = np.sort(np.abs(np.diff(x)))
        way = np.cumsum(step)
        slower = int(np.searchsorted(way, SAMPLED.value * way[-1]))
        stride = float(step[slower]) if driven else 0.0
        return cls(float(np.ptp(x)), float(t[-1] - t[0]), stride, fastest(t))


def fastest(t: FloatArray) -> float:
    """Half the rate of samples at t (n,), rad/s: what is faster shows as something slower (Nyquist)."""
    return math.pi / float(np.median(np.diff(t)))


def within(entry: ModelTerm, f_k: float, seen: Recorded, least: float = 1.0) -> bool:
    """Whether a recording holds what a law repeats or forgets, or its slide; laws of neither kind pass.

    That is a whole period along the travel, within the span this share of a period in time, and the time in which it
    relaxes; two samples of each period; of a bristle under friction f_k (N) that it comes to slide.
    """
    period, omega, tau = entry.repeats("travel"), entry.repeats("time"), entry.relaxation
    bent = entry.presliding(f_k)
    return (
        (period is None or 2.0 * seen.stride <= period <= seen.travel)
        and (omega is None or 2.0 * math.pi * least / seen.span <= omega <= seen.fastest)
        and (tau is None or tau <= RELAXATION_SEEN.value * seen.span)
        and (bent is None or bent <= PRESLIDING_SEEN.value * seen.travel)
    )
