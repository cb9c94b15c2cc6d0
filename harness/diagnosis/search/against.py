"""What speaks against a model, by which models of one recording are held against each other."""

from collections.abc import Sequence

import numpy as np

from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.force_noise import FAR


def against(found: Fit, problem: Problem) -> float:
    """BIC; beside a force whose noise moves reversals a sample far out is far out, and no further.

    Such noise puts single samples on the other side of a jump of the acceleration, and whatever law moves that reversal
    puts them back. What it may leave (``Problem.spare``) is drawn with the same bound.
    """
    if problem.spare <= 0.0:
        return found.bic
    return found.bic - far_out(found)


def far_out(found: Fit) -> float:
    """Chi-square of single samples beyond what one that is far out says."""
    return float(np.sum(np.maximum(found.residual**2 - FAR**2, 0.0)))


def in_turn(fits: Sequence[Fit], problem: Problem) -> tuple[Fit, ...]:
    """The one that least speaks against first."""
    return tuple(sorted(fits, key=lambda f: against(f, problem)))
