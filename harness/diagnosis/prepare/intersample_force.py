"""Whether a fitted force is held between samples: told by the force, where a servo makes the slider stick often.

A simulation from one start then hangs on every stick, and a torque that is right to its noise lets it stray.
"""

from dataclasses import replace

from harness.core.arrays import FloatArray
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.inverse_dynamics.force_fit import fit_force
from harness.diagnosis.inverse_dynamics.measured import Measured
from harness.diagnosis.prepare.intersample_hold import Acting, held
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.rules import FORCE_HELD
from harness.kernels.solve import Drive


def acting_by_force(problem: Driven, u: FloatArray) -> Acting:
    """How the force u (n,) acts: held where the base model, fitted to the force, leaves less of it so.

    Raises SimulationError where little moves.
    """
    stepped = held(problem.t, u)
    straight, in_steps = (_left(problem, drive) for drive in (problem.drive, stepped))
    is_held = in_steps < FORCE_HELD.value * straight
    return Acting(stepped if is_held else problem.drive, is_held, False, problem.first)


def _left(problem: Driven, drive: Drive) -> float:
    """Sum of squares of the force that the base model leaves, N^2."""
    names = tuple(name for name in problem.base_names if name not in problem.starts.names)
    measured = Measured.of(replace(problem, drive=drive))
    return fit_force(problem.first, measured, free_of(problem.first, names)).squares
