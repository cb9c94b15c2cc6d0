"""Where a named effect acts, by the motion of the fitted model that has it."""

from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import Problem
from harness.model.model import ModelTerm
from harness.model.term import Place, Seen


def place_of(entry: ModelTerm, found: Fit, problem: Problem, omega: float) -> Place:
    """Where a term of a fitted model acts; omega in rad/s."""
    return entry.term.place(entry.values, Seen(problem.t, found.shown.x, found.shown.y, omega))
