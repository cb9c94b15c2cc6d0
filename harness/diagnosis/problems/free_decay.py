"""A free decay: released by a hand, simulated as a whole from one start, disturbed by its sensors alone.

Turning points of a recorded motion, as the recording itself shows them: no model need follow it.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.diagnosis.motion import motion_of
from harness.diagnosis.problem import Observation, Problem
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.rules import HAS_BEGUN
from harness.diagnosis.starts import InMotion
from harness.estimate.noise import channel_noise
from harness.kernels.solve import By, Effort, Scales
from harness.model.model import Model

_SEEN = 6.0
"""Standard deviations of noise between two turning points: what is nearer may be noise."""
_SHARE = 0.01
"""Share of the range at least: speed is summed up to a position, and its noise with it."""


def turning_points(t: FloatArray, channels: Mapping[str, FloatArray]) -> IntArray:
    """Samples (m,) at which the motion turns round by more than noise does, in order.

    t (n,) : s. channels : "x", "v" or "a", each (n,), SI; position is looked at where there is one, else the sum of the
    speed, else the acceleration, which is largest where the motion turns.
    """
    name, y = _displacement(t, channels)
    least = _SHARE * float(np.ptp(y))
    if name != "v":
        least = max(least, _SEEN * channel_noise(t, y).sigma)
    if least <= 0.0:
        return np.empty(0, dtype=np.int64)
    # imported when it is needed: it brings half of its library along
    from scipy.signal import find_peaks

    tops, _ = find_peaks(y, prominence=least)
    bottoms, _ = find_peaks(-y, prominence=least)
    return np.sort(np.concatenate((tops, bottoms)).astype(np.int64))


def _displacement(t: FloatArray, channels: Mapping[str, FloatArray]) -> tuple[str, FloatArray]:
    if "x" in channels:
        return "x", channels["x"]
    if "v" in channels:
        v = channels["v"]
        return "v", np.concatenate(([0.0], np.cumsum(np.diff(t) * (v[1:] + v[:-1]) / 2.0)))
    return "a", channels["a"]


def first_turn(t: FloatArray, channels: Mapping[str, FloatArray], turns: IntArray) -> int:
    """First sample after the first turning point of a motion that has begun; 0 where there is none.

    turns : see ``turning_points``. A hand at the release acts before it. An acceleration is largest at the release too:
    there it is the first turning point after it has changed its sign.
    """
    name, y = _displacement(t, channels)
    moved = np.abs(y) if name == "a" else np.abs(y - y[0])
    begun = np.flatnonzero(moved > HAS_BEGUN.value * np.ptp(y))
    if not begun.size:
        return 0
    at = int(begun[0])
    if name == "a":
        crossed = np.flatnonzero(np.sign(y[at:]) == -np.sign(y[at]))
        if not crossed.size:
            return 0
        at += int(crossed[0])
    later = turns[turns >= at]
    return int(later[0]) + 1 if later.size else 0


_FEWEST_TURNS = 3
"""Turning points whose distance gives the period."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeDecay(Problem):
    """See Problem.

    clock : by how much t is ahead of the recording's
    own times (m,), s, (m,), where its clock drifts.
    """

    clock: tuple[FloatArray, FloatArray] | None = None
    provides: ClassVar[frozenset[str]] = frozenset({"one-clock"})

    def shows(self, model: Model, by: tuple[By, ...], scales: Scales | None, effort: Effort) -> Observation:
        """By simulation."""
        return observe(model, self, by, scales, effort)

    def at_every_sample(self, t: FloatArray, channels: Mapping[str, FloatArray]) -> Problem:
        """See Problem; t (m,) by the recording's own clock."""
        return super(FreeDecay, self).at_every_sample(
            t if self.clock is None else t + np.interp(t, *self.clock), channels
        )

    def of_hand_free(self, fewest: int) -> tuple[Self, float]:
        """See Problem: a hand at the release acts before the first turning point."""
        turns = turning_points(self.t, self.channels)
        at = first_turn(self.t, self.channels, turns)
        if not at or self.t.size - at < fewest:
            return self, 0.0
        return self._begun_at(at, turns), float(self.t[at] - self.t[0])

    def _begun_at(self, sample: int, turns: IntArray) -> Self:
        """What follows a sample: a start within the motion, which has left its mark on what relaxes or bends."""
        if turns.size < _FEWEST_TURNS:
            return self.part(slice(sample, None))
        half = float(np.median(np.diff(self.t[turns])))
        v = motion_of(self.t, self.channels, math.pi / half).v[: sample + 1]
        last = v[self.t[: sample + 1] >= self.t[sample] - 0.5 * half]
        starts = InMotion(self.t[: sample + 1], v, float(last[np.argmax(np.abs(last))]))
        return replace(self.part(slice(sample, None)), starts=starts)

    def turns(self, v: FloatArray) -> IntArray:
        """Of the recorded swing itself, which no model need follow."""
        return turning_points(self.t, self.channels)
