"""Whether a fitted force is held between samples: told by the force, where a servo makes the slider stick often.

A simulation from one start then hangs on every stick, and a torque that is right to its noise lets it stray.
"""

from dataclasses import replace

from harness.core.arrays import FloatArray
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.inverse_dynamics.force_fit import fit_force
from harness.diagnosis.inverse_dynamics.measured import Measured
from harness.diagnosis.prepare.intersample_hold import ACTS_HELD, held
from harness.diagnosis.problems.inverse_dynamics import InverseDynamics
from harness.diagnosis.rules import FORCE_HELD
from harness.kernels.solve import Drive


def as_it_acts(problem: InverseDynamics, u: FloatArray) -> tuple[InverseDynamics, tuple[str, ...]]:
    """The problem with its force u (n,) held, and a sentence that says so, where the base model leaves less of it so.

    Raises SimulationError where little moves.
    """
    stepped = held(problem.t, u)
    if _left(problem, stepped) < FORCE_HELD.value * _left(problem, problem.drive):
        return replace(problem, drive=stepped), (ACTS_HELD,)
    return problem, ()


def _left(problem: InverseDynamics, drive: Drive) -> float:
    """Sum of squares of the force that the base model leaves, N^2."""
    measured = Measured.of(replace(problem, drive=drive))
    return fit_force(problem.first, measured, free_of(problem.first, problem.base_names)).squares
