"""A mass that the force does not show: taken as so large as it could be unseen, for a motion that can be simulated.

What is left out may look like a mass, so that the law which says the force best is asked beside the base model.
"""

from dataclasses import replace

import numpy as np

from harness.diagnosis.inverse_dynamics.force_fit import ROUGHLY
from harness.diagnosis.inverse_dynamics.search import extended, force_baseline
from harness.diagnosis.problems.inverse_dynamics import InverseDynamics
from harness.diagnosis.rules import MASS_UNSEEN


def with_unseen_mass(problem: InverseDynamics) -> InverseDynamics:
    """The problem with its mass given where the fitted one accelerates with less force than any fit could tell.

    Without this the fit of a slow axis ends at no mass at all, and its motion cannot be simulated. Raises
    SimulationError when little moves or the base model cannot be fitted.
    """
    if not problem.mass_names:
        return problem
    measured, base, scales = force_baseline(problem)
    a = float(np.sqrt(np.mean(measured.blocks(measured.a) ** 2)))
    if a <= 0.0:
        return problem
    best = min((base, *extended(base, measured, problem, scales, ROUGHLY)), key=lambda found: found.squares)
    mass = MASS_UNSEEN.value * float(np.sqrt(np.mean(best.residual**2))) / a
    if best.model.m >= mass:
        return problem
    said = (
        f"The force does not show the mass: {mass:.3g} kg are taken, whose part of the force is"
        f" {100.0 * MASS_UNSEEN.value:.2g} % of what the fit leaves; --mass KG gives another."
    )
    first = replace(base.model, m=mass)
    return replace(problem, mass=mass, first=first, enters=(*problem.enters, said))
