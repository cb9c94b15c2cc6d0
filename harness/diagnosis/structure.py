"""Does anything but noise stay in a fit? The calibrated test of lackfit, on a fit."""

from harness.core.events import Mode
from harness.diagnosis.fit import Fit
from harness.diagnosis.lackfit import LackOfFit, lack_of_fit
from harness.diagnosis.motion import Motion
from harness.diagnosis.problem import Problem

SIGNIFICANT = 1e-3
"""Chance of structure in noise alone from which a model is said not to explain a recording."""


NAMED = 5e-3
"""The same for a model that names something: what mimics another effect shows little of it."""


def structure(found: Fit, problem: Problem, omega: float, gain: float = 0.0) -> LackOfFit:
    """Structure left in a fit's residual, its own parameters allowed for; gain : chi-square its terms explain."""
    n = problem.t.size
    parts = {c: slice(i * n, (i + 1) * n) for i, c in enumerate(problem.channels)}
    motion = Motion(found.shown.x, found.shown.v, found.shown.mode == Mode.STICK, omega)
    return lack_of_fit(
        {c: found.residual[at] for c, at in parts.items()},
        problem.t,
        omega,
        jacobian={c: found.jacobian[at] for c, at in parts.items()},
        motion=motion,
        gain=gain,
    )


def explains(found: Fit, problem: Problem, omega: float, base: Fit) -> bool:
    """Whether nothing but noise stays; base : the fit without terms under the same noise, which may be the fit."""
    gain = max(base.chi2 - found.chi2, 0.0)
    return structure(found, problem, omega, gain).p_value > (NAMED if found.model.terms else SIGNIFICANT)
