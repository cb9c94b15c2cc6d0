"""What a term may look at to choose starting values: the motion and the force left over."""

from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Evidence:
    """The smoothed motion and what the model at hand leaves unexplained; arrays have shape (n,).

    t : s. x, v : of the fitted model. force : force left over (data minus model), per unit mass, m/s^2, smoothed.
    peak_a : largest |a| recorded, or of the model when a was not recorded. f_k : fitted kinetic friction, per unit mass.
    omega : natural frequency, rad/s. spectrum_peaks : frequencies (rad/s) at which the force left over stands out.
    knock_times : times (s) at which the residual changes most abruptly. driven : whether a force is recorded.
    """

    t: FloatArray
    x: FloatArray
    v: FloatArray
    force: FloatArray
    peak_a: float
    f_k: float
    k: float
    omega: float
    spectrum_peaks: FloatArray
    position_peaks: FloatArray
    knock_times: FloatArray
    driven: bool = False

    @property
    def x_scale(self) -> float:
        """Largest displacement, m."""
        return float(np.max(np.abs(self.x)))

    @property
    def v_scale(self) -> float:
        """Largest speed, m/s."""
        return float(np.max(np.abs(self.v)))

    @property
    def duration(self) -> float:
        """Length of the recording, s."""
        return float(self.t[-1] - self.t[0])
