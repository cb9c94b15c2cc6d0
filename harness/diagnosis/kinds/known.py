"""The kinds of problem there are. A further kind is a file beside this one and a name here."""

from typing import Any

from harness.diagnosis.kinds.curve import Curves
from harness.diagnosis.kinds.driven import DrivenRecordings
from harness.diagnosis.kinds.free_decay import DecaysTogether, FreeDecays
from harness.diagnosis.kinds.inverse_dynamics import FittedForces, ForcesOfSeveral
from harness.diagnosis.kinds.kind import Kind
from harness.diagnosis.kinds.run_down import RunDowns, SeveralRunDowns
from harness.diagnosis.problem import Problem

_KINDS: tuple[Kind[Any], ...] = (
    DrivenRecordings(),
    FittedForces(),
    FreeDecays(),
    DecaysTogether(),
    ForcesOfSeveral(),
    RunDowns(),
    SeveralRunDowns(),
    Curves(),
)


def kind_of(problem: Problem) -> Kind[Any]:
    """The kind of a problem."""
    return next(kind for kind in _KINDS if type(problem) is kind.of)
