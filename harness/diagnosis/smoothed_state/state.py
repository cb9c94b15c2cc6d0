"""The smoothed course of a driven recording, and the windows that start on it."""

from collections.abc import Mapping
from dataclasses import dataclass

from harness.core.arrays import FloatArray
from harness.diagnosis.problems.starts import Windows
from harness.diagnosis.smoothed_state.inverse_start import state_of
from harness.diagnosis.smoothed_state.local_cubics import Smooth, longest_interval, smoothed
from harness.diagnosis.smoothed_state.windows import windows_of
from harness.estimate.noise import Noise


@dataclass(frozen=True, slots=True)
class Course:
    """Position, speed and acceleration, (n,) each, at t (n,), s; longest : interval (s) beyond which there is a gap."""

    t: FloatArray
    smooth: Mapping[str, Smooth]
    state: tuple[FloatArray, FloatArray, FloatArray]
    longest: float

    @classmethod
    def of(cls, t: FloatArray, channels: Mapping[str, FloatArray], noise: Mapping[str, Noise]) -> "Course":
        """From position, speed or both, over no gap."""
        longest = longest_interval(t)
        smooth = {c: smoothed(t, channels[c], longest, noise[c].sigma) for c in ("x", "v") if c in channels}
        return cls(t, smooth, state_of(t, smooth), longest)

    def anew(self, horizon: float) -> Windows:
        """Windows no longer than a horizon, s; an infinite one leaves the stretches between gaps."""
        return Windows(windows_of(self.t, self.state, self.smooth, horizon, self.longest), self.t, self.state[1])
