"""Metrics of a trace: of a free decay against the exact motion, as estimators read it, and of a contact."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.events import EventKind, Mode
from harness.core.scenario import Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Trajectory
from harness.estimate.every import estimate_all
from harness.estimate.result import Estimation
from harness.exact.decay import free_decay


def falling(t: FloatArray, y: FloatArray) -> FloatArray:
    """Times at which y goes from above 0 to 0 or below, by linear interpolation."""
    i = np.flatnonzero((y[:-1] > 0.0) & (y[1:] <= 0.0))
    found: FloatArray = t[i] + y[i] * (t[i + 1] - t[i]) / (y[i] - y[i + 1])
    return found


def highest(y: FloatArray) -> float:
    """Largest value of evenly sampled y, by a parabola through the largest sample and its neighbours."""
    i = int(np.argmax(y))
    if i in (0, y.size - 1):
        return float(y[i])
    before, at, after = (float(value) for value in y[i - 1 : i + 2])
    bend = before - 2.0 * at + after
    return at if bend >= 0.0 else at - 0.125 * (after - before) ** 2 / bend


STILL = 1e-6
"""Slower than this share of the speed scale of the start is rest."""
SWING = 1e-3
"""A half-cycle whose peak speed stays below this share of the speed scale is creep, not a swing."""


def measure_decay(trace: Trajectory, scenario: Scenario) -> dict[str, float | None]:
    """Every metric of ``trace``, a run of the free decay ``scenario``.

    Raises InputError when the scenario is no free decay.
    """
    exact = free_decay(scenario, trace.t)
    slider = scenario.slider
    speed = np.hypot(scenario.x0 * slider.omega_n, scenario.v0)
    return {
        "max_error_m": max_error_m(trace, exact),
        "rest_error_m": rest_error_m(trace, exact),
        "stick_time_s": stick_time_s(trace, STILL * speed),
        "creep_m_s": creep_m_s(trace, exact),
        "half_cycles": half_cycles(trace, SWING * speed),
        "reversal_lead_s": reversal_lead_s(trace, slider),
        "energy_error": energy_error(trace, slider),
    }


def max_error_m(trace: Trajectory, exact: Trajectory) -> float:
    """Largest |x - exact x| in m, both at the same times.

    Good: what the integrator alone would leave, its error with friction switched off.
    """
    return float(np.max(np.abs(trace.x - exact.x)))


def rest_error_m(trace: Trajectory, exact: Trajectory) -> float | None:
    """Last x minus the exact rest position in m; None when the exact slider does not rest by then.

    Good: far below x_k - |exact rest position|, since within that band any position would be an equilibrium.
    """
    if exact.mode is None or exact.mode[-1] != Mode.STICK:
        return None
    return float(trace.x[-1] - exact.x[-1])


def stick_time_s(trace: Trajectory, still: float) -> float | None:
    """Time in s from which the speed stays at or below ``still`` (m/s); None when it never comes to rest.

    A source that knows when it sticks is asked; the others are read to one sample. Good: the exact time within a step.
    """
    known = trace.events.of(EventKind.STICK)
    if len(known):
        return float(known.t[-1])
    moving = np.flatnonzero(np.abs(trace.v) > still)
    if not moving.size:
        return float(trace.t[0])
    last = int(moving[-1])
    return None if last == len(trace) - 1 else float(trace.t[last + 1])


def creep_m_s(trace: Trajectory, exact: Trajectory) -> float | None:
    """Mean velocity in m/s over the later half of the time in which the exact slider rests; None when it does not.

    The earlier half is left out, since an engine may still be arriving. Good: 0; friction that is a steep viscous law
    instead of a constraint creeps at a rate that is proportional to the load.
    """
    if exact.mode is None or exact.mode[-1] != Mode.STICK:
        return None
    moving = np.flatnonzero(exact.mode != Mode.STICK)
    first = int(moving[-1]) + 1 if moving.size else 0
    half = (first + len(trace) - 1) // 2
    if half >= len(trace) - 1:
        return None
    return float((trace.x[-1] - trace.x[half]) / (trace.t[-1] - trace.t[half]))


def half_cycles(trace: Trajectory, swing: float) -> int:
    """Half-cycles until rest: runs of one sign of v whose peak speed is above ``swing`` (m/s).

    Good: the exact number.
    """
    fast = trace.v[np.abs(trace.v) > swing]
    return int(np.count_nonzero(np.diff(np.sign(fast)))) + 1 if fast.size else 0


def reversal_lead_s(trace: Trajectory, slider: Slider) -> float | None:
    """By how much the friction force reverses before the speed does, in s: the mean over all reversals.

    Friction is what x, v, a leave over, -(m a + c v + k x). Where both change sign between the same two samples neither
    is seen to lead, and that reversal counts as 0; else each crossing is interpolated, to half a step. None without
    friction or reversals. Good: 0.
    """
    if slider.f_k == 0.0:
        return None
    friction = -(slider.m * trace.a + slider.c * trace.v + slider.k * trace.x)
    reversals = _crossings(trace.t, trace.v)
    # the trace ends at rest, where neither has a sign of its own
    reversals = reversals[np.abs(np.interp(reversals, trace.t, trace.x)) > slider.x_s]
    flips = _crossings(trace.t, friction)
    if not reversals.size or not flips.size:
        return None
    nearest = flips[np.argmin(np.abs(flips[None, :] - reversals[:, None]), axis=1)]
    together = np.searchsorted(trace.t, nearest) == np.searchsorted(trace.t, reversals)
    return float(np.mean(np.where(together, 0.0, reversals - nearest)))


def _crossings(t: FloatArray, y: FloatArray) -> FloatArray:
    """Times at which ``y`` changes sign, by linear interpolation."""
    i = np.flatnonzero(y[:-1] * y[1:] < 0.0)
    on_sample = t[1:-1][(y[1:-1] == 0.0) & (y[:-2] * y[2:] < 0.0)]
    between: FloatArray = t[i] - y[i] * (t[i + 1] - t[i]) / (y[i + 1] - y[i])
    return np.sort(np.concatenate([between, on_sample]))


def energy_error(trace: Trajectory, slider: Slider) -> float | None:
    """Largest error of the energy balance m v^2/2 + k x^2/2 + losses = start, over the starting energy.

    The losses c v^2 + f_k |v| are integrated along the trace itself, to fourth order between reversals, so that this is
    the engine's own account and not its error of position. None for a start without energy. Good: below 1e-3.
    """
    x, v, a, h = trace.x, trace.v, trace.a, np.diff(trace.t)
    energy = 0.5 * slider.m * v**2 + 0.5 * slider.k * x**2
    if energy[0] == 0.0:
        return None
    # trapezium with the end correction h^2/12 (f'_0 - f'_1), f = v^2
    squares = 0.5 * h * (v[:-1] ** 2 + v[1:] ** 2) + h**2 / 6.0 * (v[:-1] * a[:-1] - v[1:] * a[1:])
    path = np.abs(np.diff(x))
    turns = np.flatnonzero((v[:-1] * v[1:] < 0.0) & (a[:-1] != 0.0) & (a[1:] != 0.0))
    path[turns] = v[turns] ** 2 / np.abs(2.0 * a[turns]) + v[turns + 1] ** 2 / np.abs(2.0 * a[turns + 1])
    lost = np.concatenate([[0.0], np.cumsum(slider.c * squares + slider.f_k * path)])
    return float(np.max(np.abs(energy + lost - energy[0])) / energy[0])


GRAVITY = 9.81
"""Gravity of the contact models, m/s^2."""


def measure_contact(trace: Trajectory, slider: Slider) -> dict[str, float | None]:
    """Every metric of the contact itself; empty for a trace without one."""
    if "normal_force" not in trace.extra:
        return {}
    return {
        "lift_m": lift_m(trace),
        "normal_error": normal_error(trace, slider),
        # largest coefficient of friction x speed / g in s: a cone solved as one lifts a box at its rate
        "mu_v_over_g_s": float(slider.f_k / (slider.m * GRAVITY) * np.max(np.abs(trace.v)) / GRAVITY),
    }


def lift_m(trace: Trajectory) -> float:
    """Largest height above where it rested at the start, m; a soft floor lets it rest below 0. Good: below 1e-6."""
    height = trace.extra["lift"]
    return float(np.max(height) - height[0])


def normal_error(trace: Trajectory, slider: Slider) -> float:
    """Largest |N/(m g) - 1|. Good: below 1e-3; 1 means that the box leaves the floor."""
    return float(np.max(np.abs(trace.extra["normal_force"] / (slider.m * GRAVITY) - 1.0)))


WIDE, NARROW = "acceleration", "acceleration-local"
"""Read outside a guard on each side of a reversal, and at the reversal itself."""


def recovered(trace: Trajectory, scenario: Scenario) -> dict[str, float | None]:
    """What the estimators read against what was put in; None where they refuse.

    Good: x_k_rel_error and zeta_rel_error below 1e-3. x_k_local_rel_error near 0 means that friction jumps at the
    reversal; near -1, that the engine spreads the jump so far that a sample before and one after do not see it.
    """
    slider = scenario.slider
    try:
        estimates = estimate_all(trace.t, trace.x, trace.v, trace.a)
    except InputError:  # nothing that an estimator could read
        return dict.fromkeys(("x_k_m", "zeta", "x_k_local_m"))
    x_k, local = _x_k(estimates, WIDE), _x_k(estimates, NARROW)
    zeta = estimates[WIDE].zeta.value
    found = {"x_k_m": x_k, "zeta": zeta, "x_k_local_m": local}
    if slider.zeta > 0.0:
        found["zeta_rel_error"] = None if zeta is None else zeta / slider.zeta - 1.0
    if slider.x_k > 0.0:
        found["x_k_rel_error"] = None if x_k is None else x_k / slider.x_k - 1.0
        found["x_k_local_rel_error"] = None if local is None else local / slider.x_k - 1.0
    return found


def _x_k(estimates: Estimation, method: str) -> float | None:
    return estimates[method].x_k.value
