"""The kinds there are: of a recording, and of a problem. A further kind is a file beside this one and a line here."""

from typing import Any

from harness.core.recording import Recording
from harness.diagnosis.kinds.driven import DrivenRecordings
from harness.diagnosis.kinds.free_decay import DecaysTogether, FreeDecays
from harness.diagnosis.kinds.inverse_dynamics import FittedForces, ForcesOfSeveral
from harness.diagnosis.kinds.kind import Kind
from harness.diagnosis.problem import Problem

KINDS: tuple[Kind[Any], ...] = (DrivenRecordings(), FittedForces(), FreeDecays(), DecaysTogether(), ForcesOfSeveral())
"""The first one that suits a recording makes it ready."""


def kind_for(recording: Recording) -> Kind[Any]:
    """The kind that a recording is made ready as."""
    return next(kind for kind in KINDS if kind.suits(recording))


def kind_of(problem: Problem) -> Kind[Any]:
    """The kind of a problem."""
    return next(kind for kind in KINDS if type(problem) is kind.of)
