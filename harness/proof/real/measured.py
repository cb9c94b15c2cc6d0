"""A recording of a real machine: what a transcript says of it, and its samples."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np
from scipy.signal import savgol_coeffs, savgol_filter

from harness.core.arrays import FloatArray
from harness.proof.seal import digest

_UNITS = {"x": ("m", "rad"), "v": ("m/s", "rad/s"), "a": ("m/s^2", "rad/s^2"), "u": ("N", "N*m")}
WINDOWS, ORDER, ROUGHER = (9, 17, 33, 65, 129), 3, 1.2
"""Samples of the smoothing windows, the order of their polynomials, and the rise of the residual's variance above the
least from which a window is too wide."""


@dataclass(frozen=True, slots=True)
class Rig:
    """What a transcript says of a recording, none of its samples.

    file : its name. sha256 : of its samples as ``Measured.text``. machine : files of one machine share it. channels :
    such as "xu". condition : how far its one cause is turned, None where nobody says. moves : the number ("f_k"), or
    the law ("quadratic-drag"), that grows with the condition. angular : it turns.
    """

    file: str
    sha256: str
    machine: str
    channels: str
    condition: float | None = None
    moves: str = ""
    angular: bool = False

    @property
    def driven(self) -> bool:
        return "u" in self.channels


@dataclass(frozen=True, slots=True)
class Measured:
    """Samples, SI. t : (n,). channels, covariates : (n,) each, by name. options : of harness diagnose."""

    t: FloatArray
    channels: Mapping[str, FloatArray]
    covariates: Mapping[str, FloatArray]
    angular: bool = False
    options: Mapping[str, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """The samples as CSV."""
        heads = ["t [s]", *(f"{name} [{_UNITS[name][self.angular]}]" for name in self.channels), *self.covariates]
        columns = [self.t, *self.channels.values(), *self.covariates.values()]
        rows = (",".join(f"{value:.12g}" for value in row) for row in np.column_stack(columns).tolist())
        return "\n".join([",".join(heads), *rows]) + "\n"

    def rig(self, file: str, machine: str, condition: float | None = None, moves: str = "") -> Rig:
        sha256 = digest(self.text.encode())
        return Rig(file, sha256, machine, "".join(self.channels), condition, moves, self.angular)

    def with_channels(self, t: FloatArray | None = None, **channels: FloatArray) -> Self:
        """The same with other times, or other samples of some channels."""
        return replace(self, t=self.t if t is None else t, channels={**self.channels, **channels})

    def smoothed(self) -> FloatArray:
        """x, v, a (n, 3) by local cubics over the widest window that follows x to its noise.

        No part of the diagnosis smooths so.
        """
        t, x = self.t, self.channels["x"]
        n = round((t[-1] - t[0]) / float(np.median(np.diff(t)))) + 1
        grid = np.linspace(t[0], t[-1], n)
        even = np.interp(grid, t, x)
        left = {w: _left(even, w) for w in WINDOWS if w < n}
        width = max(w for w, variance in left.items() if variance <= ROUGHER * min(left.values()))
        step = float(grid[1] - grid[0])
        found = (savgol_filter(even, width, ORDER, deriv=order, delta=step) for order in range(3))
        return np.column_stack([np.interp(t, grid, one) for one in found])


def _left(x: FloatArray, width: int) -> float:
    """Variance of what a window leaves, as it is of white noise that it does not see."""
    own = float(savgol_coeffs(width, ORDER)[width // 2])
    return float(np.var(x - savgol_filter(x, width, ORDER))) / (1.0 - own)


def rigs_of(told: Any) -> list[Rig]:
    """As a transcript has them; TypeError where it has others."""
    return [Rig(**one) for one in told]
