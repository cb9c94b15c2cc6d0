"""A graded misfit, said: fits under the sensors' noise, mechanisms with shares and predictions, what is left."""

from dataclasses import dataclass

import numpy as np

from harness.diagnosis.explain.mechanism import statement_of
from harness.diagnosis.explain.remainder import remainder
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.place import place_of
from harness.diagnosis.fit.standard_errors import term_parameters
from harness.diagnosis.grading.grade import Finalist, Graded, worthy
from harness.diagnosis.grading.prediction import Predicted
from harness.diagnosis.outcome import Alternative, Grade, Holdout, Mechanism, Prediction, Remainder, Tried
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import DECISIVE
from harness.diagnosis.search.search import under
from harness.model.registry import not_parted

_MOST_ALTERNATIVES = 3
"""Names beside a main effect."""


@dataclass(frozen=True, slots=True)
class Told:
    """What an outcome says of a graded misfit; see Outcome."""

    problem: Problem
    base: Fit
    refined: Fit
    mechanisms: tuple[Mechanism, ...]
    holdout: Holdout
    remainder: Remainder
    evidence: tuple[Tried, ...]


def told(graded: Graded) -> Told:
    """Everything seen with the sensors' noise, which the best model found leaves."""
    misfit = graded.misfit
    best = graded.named[0].fit if graded.named else misfit.base
    problem = misfit.sensed(misfit.noise_left(best))
    base = under(misfit.base, problem)
    refined = base if best is misfit.base else under(best, problem)
    mechanisms = tuple(_mechanism(f, graded, base, problem) for f in graded.named)
    first = mechanisms[0].held_out if mechanisms else None
    held = Holdout((), {}, {}) if first is None else Holdout(first.spans, first.baseline_rmse, first.refined_rmse)
    floor = float(base.points)
    evidence = tuple(Tried(f.name, base.bic - under(f.fit, problem).bic, f.share) for f in graded.finalists)
    return Told(problem, base, refined, mechanisms, held, remainder(base, refined, problem, floor), evidence)


def _mechanism(finalist: Finalist, graded: Graded, base: Fit, problem: Problem) -> Mechanism:
    seen = under(finalist.fit, problem)
    index = len(seen.model.terms) - 1
    entry, omega = seen.model.terms[index], graded.misfit.scales.omega
    parameters = term_parameters(seen, problem, index, omega, explained=False)
    assert graded.grade is not None
    return Mechanism(
        entry=entry,
        statement=statement_of(entry, parameters, seen),
        parameters=parameters,
        delta_bic=base.bic - seen.bic,
        place=place_of(entry, seen, problem, omega),
        alternatives=_alternatives(finalist, graded) if graded.grade is Grade.MAIN else (),
        grade=graded.grade,
        share=finalist.share,
        held_out=prediction(graded.base_held, finalist.held),
        forward=prediction(graded.base_run, finalist.run),
        chance=graded.chance if finalist is graded.named[0] else None,
    )


def _alternatives(first: Finalist, graded: Graded) -> tuple[Alternative, ...]:
    """Names that are near, and those that this recording cannot part from the first whatever their evidence says.

    A law of the amplitude and one of the time follow one decay alike, to the shape that small effects give it.
    """
    others = [f for f in graded.finalists if f is not first and not f.clock]
    found = [Alternative(f.name, first.gain - f.gain) for f in others]
    parted = graded.misfit.problem.parts_amplitude_from_time
    twins = {f.name for f in others if not parted and worthy(f, graded) and not_parted(first.name, f.name)}
    listed = [a for a in found if a.delta_bic < DECISIVE.value or a.name in twins]
    return tuple(sorted(listed, key=lambda a: a.name not in twins))[:_MOST_ALTERNATIVES]


def prediction(before: Predicted | None, after: Predicted | None) -> Prediction | None:
    """What two models miss of the same blocks, as results say it."""
    if before is None or after is None:
        return None
    ratios = after.by_span / np.maximum(before.by_span, 1e-300)
    return Prediction(before.spans, before.rmse, after.rmse, tuple(float(r) for r in ratios))
