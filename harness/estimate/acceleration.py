"""Method acceleration: jumps of the acceleration seen from both sides, a guard left out, everything weighted.

Where the whole decay is one motion of the base model, that is what is fitted: each half-cycle obeys a known linear
equation, the jump ties it to the next (Liang, eqs. 6, 9 to 11), and least squares weights all of it by its covariance.
Where it is not (friction that reverses early or is smeared), half-cycles are fitted apart, the jumps between them give
x_k and the decay inside them zeta.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.estimate.channel import ChannelFit
from harness.estimate.jumps import Jumps, as_acceleration, combine, find_jumps
from harness.estimate.result import Estimate, Reversal, quantity, rates_to_modal
from harness.estimate.reversals import Kind
from harness.estimate.tied import OMEGA, SIGMA, D


def _rows(jumps: Jumps, omega_n: float, x_k: float, variance: float) -> tuple[Reversal, ...]:
    per = 0.5 / omega_n**2
    return tuple(
        Reversal(
            t=float(t),
            x=float(-after / omega_n**2 - math.copysign(x_k, after)),
            a_before=float(before),
            a_after=float(after),
            x_k=float(size * per),
            stderr=math.sqrt(max(float(var) * variance, 0.0)) * per,
        )
        for t, before, after, size, var in zip(
            jumps.t, jumps.before, jumps.after, jumps.size, jumps.variance, strict=True
        )
    )


def acceleration(fit: ChannelFit, unit: str = "m") -> Estimate:
    """omega_n, zeta and x_k (in ``unit``) from the fit of an acceleration, or of a speed."""
    notes: list[str] = []
    if fit.kind is Kind.VELOCITY:
        notes.append("from the speed: the acceleration is the derivative of the form fitted to it")
    if fit.offset:
        notes.append(f"a constant of {fit.offset:.4g} was found in the channel and taken away")
    separate = as_acceleration(fit.separate)
    return (_from_tied if fit.holds else _from_jumps)(
        fit, find_jumps(separate, fit.cycles.side, not fit.holds), unit, notes
    )


def _from_tied(fit: ChannelFit, jumps: Jumps, unit: str, notes: list[str]) -> Estimate:
    theta, covariance = fit.tied.theta, fit.tied.covariance * fit.variance
    modal = rates_to_modal(fit.sigma, fit.omega, covariance[:2, :2])
    omega_n, x_k = modal[0], float(theta[D]) / modal[0] ** 2
    gradient = np.zeros(theta.size)
    gradient[[SIGMA, OMEGA, D]] = -2.0 * x_k * fit.sigma / omega_n**2, -2.0 * x_k * fit.omega / omega_n**2, omega_n**-2
    spread = math.sqrt(max(float(gradient @ covariance @ gradient), 0.0))
    return Estimate(
        quantity(omega_n, modal[1], "rad/s"),
        quantity(modal[2], modal[3], "1"),
        quantity(x_k, spread, unit),
        fit.tied.count - 1,
        _rows(jumps, omega_n, x_k, fit.variance),
        guard=fit.guard,
        notes=tuple(notes),
    )


def _from_jumps(fit: ChannelFit, jumps: Jumps, unit: str, notes: list[str]) -> Estimate:
    separate, variance = fit.separate, fit.variance
    rates = separate.rates * variance
    omega_n, omega_error, zeta, zeta_error = rates_to_modal(separate.sigma, separate.omega, rates)
    common = combine(jumps, variance)
    x_k = 0.5 * common.size / omega_n**2
    by_rates: FloatArray = 0.5 * common.by_rates / omega_n**2
    by_rates = by_rates - 2.0 * x_k / omega_n**2 * np.array([separate.sigma, separate.omega])
    spread = 0.25 * common.variance * max(common.scatter, 1.0) / omega_n**4 + float(by_rates @ rates @ by_rates)
    weights = 1.0 / np.maximum(jumps.variance, 1e-300)
    lead = float(np.median(jumps.lead))
    notes.append(
        "the half-cycles are not one motion of the base model: jumps were read one by one, standard errors hold for"
        " what these jumps have in common"
    )
    lead_error = float(np.std(jumps.lead)) / math.sqrt(jumps.lead.size) if weights.size > 1 else math.inf
    return Estimate(
        quantity(omega_n, omega_error, "rad/s"),
        quantity(zeta, zeta_error, "1"),
        quantity(x_k, math.sqrt(max(spread, 0.0)), unit),
        jumps.t.size,
        _rows(jumps, omega_n, x_k, variance),
        guard=fit.guard,
        lead=quantity(lead, lead_error, "s"),
        notes=tuple(notes),
    )
