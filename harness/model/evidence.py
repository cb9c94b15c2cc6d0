"""What a term may look at to choose starting values: the motion and the force left over."""

from dataclasses import dataclass

from harness.core.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Evidence:
    """The fitted motion and where the residual stands out, from which terms choose their starting values.

    x_scale (m), v_scale (m/s), peak_a (m/s^2): largest values. low, high : smallest and largest position, m.
    f_k, k, omega : of the fitted model (per unit mass where the mass is unknown), omega in rad/s. duration : s.
    frequencies : angular frequencies (rad/s) at which the residual stands out. knock_times : times (s) worth a look.
    periods : of travel (m) at which the force left over stands out, empty where no force is looked at.
    driven : whether a force is recorded. angular : whether the unit of a channel was an angle.
    """

    x_scale: float
    v_scale: float
    peak_a: float
    low: float
    high: float
    f_k: float
    k: float
    omega: float
    duration: float
    frequencies: FloatArray
    knock_times: FloatArray
    driven: bool = False
    angular: bool = False
    periods: tuple[float, ...] = ()
