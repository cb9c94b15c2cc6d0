"""All estimators on one recording: arrays in, a figure or a reason out for every method."""

import math
from collections.abc import Mapping

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.checks import increasing, vector
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.estimate.acceleration import acceleration, acceleration_local, as_acceleration
from harness.estimate.channel import ChannelFit, fit_channel
from harness.estimate.displacement import (
    all_edges,
    displacement,
    first_and_last_seen,
    half_cycle_frequency,
    reversal_times,
    turning_points,
)
from harness.estimate.noise import channel_noise
from harness.estimate.paper import ASSUMED, acceleration_paper, isolated
from harness.estimate.result import Estimate, Estimation, quantity
from harness.estimate.reversals import Kind, NoDecay
from harness.estimate.tied import OFFSET, OMEGA, T0


def _time_error(fit: ChannelFit, index: float) -> float:
    """Variance of the reversal time at (fractional) ``index`` in a tied fit, s^2."""
    covariance = fit.tied.covariance[np.ix_([T0, OMEGA], [T0, OMEGA])] * fit.variance
    gradient = np.array([1.0, -index * math.pi / fit.omega**2])
    return max(float(gradient @ covariance @ gradient), 0.0)


def sensor_lead(acceleration: ChannelFit, displacement: ChannelFit) -> tuple[Quantity, float]:
    """Phase lead of the accelerometer in rad, and the same in s: x is late against a by that time.

    Each channel is fitted with reversals of its own; the lead is how far theirs are apart. Methods that read one
    channel at that channel's own reversals need no further correction: this is how the lead is removed.
    """
    ours, theirs = reversal_times(acceleration), reversal_times(displacement)
    half = math.pi / acceleration.omega
    gaps, index = [], []
    for i, time in enumerate(ours):
        near = theirs[np.argmin(np.abs(theirs - time))]
        if abs(near - time) < 0.45 * half:
            gaps.append(float(near - time))
            index.append(i + 1.0)
    if not gaps:
        return Quantity.refused("rad", "the two channels have no reversal in common"), 0.0
    if acceleration.holds and displacement.holds:
        middle = float(np.mean(index))
        error = math.sqrt(_time_error(acceleration, middle) + _time_error(displacement, middle))
        lag = float(np.mean(gaps))
    else:
        lag = float(np.median(gaps))
        error = float(np.std(gaps)) / math.sqrt(len(gaps)) if len(gaps) > 1 else math.inf
    return quantity(acceleration.omega * lag, acceleration.omega * error, "rad"), lag


METHODS = ("acceleration", "acceleration-local", "acceleration-paper", "displacement", *ASSUMED)

KINDS = {"x": Kind.DISPLACEMENT, "v": Kind.VELOCITY, "a": Kind.ACCELERATION}
_FEWEST = 16
_CLEARLY = 5.0
"""Standard errors from which x has a zero of its own."""
_DIGITS = 1e-12
"""Share of an amplitude that sixteen digits leave to a fit, at best: no standard error claims more."""


def _checked(t: object, channels: dict[str, object]) -> tuple[FloatArray, dict[str, FloatArray]]:
    time = vector("t", t)
    increasing("t", time)
    if time.size < _FEWEST:
        raise InputError("t", f"{time.size} samples", f"at least {_FEWEST}")
    found = {name: vector(name, values, time.size) for name, values in channels.items() if values is not None}
    if not any(name in KINDS for name in found):
        raise InputError("channels", "none of x, v, a", "at least one of them")
    return time, found


def _all_refused(why: str, unit: str) -> dict[str, Estimate]:
    return {method: Estimate.refused(why, unit) for method in METHODS}


def _frequency(fit: ChannelFit) -> tuple[float, float]:
    return half_cycle_frequency(fit, np.concatenate([[math.nan], reversal_times(fit), [math.nan]]))


