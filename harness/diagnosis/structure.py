"""Does anything but noise stay in a fit? The calibrated test of lackfit, on a fit."""

from harness.core.events import Mode
from harness.diagnosis.fit import Fit
from harness.diagnosis.lackfit import LackOfFit, lack_of_fit
from harness.diagnosis.motion import Motion
from harness.diagnosis.problem import Problem

SIGNIFICANT = 1e-3
"""Chance of structure in noise alone from which a model is said not to explain a recording."""


def structure(found: Fit, problem: Problem, omega: float) -> LackOfFit:
    """Structure left in a fit's residual, its own parameters allowed for."""
    n = problem.t.size
    parts = {c: slice(i * n, (i + 1) * n) for i, c in enumerate(problem.channels)}
    motion = Motion(found.shown.x, found.shown.v, found.shown.mode == Mode.STICK, omega)
    return lack_of_fit(
        {c: found.residual[at] for c, at in parts.items()},
        problem.t,
        omega,
        jacobian={c: found.jacobian[at] for c, at in parts.items()},
        motion=motion,
    )


def explains(found: Fit, problem: Problem, omega: float) -> bool:
    """Whether nothing but noise stays."""
    return structure(found, problem, omega).p_value > SIGNIFICANT
