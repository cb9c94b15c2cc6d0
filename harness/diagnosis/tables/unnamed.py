"""Whether a smooth curve of no name says as much of a recording as the names that were found.

A law that nobody knows is followed in part by one or another of the catalogue, and by two laws of the same variable to
the noise; a table follows all of it.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from harness.diagnosis.baseline.words import margin_of, strokes_of, words_of
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.grading.contest import decided, shown_as_part
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.grading.misfit import Misfit
from harness.diagnosis.outcome import Grade
from harness.diagnosis.parameters import base_of
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.rules import APART, MARGIN
from harness.diagnosis.search.search import Search
from harness.diagnosis.tables.basis import OF_FRICTION, OF_PLACE, OF_SPEED, Rung
from harness.diagnosis.tables.beside import MotionLeft
from harness.diagnosis.tables.fitted import TableFit
from harness.kernels.solve import Scales
from harness.model.term import Slot, Term


def beside_curves(graded: Graded) -> Graded:
    """The grades of a motion's misfit beside a smooth curve: what is named, or listed, may then be neither.

    A crowd of small effects is no reason to doubt a law: a curve has to say more than the law with a curve of what the
    law is not of.
    """
    if graded.grade not in (Grade.MAIN, Grade.ONE_OF):
        return graded
    misfit, first = graded.misfit, graded.named[0].fit
    noise, law = misfit.noise_left(first), first.model.terms[-1].term
    without = misfit.base
    # what friction does along the way has that name in any shape; a sum of two curves is two effects
    of_friction = () if law.slot is Slot.FRICTION_MODULATION else OF_FRICTION
    curves = _fitted(misfit, without, (*OF_PLACE, *OF_SPEED, *of_friction))
    said = max((misfit.evidence_by(c.squares, c.effective, noise) for c in curves), default=-math.inf)
    by_law = misfit.evidence_of(first, noise)
    if said > by_law:
        numbers = len(first.free) - len(without.free)
        others = _fitted(misfit, first, _OF_ANOTHER[_variable(law)])
        besides = (misfit.evidence_by(c.squares, numbers + c.effective, noise) for c in others)
        by_law = max((by_law, *besides))
    seen = replace(graded, ahead=said - by_law - margin_of(misfit.words))
    again = decided(seen)
    if (again.grade, [f.name for f in again.named]) == (graded.grade, [f.name for f in graded.named]):
        return seen
    as_seen = {f.name: f for f in graded.named}
    named = tuple(as_seen.get(f.name, f) for f in again.named)
    return shown_as_part(replace(again, named=named, rules=(*again.rules, MARGIN)))


def beside_one_curve(found: Search, scales: Scales) -> Search:
    """A search whose laws are all of the speed, or all of the place, as one that explains nothing unless they stand
    apart from a smooth curve of it.

    Two such laws add up to one curve, and follow many that are no sum of theirs. What friction does along the way has
    the name of that in any shape.
    """
    terms = found.chosen.model.terms
    variables = {_variable(entry.term) for entry in terms}
    if len(terms) == 1 or len(variables) != 1 or found.by_force or found.left is Left.STRUCTURE:
        return found
    variable = variables.pop()
    problem, strokes = found.problem, strokes_of(found.chosen, found.problem)
    whole = Misfit(
        problem, found.base, problem.noise, problem.force_noise, scales, strokes, words_of(strokes), left_out=0.0
    )
    known = math.log(problem.points)
    fitted = _fitted(whole, found.base, _OF[variable])
    curves = [curve.squares + (len(curve.free) + curve.effective) * known for curve in fitted]
    if min(curves, default=math.inf) >= found.chosen.bic + APART.value:
        return found
    return replace(found, chosen=found.base, left=Left.STRUCTURE, without=(), doubted=found.chosen, doubted_by=variable)


def _fitted(misfit: Misfit, beside: Fit, rungs: Sequence[Rung]) -> list[TableFit]:
    """Tables beside a model, as smooth as blocks of its strokes say; those that can be simulated."""
    left = MotionLeft(misfit, beside.model, base_of(beside.free))
    return [curve for curve in map(left.fitted, rungs) if curve is not None]


def _variable(law: Term) -> str:
    """Of what alone a law's force is, "" where it is of more, or of something else."""
    if law.changes_in_time or law.slot not in (Slot.SMOOTH, Slot.FRICTION_LEVEL):
        return ""
    return "speed" if law.slot is Slot.FRICTION_LEVEL or law.family == "damping" else "position"


_OF: Mapping[str, tuple[Rung, ...]] = {"position": OF_PLACE, "speed": OF_SPEED, "": ()}
"""Tables of one variable."""
_OF_ANOTHER: Mapping[str, tuple[Rung, ...]] = {"position": OF_SPEED, "speed": OF_PLACE, "": ()}
"""Tables of the other variable."""
