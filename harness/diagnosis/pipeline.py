"""The steps of a diagnosis, in order: prepare, fit the base, search, judge, explain. Each can be taken by itself.

Where kinds of problem differ, their own files say how (harness.diagnosis.kinds); what is said here is the same for all.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

from harness.core.budget import USUAL, Budget, given
from harness.core.errors import SimulationError
from harness.core.recording import Recording
from harness.diagnosis.explain.cautions import cautions, cautions_of_misfit
from harness.diagnosis.explain.could_hide import could_hide, with_systematic
from harness.diagnosis.explain.could_hide import said as hiding
from harness.diagnosis.explain.graded import cautions_of_force, mechanisms_of, remainder_of, told
from harness.diagnosis.explain.mechanism import each_of, mechanism
from harness.diagnosis.explain.next_experiment import left_open, left_open_by_grade, next_experiment, to_be_sure
from harness.diagnosis.fit.place import place_of
from harness.diagnosis.fit.standard_errors import base_parameters
from harness.diagnosis.grading.beginning import after_first_turn, from_the_beginning, from_within, with_second
from harness.diagnosis.grading.clock_drift import off_the_clock, with_clock
from harness.diagnosis.grading.grade import Graded, grade
from harness.diagnosis.grading.misfit import misfit
from harness.diagnosis.grading.posterior import of_contest, of_search, probability
from harness.diagnosis.inverse_dynamics.prepare import forces_together
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.kinds.known import kind_for, kind_of
from harness.diagnosis.outcome import Grade, Outcome, Tried
from harness.diagnosis.prepare.driven import is_driven
from harness.diagnosis.prepare.free_decay import together
from harness.diagnosis.problem import Problem
from harness.diagnosis.request import Asked
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.rules import COVARIATES, POOLING
from harness.diagnosis.search.against import against
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search
from harness.diagnosis.stages import Based, Found, Judged
from harness.diagnosis.tables.force_step import with_force_tables
from harness.diagnosis.tables.step import with_tables
from harness.diagnosis.verdict import judge as verdict_of
from harness.diagnosis.verdict import weighed
from harness.kernels.solve import Scales

_SEARCHED = 0.7
"""Share of them for the search; the rest is for grading where nothing explains a recording."""


def diagnose(problem: Problem, other: Judge | None = None, seconds: float = USUAL) -> Outcome:
    """All steps after the first: what viscous and Coulomb friction leave unexplained, and what explains it.

    other : another driven recording, which must confirm what is named where nothing explains this one to its noise.
    seconds : what trying laws may cost, s of a usual processor, counted in work; then the best so far is given.
    Raises InputError when the recording holds no free decay to fit, SimulationError when no model could be simulated.
    """
    budget = Budget.of_seconds(seconds)
    based = fit_base(problem)
    with given(budget):
        # what the search takes must leave some for grading what it found
        budget.most *= _SEARCHED
        found = search(based, other)
        budget.most /= _SEARCHED
        judged = judge(found)
    outcome = explain(judged)
    if not budget.ended:
        return outcome
    said = (
        f"the budget of {seconds:g} s ended the search: what is said is the best so far, and laws that were not tried"
        f" may explain more (--budget {4.0 * seconds:g} goes on)"
    )
    return replace(outcome, bounded=True, warnings=(said, *outcome.warnings))


def prepare(recording: Recording, asked: Asked) -> tuple[Problem, tuple[str, ...]]:
    """A recording as a problem of its kind, and what was done to it, one sentence each.

    Raises InputError for options that contradict the recording, and for what cannot be diagnosed.
    """
    prepared: tuple[Problem, tuple[str, ...]] = kind_for(recording).prepare(recording, asked)
    return prepared


def prepare_together(recordings: Sequence[Recording], asked: Asked) -> tuple[Problem, tuple[str, ...]]:
    """Several recordings of one machine as one problem; see ``prepare``."""
    if recordings and all(is_driven(one) for one in recordings):
        return forces_together(recordings, asked)
    return together(recordings, asked)


def fit_base(problem: Problem) -> Based[Any]:
    """Viscous and Coulomb friction fitted, and the noise that they leave. Raises InputError, SimulationError."""
    based: Based[Any] = kind_of(problem).fit_base(problem)
    return based


def search(based: Based[Any], other: Judge | None = None) -> Found:
    """The smallest model that explains the recording, or what comes nearest. Raises SimulationError."""
    found: Found = kind_of(based.whole).search(based, other)
    return found


def judge(found: Found) -> Judged:
    """The verdict; where no model explains the recording, by how much of the misfit each name takes."""
    if found.by_force is not None:
        return Judged(found, verdict_of(found.search, found.by_force))
    found = replace(found, search=with_clock(weighed(found.search, found.scales.omega), found.scales))
    clocked = off_the_clock(found.search, found.scales)
    if clocked is not None:
        search, note = clocked
        found = replace(found, search=search, coarse=search, notes=(*found.notes, note))
    graded = _graded(found.search, found.scales)
    later = None if graded is None else _after_first_turn(graded)
    if later is not None:
        explained, scales, left_out = later
        note = f"the first {left_out:.4g} s, up to the first turning point, are left out: no free decay yet"
        found = replace(found, search=explained, scales=scales, coarse=explained, notes=(*found.notes, note))
        return Judged(found, verdict_of(found.search))
    paired = None if graded is None else _with_second(graded, found)
    return paired if paired is not None else Judged(found, verdict_of(found.search, graded), graded)


def explain(judged: Judged) -> Outcome:
    """All that is said of a verdict: mechanisms, numbers with errors, prediction of what was held out, warnings."""
    outcome = _said(judged) if judged.graded is None else _misfit_said(judged, judged.graded)
    graded = judged.graded or judged.found.by_force
    likely = of_search(judged.found.search) if graded is None else of_contest(graded)
    each = (
        m if m.grade is Grade.TABULATED else replace(m, probability=probability(likely, m.name))
        for m in outcome.mechanisms
    )
    return replace(outcome, posterior=likely, mechanisms=tuple(each))


def _graded(found: Search, scales: Scales) -> Graded | None:
    """The catalogue graded against what the base model leaves, where no model explains the recording."""
    if found.left is not Left.STRUCTURE:
        return None
    with suppress(SimulationError):
        seen = misfit(found.problem, found.base, scales)
        later = grade(seen, from_within(found.begun, found.problem, seen.base.model.t0, scales))
        with suppress(SimulationError):
            return from_the_beginning(found, later, scales) or later
        return later
    return None


def _after_first_turn(graded: Graded) -> tuple[Search, Scales, float] | None:
    with suppress(SimulationError):
        later = after_first_turn(graded)
        return later if later is not None and weighed(later[0], later[1].omega).explained else None
    return None


def _with_second(graded: Graded, found: Found) -> Judged | None:
    """The verdict on the main effect with a second law, where both explain what is looked at."""
    with suppress(SimulationError):
        found_pair = with_second(graded)
        pair = None if found_pair is None else weighed(found_pair, graded.misfit.scales.omega)
        judgement = None if pair is None else verdict_of(pair)
        if pair is not None and judgement is not None and judgement.verdict == "missing_physics":
            left_out = graded.misfit.left_out
            note = f"the first {left_out:.4g} s, up to the first turning point, took no part"
            notes = (*found.notes, note) if left_out > 0.0 else found.notes
            again = replace(found, search=pair, scales=graded.misfit.scales, coarse=pair, notes=notes)
            return Judged(again, judgement)
    return None


def _said(judged: Judged) -> Outcome:
    """The outcome where a model explains the recording, or nothing is known of why none does."""
    found, scales, stepping = judged.found.search, judged.found.scales, judged.found.stepping
    problem, judgement = found.problem, judged.judgement
    refined, verdict = judgement.refined, judgement.verdict
    acting = [(entry, place_of(entry, refined, problem, scales.omega)) for entry in refined.model.terms]
    by_force = judged.found.by_force
    if by_force is None:
        each = (mechanism(found, i, entry, scales.omega, place) for i, (entry, place) in enumerate(acting))
        mechanisms = tuple(sorted(each, key=lambda m: -m.delta_bic))
        if verdict == "one_of":
            mechanisms = each_of(mechanisms[0], found, scales.omega)
    else:
        mechanisms = mechanisms_of(found, by_force, scales.omega)
    shares = {} if by_force is None else {f.name: f.share for f in by_force.finalists}
    coarse = judged.found.coarse.problem
    prediction = kind_of(coarse).hold_out(coarse, judged, acting)
    unpredicted = (prediction.why,) if prediction.why else ()
    warned = cautions(found, judgement, prediction) if by_force is None else cautions_of_force(by_force)
    said = () if stepping is None else (stepping.sentence,)
    numbers = base_parameters(found.base, problem, scales.omega, verdict == "adequate")
    if verdict == "adequate" and "driven" in problem.given:
        hidden = could_hide(found, scales)
        said = (*said, *hiding(numbers, hidden))
        numbers = with_systematic(numbers, hidden)
    outcome = Outcome(
        problem=problem,
        scales=scales,
        base=found.base,
        refined=refined,
        verdict=verdict,
        mechanisms=mechanisms,
        holdout=prediction,
        evidence=tuple(
            Tried(key_of(f)[0], against(found.base, problem) - against(f, problem), shares.get(key_of(f)[0]))
            for f in found.singles
            if f.model.terms
        ),
        base_parameters=numbers,
        refined_parameters=numbers
        if refined is found.base and verdict == "adequate"
        else base_parameters(refined, problem, scales.omega, verdict != "unexplained"),
        next_experiment=next_experiment(left_open(mechanisms, found), problem, scales)
        or to_be_sure(mechanisms, judgement.rules, "driven" in problem.given),
        warnings=(*said, *warned, *unpredicted, *judged.found.notes),
        stepping=stepping,
        rules=(*judgement.rules, *(COVARIATES if problem.covariates else ()), *(POOLING if problem.alone else ())),
        remainder=None if by_force is None else remainder_of(by_force),
        pooled=judged.found.pooled,
    )
    return outcome if by_force is None else with_force_tables(outcome, by_force)


def _misfit_said(judged: Judged, graded: Graded) -> Outcome:
    """The outcome of a misfit that no model explains."""
    said, omega = told(graded), graded.misfit.scales.omega
    outcome = Outcome(
        problem=said.problem,
        scales=graded.misfit.scales,
        base=said.base,
        refined=said.refined,
        verdict=judged.judgement.verdict,
        mechanisms=said.mechanisms,
        holdout=said.holdout,
        evidence=said.evidence,
        base_parameters=base_parameters(said.base, said.problem, omega, explained=False),
        refined_parameters=base_parameters(said.refined, said.problem, omega, explained=False),
        next_experiment=next_experiment(left_open_by_grade(said.mechanisms, graded), said.problem, graded.misfit.scales)
        or to_be_sure(said.mechanisms, judged.judgement.rules, "driven" in said.problem.given),
        warnings=(*cautions_of_misfit(graded, judged.found.search.doubted), *judged.found.notes),
        rules=(*judged.judgement.rules, *(POOLING if said.problem.alone else ())),
        remainder=said.remainder,
        pooled=judged.found.pooled,
    )
    return with_tables(outcome, graded)
