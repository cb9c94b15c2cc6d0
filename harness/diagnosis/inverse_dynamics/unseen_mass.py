"""A mass that the force does not show: taken as so large as it could be unseen, for a motion that can be simulated."""

from dataclasses import replace

import numpy as np

from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.inverse_dynamics.force_fit import fit_force
from harness.diagnosis.inverse_dynamics.measured import Measured
from harness.diagnosis.problems.inverse_dynamics import InverseDynamics
from harness.diagnosis.rules import MASS_UNSEEN


def with_unseen_mass(problem: InverseDynamics) -> InverseDynamics:
    """The problem with its mass given where the fitted one accelerates with less force than any fit could tell.

    Without this the fit of a slow axis ends at no mass at all, and its motion cannot be simulated. Raises
    SimulationError when little moves or the base model cannot be fitted.
    """
    if not problem.mass_names:
        return problem
    measured = Measured.of(problem)
    base = fit_force(problem.first, measured, free_of(problem.first, problem.base_names))
    a = float(np.sqrt(np.mean(measured.blocks(measured.a) ** 2)))
    least = MASS_UNSEEN.value * float(np.sqrt(np.mean(base.residual**2)))
    if a <= 0.0 or base.model.m * a >= least:
        return problem
    mass = least / a
    said = (
        f"The force does not show the mass: {mass:.3g} kg are taken, whose part of the force is"
        f" {100.0 * MASS_UNSEEN.value:.2g} % of what the fit leaves; --mass KG gives another."
    )
    first = replace(base.model, m=mass)
    return replace(problem, mass=mass, first=first, enters=(*problem.enters, said))
