"""How far a metric may move before it counts, and why so far.

Engines are deterministic: on one machine the same versions give every metric bitwise again. Tolerances are for other
processors and builds, whose last bits differ; they are bounds of how far the last bits carry, not of noise.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Tolerance:
    """A move counts when it exceeds relative x |baseline| + absolute. steps : plus so many simulation steps, s."""

    relative: float
    absolute: float
    origin: str
    steps: float = 0.0

    def allows(self, before: float, after: float, dt: float | None) -> bool:
        """Whether a metric that was ``before`` may be ``after`` at a step of ``dt`` (s)."""
        return abs(after - before) <= self.relative * abs(before) + self.absolute + self.steps * (dt or 0.0)


_LAST_BITS = "smooth in the motion; differences of 1e-12 at reversals grow to less than this"
_ESTIMATE = "the guard is found from the data and may move by a sample, which moves an estimate by less than this"
_STEP = "decided sample by sample: an event may fall into the next step"
_SHARE = "a count of samples: one event more or less in the time measured"

TOLERANCES: dict[str, Tolerance] = {
    "max_error_m": Tolerance(1e-3, 1e-9, _LAST_BITS),
    "rest_error_m": Tolerance(1e-3, 1e-8, _LAST_BITS),
    "stick_time_s": Tolerance(0.0, 1e-12, _STEP, steps=1.0),
    "creep_m_s": Tolerance(1e-3, 1e-9, _LAST_BITS),
    "drift_m": Tolerance(1e-3, 1e-9, _LAST_BITS),
    "half_cycles": Tolerance(0.0, 0.0, "a whole number"),
    "reversal_lead_s": Tolerance(1e-3, 1e-9, _STEP, steps=0.5),
    "energy_error": Tolerance(1e-3, 1e-9, _LAST_BITS),
    "x_k_m": Tolerance(2e-3, 1e-8, _ESTIMATE),
    "zeta": Tolerance(2e-3, 1e-7, _ESTIMATE),
    "x_k_local_m": Tolerance(2e-2, 1e-6, "two samples of one reversal: the reversal may fall into the next step"),
    "x_k_rel_error": Tolerance(0.0, 2e-3, _ESTIMATE),
    "zeta_rel_error": Tolerance(0.0, 2e-3, _ESTIMATE),
    "x_k_local_rel_error": Tolerance(0.0, 2e-2, "two samples of one reversal: it may fall into the next step"),
    "period_s": Tolerance(0.0, 1e-12, _STEP, steps=0.5),
    "stick_fraction": Tolerance(0.0, 5e-3, _SHARE),
    "near_belt_fraction": Tolerance(0.0, 5e-3, _SHARE),
    "stop_fraction": Tolerance(0.0, 2e-3, _SHARE),
    "stick_deviation_m_s": Tolerance(1e-2, 1e-9, _LAST_BITS),
    "amplitude_m": Tolerance(1e-3, 1e-9, _LAST_BITS),
    "lift_m": Tolerance(5e-2, 1e-9, "a bouncing box forgets its last bits within a few bounces"),
    "normal_error": Tolerance(1e-1, 1e-9, "a bouncing box forgets its last bits within a few bounces"),
    "mu_v_over_g_s": Tolerance(1e-3, 1e-12, _LAST_BITS),
}
"""By metric. Speed (steps_per_s, wall_s) is no metric: it is noise, and never gates."""

DEFAULT = Tolerance(1e-3, 1e-9, "a metric without an entry of its own")


def tolerance(metric: str) -> Tolerance:
    """The tolerance of a metric."""
    return TOLERANCES.get(metric, DEFAULT)