def sizes(fit: ChannelFit) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Times, turning points and variances for the isolated cases; from the acceleration after each jump when x is
    absent.
    """
    if fit.kind is Kind.DISPLACEMENT:
        points = turning_points(fit)
        times, turning, variance = points.merged()
        known = np.isfinite(turning)
        return times[known], turning[known] - _zero(fit), variance[known]
    separate = as_acceleration(fit.separate)
    keep = separate.known
    keep[0] &= first_and_last_seen(fit)[0]
    basis = separate.basis(np.arange(len(separate)), separate.edges[:-1])
    value = np.sum(basis * separate.c, axis=1)
    variance = np.einsum("ki,kij,kj->k", basis, separate.inverse, basis) * fit.variance
    per = -1.0 / (fit.sigma**2 + fit.omega**2)
    return separate.edges[:-1][keep], value[keep] * per, variance[keep] * per * per


def _zero(fit: ChannelFit) -> float:
    """What the sensor of x shows at rest without friction, where the fit of the whole says that it is not nought."""
    zero, variance = float(fit.tied.theta[OFFSET]), float(fit.tied.covariance[OFFSET, OFFSET]) * fit.variance
    return zero if fit.holds and abs(zero) > _CLEARLY * math.sqrt(max(variance, 0.0)) else 0.0


def _acceleration_methods(
    fits: dict[str, ChannelFit], t: FloatArray, found: dict[str, FloatArray], whys: dict[str, str], unit: str
) -> dict[str, Estimate]:
    source = fits.get("a", fits.get("v"))
    if source is None:
        why = (
            whys.get("a")
            or whys.get("v")
            or "the acceleration (or the speed) is needed, only the displacement was given"
        )
        return {method: Estimate.refused(why, unit) for method in METHODS[:3]}
    out = {"acceleration": acceleration(source, unit)}
    if "a" not in found:
        why = "samples of the acceleration are needed, only the speed was given"
        return out | {method: Estimate.refused(why, unit) for method in METHODS[1:3]}
    # the speed, where it was measured, shows the reversals more directly than the acceleration does
    clock = fits.get("v", source)
    edges, omega_d = all_edges(clock), _frequency(source)
    # one fit's constant is a property of the sensor, not of the motion
    a = found["a"] - source.offset if source.kind is Kind.ACCELERATION else found["a"]
    noise = source.recorded if source.kind is Kind.ACCELERATION else channel_noise(t, a, 2.0 * math.pi / source.omega)
    out["acceleration-local"] = acceleration_local(
        t, a, noise.sigma, edges, first_and_last_seen(clock), clock.cycles.side, omega_d, source.sigma, unit
    )
    out["acceleration-paper"] = acceleration_paper(t, a, edges, omega_d, unit=unit)
    return out


def _displacement_methods(fits: dict[str, ChannelFit], whys: dict[str, str], unit: str) -> dict[str, Estimate]:
    why = whys.get("x", "the displacement is needed and was not given")
    out = {"displacement": displacement(fits["x"], unit) if "x" in fits else Estimate.refused(why, unit)}
    source = next(fits[name] for name in ("x", "a", "v") if name in fits)
    turning, omega_d = sizes(source), _frequency(source)
    return out | {method: isolated(method, *turning, omega_d, unit) for method in ASSUMED}


def _warnings(t: FloatArray, fits: dict[str, ChannelFit]) -> list[str]:
    said = []
    gaps = np.diff(t)
    usual = float(np.median(gaps))
    wide = np.flatnonzero(gaps > 3.0 * usual)
    if wide.size:
        said.append(f"{wide.size} gap{'s' if wide.size > 1 else ''} in time, the longest {gaps.max():.4g} s")
    elif gaps.max() > 1.05 * usual or gaps.min() < 0.95 * usual:
        said.append("sampling is irregular")
    for name, fit in fits.items():
        if fit.dropped:
            said.append(f"{name}: the first period was skipped")
        beyond = (fit.variance / fit.inflation - fit.noise.sigma**2) / fit.recorded.sigma**2
        ratio = math.sqrt(max(1.0 + beyond, 0.0))
        if fit.noise.found and ratio > 1.5:
            said.append(
                f"{name}: viscous and Coulomb friction leave {ratio:.1f} times the noise unexplained;"
                " standard errors are those of the misfit and can be too small"
            )
    return said


def estimate_all(
    t: object,
    x: object = None,
    v: object = None,
    a: object = None,
    u: object = None,
    *,
    drop_first: bool = False,
    unit: str = "m",
) -> Estimation:
    """Run every estimator on the channels there are.

    t : (n,) s, increasing. x : m (or ``unit``). v : m/s. a : m/s^2. u : applied force; any of them (n,) or None.
    drop_first : leave out the first period, which a release by hand distorts.

    A method that cannot answer holds refused quantities with the reason. Raises InputError for arrays that are no
    channels: other lengths, values not finite, time that does not increase, no channel at all.
    """
    time, found = _checked(t, {"x": x, "v": v, "a": a, "u": u})
    if "u" in found and np.any(found["u"] != 0.0):
        why = "a force acts on the slider: this is no free decay"
        return Estimation(_all_refused(why, unit), Quantity.refused("rad", why), warnings=(why,))
    fits: dict[str, ChannelFit] = {}
    whys: dict[str, str] = {}
    for name, kind in KINDS.items():
        if name in found:
            try:
                fits[name] = fit_channel(time, found[name], kind, drop_first)
            except NoDecay as reason:
                whys[name] = f"{name}: {reason}"
    if not fits:
        why = "; ".join(whys.values())
        return Estimation(_all_refused(why, unit), Quantity.refused("rad", why), warnings=(why,))
    methods = _acceleration_methods(fits, time, found, whys, unit) | _displacement_methods(fits, whys, unit)
    phase, lag = Quantity.refused("rad", "needs both an acceleration and a displacement"), 0.0
    if "a" in fits and "x" in fits:
        phase, lag = sensor_lead(fits["a"], fits["x"])
    best = next(fits[name] for name in ("v", "a", "x") if name in fits)
    estimation = Estimation(
        methods,
        phase,
        lag,
        {name: fit.recorded for name, fit in fits.items()},
        all_edges(best),
        (*whys.values(), *_warnings(time, fits)),
    )
    return estimation.floored(*_rounding(fits))


def _rounding(fits: Mapping[str, ChannelFit]) -> tuple[float, float]:
    """Share of an amplitude that rounding hides, more where it is small beside an offset; the amplitude, m."""
    shares, sizes = [], []
    for name, fit in fits.items():
        half = 0.5 * float(np.ptp(fit.y))
        shares.append(_DIGITS * float(np.max(np.abs(fit.y + fit.offset))) / half)
        sizes.append(half / fit.omega ** {"x": 0, "v": 1, "a": 2}[name])
    return max(shares), max(sizes)
