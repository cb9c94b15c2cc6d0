"""From a prepared recording to an outcome: fit, search, decide, say."""

from contextlib import suppress
from dataclasses import replace

from harness.core.errors import SimulationError
from harness.diagnosis.explain.cautions import cautions, cautions_of_misfit
from harness.diagnosis.explain.graded import told
from harness.diagnosis.explain.holdout import forced, holdout
from harness.diagnosis.explain.mechanism import mechanism
from harness.diagnosis.explain.next_experiment import next_experiment
from harness.diagnosis.explain.place import place_of
from harness.diagnosis.fit.standard_errors import base_parameters
from harness.diagnosis.grading.grade import Graded, grade
from harness.diagnosis.grading.misfit import misfit
from harness.diagnosis.input_noise.noisy_base_fit import along
from harness.diagnosis.integrator_maps.maps import Stepping
from harness.diagnosis.integrator_maps.stepped import as_stepped
from harness.diagnosis.inverse_dynamics.holdout import holdout_windows
from harness.diagnosis.inverse_dynamics.search import left_said, search_driven
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.outcome import Holdout, Outcome, Tried
from harness.diagnosis.problem import Problem
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.search.extend import key_of, settle
from harness.diagnosis.search.long_recordings import lifted, shortened
from harness.diagnosis.search.release_transient import after_hand, knocked_at_release
from harness.diagnosis.search.search import Search, noise_of, search, under
from harness.diagnosis.tables.step import with_tables
from harness.diagnosis.verdict import Judgement, judge
from harness.kernels.solve import Scales
from harness.model.model import ModelTerm
from harness.model.place import Place

_JUDGED = (
    "terms were kept because the force error on the other recording falls with them, so that its errors took part in"
    " the choice; what stays was not tested for being noise"
)


def diagnose(problem: Problem, other: Judge | None = None) -> Outcome:
    """Diagnose a recording: what viscous and Coulomb friction leave unexplained, and what explains it.

    other : another driven recording, which must confirm what is named where nothing explains this one to its noise.
    Raises InputError when the recording holds no free decay to fit, SimulationError when no model could be simulated.
    """
    if problem.by_force:
        driven, scales = search_driven(problem, other)
        outcome = conclude(driven, scales)
        judged = () if other is None else (_JUDGED,)
        return replace(outcome, warnings=(*outcome.warnings, left_said(outcome.problem, outcome.base.points), *judged))
    short, base, scales = shortened(problem)
    whole = None if short is problem else problem
    short, base = along(base, short, scales)
    short = replace(short, noise=noise_of(base, short, scales.omega))
    found = search(short, settle(under(base, short), short, scales), scales)
    doubtful = problem.drive is None and (not found.explained or knocked_at_release(found.chosen, scales))
    free = after_hand(found.problem, scales) if doubtful else None
    if free is not None:
        later, scales, touched = free
        said = f"the first {touched:.4g} s are left out: no free decay, as if a hand had not yet been off"
        outcome = _concluded(later, scales, whole)
        return replace(outcome, warnings=(*outcome.warnings, said))
    return _concluded(found, scales, whole)


def _concluded(found: Search, scales: Scales, whole: Problem | None) -> Outcome:
    """What a free decay's search has come to; whole : all of its samples, where the search saw means of them."""
    every = found if whole is None else lifted(found, whole, scales)
    trace = as_stepped(every, scales)
    return conclude(every, scales, coarse=found) if trace is None else conclude(trace[0], scales, trace[1])


def conclude(found: Search, scales: Scales, stepping: Stepping | None = None, coarse: Search | None = None) -> Outcome:
    """Judge what a search has come to, and say it.

    stepping : of the engine whose trace the recording is. coarse : the search as it was, where its samples were means:
    what was held out is predicted in it.
    """
    graded = graded_misfit(found, scales)
    if graded is not None:
        return _graded(found, graded, scales)
    problem, judgement = found.problem, judge(found)
    refined, verdict = judgement.refined, judgement.verdict
    acting = [(entry, place_of(entry, refined, problem, scales.omega)) for entry in refined.model.terms]
    mechanisms = sorted(
        (mechanism(found, i, entry, scales.omega, place) for i, (entry, place) in enumerate(acting)),
        key=lambda m: -m.delta_bic,
    )
    prediction = _prediction(found if coarse is None else coarse, judgement, scales, acting)
    said = () if stepping is None else (stepping.sentence,)
    return Outcome(
        problem=problem,
        scales=scales,
        base=found.base,
        refined=refined,
        verdict=verdict,
        mechanisms=tuple(mechanisms),
        holdout=prediction,
        evidence=tuple(Tried(key_of(f)[0], found.base.bic - f.bic) for f in found.singles),
        base_parameters=base_parameters(found.base, problem, scales.omega, verdict == "adequate"),
        refined_parameters=base_parameters(refined, problem, scales.omega, verdict != "unexplained"),
        next_experiment=next_experiment(tuple(mechanisms), problem),
        warnings=(*said, *cautions(found, judgement, prediction)),
        stepping=stepping,
        rules=judgement.rules,
    )


def graded_misfit(found: Search, scales: Scales) -> Graded | None:
    """The catalogue graded against what the base model leaves, where no model explains the recording."""
    if found.left is not Left.STRUCTURE:
        return None
    with suppress(SimulationError):
        return grade(misfit(found.problem, found.base, scales))
    return None


def _graded(found: Search, graded: Graded, scales: Scales) -> Outcome:
    """The outcome of a misfit that no model explains."""
    judgement, said, omega = judge(found, graded), told(graded), graded.misfit.scales.omega
    outcome = Outcome(
        problem=said.problem,
        scales=graded.misfit.scales,
        base=said.base,
        refined=said.refined,
        verdict=judgement.verdict,
        mechanisms=said.mechanisms,
        holdout=said.holdout,
        evidence=said.evidence,
        base_parameters=base_parameters(said.base, said.problem, omega, explained=False),
        refined_parameters=base_parameters(said.refined, said.problem, omega, explained=False),
        next_experiment=next_experiment(said.mechanisms, said.problem),
        warnings=cautions_of_misfit(graded),
        rules=judgement.rules,
        remainder=said.remainder,
    )
    return with_tables(outcome, graded)


def _prediction(found: Search, judgement: Judgement, scales: Scales, acting: list[tuple[ModelTerm, Place]]) -> Holdout:
    """What was held out, predicted by the base and the refined model, and by one term too many where none is needed."""
    problem = found.problem
    refined = found.base if judgement.refined.model.terms == () else found.chosen
    if problem.by_force:
        return holdout_windows(found.base, refined, problem, scales)
    prediction = holdout(found.base, refined, problem, scales, acting)
    if judgement.verdict == "adequate":
        prediction = replace(prediction, forced=forced(found.base, found.singles, problem, scales))
    return prediction
