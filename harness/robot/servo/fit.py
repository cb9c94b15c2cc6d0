"""Numbers of a servo's joint from its goals and positions: least squares over free runs, with errors."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import compress

import numpy as np

from harness.core.arrays import FloatArray
from harness.fit.least_squares import Bounds, Stop, Until, coloured_covariance, least_squares
from harness.fit.series import Memory, memory
from harness.robot.servo.plant import NUMBERS, Run

LONGEST = 20.0
"""s of a free run: an error of its start is forgotten long before, but where a joint rests."""
_STEP = 2e-3
"""Of a difference quotient, in ordinary sizes of a number: above the roughness that sticking leaves in a run."""
_UNTIL = Until(share=1e-3, iterations=30)
_UNTOLD = 1e4
"""Standard error, in ordinary sizes, from which a number shows nowhere."""
NEAR_FLOOR = 1.5
"""rms over the sensor's up to which a fit leaves nothing."""
_NORMAL = 0.6745
"""Median of the absolute value of a normal number of unit variance."""
_MOVE = 3.0
"""Ordinary sizes that a number moves at most in one step."""


def floor(runs: Sequence[Run]) -> float:
    """rms, rad, of positions' noise and steps: by third differences, which the motion hardly shows, at least
    step/sqrt(12).
    """
    found = []
    for run in runs:
        rough = np.median(np.abs(np.diff(run.q, 3))) / (_NORMAL * math.sqrt(20.0))
        found.append(max(float(rough), run.step / math.sqrt(12.0)))
    return float(np.median(found))


@dataclass(frozen=True, slots=True)
class Logs:
    """Logs of one joint with the samples that count.

    windows : by log, first and last sample + 1 of each free run. known : numbers that are given. torque : N m that is
    ordinary for it.
    """

    runs: tuple[Run, ...]
    windows: tuple[tuple[tuple[int, int], ...], ...]
    known: Mapping[str, float]
    torque: float = 1.0

    @classmethod
    def of(cls, runs: Sequence[Run], known: Mapping[str, float], torque: float = 1.0) -> "Logs":
        """All of them."""
        return cls(tuple(runs), tuple(tuple(run.windows(LONGEST)) for run in runs), dict(known), torque)

    def in_runs_of(self, seconds: float) -> "Logs":
        """What they have in shorter free runs, each from a logged start."""
        shorter = [
            tuple(window for first, last in own for window in run.windows(seconds, first, last))
            for run, own in zip(self.runs, self.windows, strict=True)
        ]
        return Logs(self.runs, tuple(shorter), self.known, self.torque)

    def size(self, name: str) -> float:
        """What is ordinary for a number."""
        return NUMBERS[name].size * (self.torque if "N m" in NUMBERS[name].unit or "kg" in NUMBERS[name].unit else 1.0)

    def residual(self, values: Mapping[str, float]) -> FloatArray:
        """Logged less simulated positions (N,), rad, of all windows one behind the other."""
        everything = {**self.known, **values}
        parts = []
        for run, windows in zip(self.runs, self.windows, strict=True):
            left = run.q - run.simulated(everything, list(windows))
            parts += [left[first:last] for first, last in windows]
        return np.concatenate(parts)

    @property
    def begins(self) -> tuple[int, ...]:
        """Where each further window begins in a residual."""
        sizes = [last - first for windows in self.windows for first, last in windows]
        return tuple(np.cumsum(sizes)[:-1].tolist())

    def split(self, residual: FloatArray) -> list[FloatArray]:
        """A residual by log."""
        sizes = [sum(last - first for first, last in windows) for windows in self.windows]
        return np.split(residual, np.cumsum(sizes)[:-1])

    def part(self, keep: Sequence[Sequence[bool]]) -> "Logs":
        """Those windows that ``keep`` says, by log; logs without one are left out."""
        kept = [tuple(compress(windows, own)) for windows, own in zip(self.windows, keep, strict=True)]
        runs = tuple(compress(self.runs, kept))
        return Logs(runs, tuple(filter(None, kept)), self.known, self.torque)


