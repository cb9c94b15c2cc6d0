"""Does anything but noise stay in a fit? The calibrated test of lack of fit decides, with no number of its own."""

import math
from enum import Enum

from harness.core.events import Mode
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.motion import Motion
from harness.diagnosis.problem import Problem
from harness.diagnosis.residual_tests.free_curve import evidence_of_curve
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
