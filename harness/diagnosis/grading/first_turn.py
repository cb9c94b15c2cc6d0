"""Does a model explain what follows the first turning point, though none explains the whole? Then a hand was there.

A hand that moves the slider before it lets go, or takes long to, is no physics of the machine; the motion is free from
the first turning point on at the latest.
"""

from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.diagnosis.search.extend import extend, settle
from harness.diagnosis.search.search import Search, noise_of, search, under
from harness.kernels.solve import Scales


def after_first_turn(graded: Graded) -> tuple[Search, Scales, float] | None:
    """The search of what follows the first turning point, where it explains that; None where it does not.

    With what counts as ordinary in it, and the time left out, s. Raises SimulationError.
    """
    misfit = graded.misfit
    if misfit.left_out == 0.0:
        return None
    promising = [misfit.base, *(f.fit for f in graded.finalists[:1])]
    if not any(_explains(fit, graded) for fit in promising):
        return None
    problem = misfit.sensed(noise_of(misfit.base, misfit.sensed(misfit.noise), misfit.scales.omega))
    base = settle(under(misfit.base, problem), problem, misfit.scales)
    alone = extend(base, problem, misfit.scales, begun=[f.fit.model for f in graded.finalists])
    found = search(problem, base, misfit.scales, alone=alone)
    return (found, misfit.scales, misfit.left_out) if found.explained else None


def _explains(fit: Fit, graded: Graded) -> bool:
    """Whether a fit leaves noise alone, at the level that it leaves itself."""
    misfit = graded.misfit
    problem = misfit.sensed(noise_of(fit, misfit.sensed(misfit.noise), misfit.scales.omega))
    seen, base = under(fit, problem), under(misfit.base, problem)
    return left_by(seen, problem, misfit.scales.omega, base) is Left.NOISE
