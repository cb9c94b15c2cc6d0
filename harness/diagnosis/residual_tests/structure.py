"""Does anything but noise stay in a fit? The calibrated test of lack of fit decides, with no number of its own.

A table of speeds and forces may be too short for any look at its residual's frequencies, and a law with two numbers
follows many a curve. So a curve that is free stands beside each law: a cubic smoothing spline (Wahba 1978, J. R. Stat.
Soc. B 40, 364), whose straight part is viscous and Coulomb friction themselves, over the speed and over its logarithm,
alike in both directions and in each by itself. Its evidence is the mean over these and over its size.
"""

import math
from enum import Enum

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.events import Mode
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.motion import Motion
from harness.diagnosis.problem import Problem
from harness.diagnosis.residual_tests.lack_of_fit import LackOfFit, lack_of_fit
from harness.diagnosis.rules import LAW_KNOWN, STRUCTURE, STRUCTURE_NAMED


def structure(found: Fit, problem: Problem, omega: float, gain: float = 0.0) -> LackOfFit:
    """Structure left in a fit's residual, its own parameters allowed for; gain : chi-square its terms explain.

    What noise of a force leaves beyond first order is allowed for, where that could be simulated, and of what terms
    explain the little that no law is known to.
    """
    spare = (problem.spare if math.isfinite(problem.spare) else 0.0) + LAW_KNOWN.value * gain
    if not problem.moves:
        return _beside_a_curve(found, spare)
    n = problem.t.size
    parts = {c: slice(i * n, (i + 1) * n) for i, c in enumerate(problem.channels)}
    motion = Motion(found.shown.x, found.shown.v, found.shown.mode == Mode.STICK, omega)
    return lack_of_fit(
        {c: found.residual[at] for c, at in parts.items()},
        problem.t,
        omega,
        jacobian={c: found.jacobian[at] for c, at in parts.items()},
        motion=motion,
        spare=spare,
    )


def _beside_a_curve(found: Fit, spare: float) -> LackOfFit:
    """Of speeds that were held: whether a smooth curve of any shape says more of them than the fit."""
    more = max(evidence_of_curve(found) - spare, 0.0)
    p = math.exp(-0.5 * more)
    return LackOfFit(p, more, f"p = {p:.2g} against a smooth curve of the speed")


class Left(Enum):
    """What a model leaves of a recording."""

    NOISE = "noise"
    STRUCTURE = "structure"


def left_by(found: Fit, problem: Problem, omega: float, base: Fit) -> Left:
    """What a fit leaves; base : the fit without terms under the same noise, which may be the fit."""
    gain = max(base.chi2 - found.chi2, 0.0)
    level = STRUCTURE_NAMED if found.model.terms else STRUCTURE
    return Left.NOISE if structure(found, problem, omega, gain).p_value > level.value else Left.STRUCTURE


UNNAMED = "unnamed-curve"
"""What is missing where such a curve is."""
_WAVES = 24
"""Cosines of a curve, which fall with the square of their number as a spline's do: a spline within a hundredth."""
_SIZES = np.geomspace(0.3, 3000.0, 19)
"""Of a curve over the noise, each as likely: from what cannot be seen to what no table is good enough to show."""


def evidence_of_curve(found: Fit) -> float:
    """Twice the log of how much likelier held speeds are with a curve beside a model than with the model alone.

    What was fitted is fitted anew beside each curve, but for numbers on a bound. The level of the noise is known to
    neither (as Jeffreys has it), so that by chance alone this ratio of likelihoods is at least so large in one of as
    many tables (Gruenwald, de Heide and Koolen 2024, J. R. Stat. Soc. B 86, 1091).
    """
    inside = [f.lower < value < f.upper for f, value in zip(found.free, found.values, strict=True)]
    jacobian = found.jacobian[:, inside]
    size = np.linalg.norm(jacobian, axis=0)
    held = np.linalg.qr(jacobian[:, size > 0.0] / size[size > 0.0])[0]
    y = found.residual - held @ (held.T @ found.residual)
    free = y.size - held.shape[1]
    whole = float(y @ y)
    if free < 1 or whole <= 0.0:
        return 0.0
    each: list[float] = []
    for curve in _curves(found.shown.v):
        directions, sizes, _ = np.linalg.svd(curve - held @ (held.T @ curve), full_matrices=False)
        seen = (directions.T @ y) ** 2
        grown = 1.0 + (_SIZES[:, None] * sizes) ** 2
        left = np.maximum(whole - np.sum(seen * (1.0 - 1.0 / grown), axis=1), 1e-300)
        each += (free * np.log(whole / left) - np.sum(np.log(grown), axis=1)).tolist()
    best = max(each)
    return best + 2.0 * math.log(float(np.mean(np.exp(0.5 * (np.array(each) - best)))))


def _curves(v: FloatArray) -> list[FloatArray]:
    """Shapes (n, k) of unit size: over speed and over its logarithm, alike in both directions, or not."""
    fast, side, found = np.abs(v), np.sign(v)[:, None], []
    low, high = float(np.min(fast)), float(np.max(fast))
    waves = np.arange(1.0, min(_WAVES, v.size) + 1.0)
    for along in (fast / high, np.log(fast / low) / max(math.log(high / low), 1e-9)):
        one = math.sqrt(2.0) * np.cos(math.pi * np.outer(along, waves)) / waves**2
        found.append(side * one)
        if np.ptp(side) > 0.0:
            found.append(np.hstack((np.where(side > 0.0, one, 0.0), np.where(side < 0.0, one, 0.0))))
    return found
