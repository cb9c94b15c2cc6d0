"""A user's own simulated trace laid over a recording: shifted in time, and read at the recording's times."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.trajectory import Source, Trajectory
from harness.diagnosis.problem import Problem
from harness.diagnosis.resample import motion_at

_LOOKS = 2000
_LEAST_SHARED = 0.5
_ROUNDS = 4
_FINER = 20


@dataclass(frozen=True, slots=True)
class Aligned:
    """A trace over a recording.

    shift : s to be added to the trace's times. shown : its channels at the recording's times, (n,). covered : (n,),
    where it has something to show.
    """

    shift: float
    shown: Mapping[str, FloatArray]
    covered: BoolArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "shown", MappingProxyType(dict(self.shown)))


def align(trace: Recording, problem: Problem, period: float) -> Aligned:
    """Shift a trace in time so that it differs least from the recording, in units of the noise.

    period : of the motion, s. Every shift that leaves at least half of the recording covered is looked at in steps of
    1/40 of a period, then the best of them ever more closely.
    Raises InputError when the two have no channel in common or the trace is too short.
    """
    common = [c for c in problem.channels if c in trace]
    if not common:
        found = f"channels {', '.join(trace.channels)}"
        raise InputError(trace.file, found, f"one or more of {', '.join(problem.channels)} is accepted")
    thin = problem.part(slice(None, None, max(1, problem.t.size // _LOOKS)))
    span = problem.t[-1] - problem.t[0]
    first = float(problem.t[0] - trace.t[-1] + _LEAST_SHARED * span)
    last = float(problem.t[-1] - trace.t[0] - _LEAST_SHARED * span)
    if trace.duration < _LEAST_SHARED * span:
        found = f"{trace.duration:.4g} s long"
        raise InputError(trace.file, found, f"a trace of at least half of the recording's {span:.4g} s is accepted")
    step = period / 40.0
    # no shift at all is what most traces want
    shifts = np.append(np.arange(first, last + step, step), 0.0 if first <= 0.0 <= last else 0.5 * (first + last))
    best = _best(trace, thin, common, shifts)
    for _ in range(_ROUNDS):
        shifts = np.append(best + step * np.linspace(-1.0, 1.0, 2 * _FINER + 1), best)
        best = _best(trace, thin, common, np.clip(shifts, first, last))
        step /= _FINER
    return read(trace, problem, best)


def read(trace: Recording, problem: Problem, shift: float) -> Aligned:
    """Channels of a trace at the times of a recording, with ``shift`` (s) added to the trace's own times."""
    since = problem.t - shift
    covered = (since >= trace.t[0] - trace.interval) & (since <= trace.t[-1] + trace.interval)
    since = np.clip(since, trace.t[0], trace.t[-1])
    return Aligned(shift, _channels(trace, since, [c for c in problem.channels if c in trace]), covered)


def _channels(trace: Recording, since: FloatArray, names: list[str]) -> dict[str, FloatArray]:
    """Channels by name at times in the trace's own time base; with speed and acceleration, jumps are respected."""
    if "v" in trace and "a" in trace:
        x = trace["x"] if "x" in trace else np.zeros(len(trace))
        motion = motion_at(Trajectory(trace.t, x, trace["v"], trace["a"], Source(trace.file)), since)
        every = {"x": motion.x, "v": motion.v, "a": motion.a}
        return {name: every[name] for name in names}
    return {name: np.interp(since, trace.t, trace[name]) for name in names}


def _best(trace: Recording, problem: Problem, common: list[str], shifts: FloatArray) -> float:
    """The shift of least mean square difference, in units of the noise."""
    return min(
        (float(shift) for shift in shifts), key=lambda shift: _misfit(read(trace, problem, shift), problem, common)
    )


def _misfit(aligned: Aligned, problem: Problem, common: list[str]) -> float:
    """Mean square difference; where the trace shows nothing it is taken to rest, so that hiding does not pay."""
    total = 0.0
    for c in common:
        y = problem.channels[c]
        shown = np.where(aligned.covered, aligned.shown[c], y[-1])
        total += float(np.sum(problem.weight[c] * ((y - shown) / problem.noise[c].sigma) ** 2))
    return total
