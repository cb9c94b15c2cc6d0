"""Several driven recordings of one machine made ready as one problem, whose force is fitted."""

from collections.abc import Sequence
from dataclasses import replace

from harness.core.errors import InputError, SimulationError
from harness.core.recording import Recording
from harness.diagnosis.inverse_dynamics.held import as_it_acts
from harness.diagnosis.inverse_dynamics.measured import BLOCK
from harness.diagnosis.inverse_dynamics.unseen_mass import with_unseen_mass
from harness.diagnosis.prepare.driven import forced_problem
from harness.diagnosis.prepare.together import in_common
from harness.diagnosis.problems.forces_together import ForcesTogether
from harness.diagnosis.problems.inverse_dynamics import InverseDynamics
from harness.diagnosis.request import Asked
from harness.model.model import Restoring

_BY_FORCE = "driven, several: the force of all is fitted at once, whether or not the motion of each could be followed"


def forces_together(recordings: Sequence[Recording], asked: Asked) -> tuple[ForcesTogether, tuple[str, ...]]:
    """Driven recordings as one problem, and what was done to each, one sentence each.

    On a spring each has a zero of its own, unless that is given. Raises InputError for fewer than two, for free decays
    among them, for those that have no channel in common or hardly move; SimulationError.
    """
    common = in_common(recordings)
    spring = (asked.restoring or Restoring.SPRING) is not Restoring.NONE
    # smoothing rounds off reversals, of which each recording has its own share
    alike = replace(asked, guarded=True, zero_free=spring if asked.zero_free is None else asked.zero_free)
    notes, each = [_BY_FORCE], []
    for one in recordings:
        problem, done = _alone(one, alike, common)
        each.append(problem)
        notes += [f"in {one.file}: {note}" for note in done]
        left_out = [c for c in ("x", "v", "a") if c in one and c not in common]
        notes += [f"in {one.file}: {c} is left out, which not every recording has" for c in left_out]
    laid = ForcesTogether.laid(each)
    known = with_unseen_mass(laid)
    if known.mass is not None and known.mass != laid.mass:
        laid = laid.with_mass(known.mass, known.first, known.enters)
    return laid, tuple(notes)


def _alone(recording: Recording, asked: Asked, common: Sequence[str]) -> tuple[InverseDynamics, tuple[str, ...]]:
    seen = {c: y for c, y in recording.channels.items() if c in (*common, "u")}
    problem, notes = forced_problem(replace(recording, channels=seen), asked)
    # whole blocks, so that none reaches over the seam
    problem = problem.part(slice(0, problem.t.size // BLOCK * BLOCK))
    try:
        problem, said = as_it_acts(problem, recording["u"][: problem.t.size])
    except SimulationError as error:
        accepted = "recordings in which the slider moves most of the time are accepted"
        raise InputError(recording.file, str(error), accepted) from error
    return problem, (*notes, *said)