@dataclass(frozen=True)
class ServoFit:
    """Fitted numbers. values : of those in ``free``, the others are known. residual (N,), rad; partials (N, q)."""

    logs: Logs
    free: tuple[str, ...]
    values: Mapping[str, float]
    residual: FloatArray
    stop: Stop

    @property
    def squares(self) -> float:
        with np.errstate(over="ignore"):  # of a run that diverges
            return float(self.residual @ self.residual)

    @property
    def rms(self) -> float:
        """rad."""
        return math.sqrt(self.squares / self.residual.size)

    @cached_property
    def at_noise(self) -> bool:
        """Whether it leaves no more than the sensor."""
        return self.rms <= NEAR_FLOOR * floor(self.logs.runs)

    @property
    def mae(self) -> float:
        """Mean absolute error, rad, the mean over logs."""
        return float(np.mean([np.mean(np.abs(part)) for part in self.logs.split(self.residual)]))

    @cached_property
    def memory(self) -> Memory:
        """Of the residual, which counts as fewer values than samples."""
        return memory(self.residual, begins=self.logs.begins)

    @cached_property
    def covariance(self) -> FloatArray:
        """Of what is free (q, q), in ordinary sizes; colour of the residual allowed for.

        What stands on a bound may be off it too: what goes with it (damping with a delay of none) is no surer for that.
        """
        partials = _partials(self.logs, self.values, self.free, self.residual)
        scaled = partials * np.array([self.logs.size(name) for name in self.free])
        lags = min(int(3.0 * self.memory.time), self.residual.size // 10)
        return coloured_covariance(scaled, self.residual, lags, self.logs.begins)

    @property
    def errors(self) -> dict[str, float]:
        """Standard errors of what is free; inf for what stands on a bound, and for what nothing tells."""
        spread = np.sqrt(np.diag(self.covariance))
        return {
            name: float(s) * self.logs.size(name) if 0.0 < s < _UNTOLD and not self.bound(name) else math.inf
            for name, s in zip(self.free, spread, strict=True)
        }

    @property
    def partners(self) -> dict[str, tuple[str, float]]:
        """For each number the one that it goes with most, and their correlation."""
        spread = np.sqrt(np.maximum(np.diag(self.covariance), 1e-300))
        together = self.covariance / np.outer(spread, spread)
        np.fill_diagonal(together, 0.0)
        most = np.argmax(np.abs(together), axis=1)
        return {
            name: (self.free[j], float(together[i, j])) for i, (name, j) in enumerate(zip(self.free, most, strict=True))
        }

    def bound(self, name: str) -> bool:
        """Whether a number stands on a bound of its own."""
        return self.values[name] <= NUMBERS[name].lower + 1e-3 * self.logs.size(name) and NUMBERS[name].lower >= 0.0

    def under(self, logs: Logs) -> "ServoFit":
        """The same numbers on other logs."""
        return ServoFit(logs, self.free, self.values, logs.residual(self.values), self.stop)


@dataclass(frozen=True)
class _Point:
    """See least_squares.Point; at : coordinates in ordinary sizes."""

    logs: Logs
    free: tuple[str, ...]
    at: FloatArray

    @cached_property
    def residual(self) -> FloatArray:
        return self.logs.residual(self.values)

    @property
    def values(self) -> dict[str, float]:
        return {name: float(x) * self.logs.size(name) for name, x in zip(self.free, self.at, strict=True)}

    @property
    def squares(self) -> float:
        with np.errstate(over="ignore"):  # of a run that diverges
            return float(self.residual @ self.residual)

    def normal_equations(self) -> tuple[FloatArray, FloatArray]:
        partials = _partials(self.logs, self.values, self.free, self.residual)
        partials *= np.array([self.logs.size(name) for name in self.free])
        return partials.T @ partials, partials.T @ self.residual


def _partials(logs: Logs, values: Mapping[str, float], free: Sequence[str], residual: FloatArray) -> FloatArray:
    """Partials (N, q) of the positions by numbers, as differences away from a bound."""
    columns = np.empty((residual.size, len(free)))
    for i, name in enumerate(free):
        step = _STEP * logs.size(name)
        step = -step if values[name] + step > NUMBERS[name].upper else step
        columns[:, i] = (residual - logs.residual({**values, name: values[name] + step})) / step
    return columns


def fit(logs: Logs, start: Mapping[str, float], until: Until = _UNTIL) -> ServoFit:
    """The least squares that descend from ``start``, whose names are what is fitted."""
    free = tuple(start)
    sizes = np.array([logs.size(name) for name in free])
    bounds = Bounds(
        np.array([NUMBERS[name].lower for name in free]) / sizes,
        np.array([NUMBERS[name].upper for name in free]) / sizes,
        np.full(len(free), _MOVE),
    )
    ended = least_squares(
        lambda at: _Point(logs, free, at), np.array([start[name] for name in free]) / sizes, until, bounds
    )
    return ServoFit(logs, free, ended.point.values, ended.point.residual, ended.stop)
