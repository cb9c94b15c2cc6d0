"""The steps of a diagnosis, in order: prepare, fit the base, search, judge, explain. Each can be taken by itself.

Where kinds of problem differ, their own files say how (harness.diagnosis.kinds); what is said here is the same for all.
"""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

from harness.core.budget import USUAL, Budget, given
from harness.core.errors import InputError, SimulationError
from harness.core.quantity import Quantity
from harness.core.recording import Recording
from harness.diagnosis.explain.could_hide import could_hide, most_shifted, with_systematic
from harness.diagnosis.explain.mechanism import (
    each_of,
    mechanism,
    of_force,
    of_misfit,
    remainder,
    remainder_of_force,
    shifted_by_form,
)
from harness.diagnosis.explain.next_experiment import left_open, left_open_by_grade
from harness.diagnosis.explain.sentences import (
    by_form,
    cautions,
    cautions_of_force,
    cautions_of_misfit,
    hiding,
    next_experiment,
    out_of_budget,
    to_be_sure,
)
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.standard_errors import base_parameters
from harness.diagnosis.grading.beginning import after_first_turn, from_the_beginning, from_within, with_second
from harness.diagnosis.grading.clocks import off_the_clock, with_clock
from harness.diagnosis.grading.contest import of_contest, of_search
from harness.diagnosis.grading.grade import Graded, grade
from harness.diagnosis.grading.likely import probability, ranked, with_unseen
from harness.diagnosis.grading.misfit import misfit
from harness.diagnosis.inverse_dynamics.prepare import as_it_acts, forces_together, with_covariates, with_unseen_mass
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.kinds.known import kind_of
from harness.diagnosis.moves.classify import classify
from harness.diagnosis.moves.kinds import MotionKind, Moves
from harness.diagnosis.outcome import Grade, Holdout, Mechanism, Outcome, Tried
from harness.diagnosis.prepare.curve import curve_problem
from harness.diagnosis.prepare.driven import driven_problem, is_driven, without_spring
from harness.diagnosis.prepare.free_decay import free_decay_problem, together
from harness.diagnosis.prepare.run_down import run_down_problem, run_downs_together, runs_down
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.request import Asked
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.rules import COVARIATES, INTEGRATED, POOLING
from harness.diagnosis.search.against import against
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search, under
from harness.diagnosis.stages import Based, Found, Judged
from harness.diagnosis.tables.step import with_force_tables, with_tables
from harness.diagnosis.tables.unnamed import beside_curves, beside_one_curve
from harness.diagnosis.verdict import judge as verdict_of
from harness.diagnosis.verdict import weighed
from harness.kernels.solve import Scales
from harness.model.model import Restoring

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
    return (
        replace(outcome, bounded=True, warnings=(out_of_budget(seconds), *outcome.warnings))
        if budget.ended
        else outcome
    )


def prepare(recording: Recording, asked: Asked, moves: Moves | None = None) -> tuple[Problem, tuple[str, ...]]:
    """A recording as a problem, and what was done to it, one sentence each; a driven one may be fitted by its force.

    moves : what it holds, where that is known. Raises InputError for options that contradict the recording and for what
    cannot be diagnosed, SimulationError.
    """
    if recording.steady:
        return curve_problem(recording, asked)
    if not is_driven(recording):
        moves = moves or classify(recording, asked.restoring)
        falls = asked.restoring is Restoring.NONE or moves.kind is MotionKind.RUN_DOWN
        return run_down_problem(recording, asked) if falls else free_decay_problem(recording, asked)
    asked, free = without_spring(recording, asked)
    problem, notes = driven_problem(recording, asked)
    notes = (*free, *notes)
    if not isinstance(problem, InverseDynamics):
        return problem, notes
    if asked.covariates:
        problem = with_covariates(problem, recording, asked.covariates)
    if not problem.drive.held:
        problem, said = as_it_acts(problem, recording["u"])
        notes = (*notes, *said)
    return with_unseen_mass(problem), notes


def prepare_together(recordings: Sequence[Recording], asked: Asked) -> tuple[Problem, tuple[str, ...]]:
    """Several recordings of one machine as one problem; see ``prepare``."""
    tables = [one.file for one in recordings if one.steady]
    if tables:
        found = f"{tables[0]} is a table of speeds and forces without a time"
        raise InputError("--together", found, "recordings of a motion")
    if recordings and all(is_driven(one) for one in recordings):
        return forces_together(recordings, asked)
    if asked.covariates:
        undriven = next(one.file for one in recordings if not is_driven(one))
        found = f"given with {undriven}, which nothing drives, among several"
        raise InputError("--covariate", found, "several with a measured force, or one decay by itself")
    if any(not is_driven(one) and runs_down(one, asked.restoring) for one in recordings):
        return run_downs_together(recordings, asked)
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
    apart = beside_one_curve(weighed(found.search, found.scales.omega), found.scales)
    found = replace(found, search=with_clock(apart, found.scales))
    clocked = off_the_clock(found.search, found.scales)
    if clocked is not None:
        search, note = clocked
        found = replace(found, search=search, coarse=search, notes=(*found.notes, note))
    if _by_an_integrator(found.search):
        judgement = verdict_of(found.search)
        rules = (*judgement.rules, INTEGRATED)
        return Judged(found, replace(judgement, rules=rules))
    graded = _graded(found.search, found.scales)
    if graded is None:
        return Judged(found, verdict_of(found.search))
    with suppress(SimulationError):
        later = after_first_turn(graded)
        if later is not None and weighed(later[0], later[1].omega).explained:
            explained, scales, left_out = later
            note = (
                f"the first {left_out:.4g} s, up to the first turning point, are skipped: no law explains them as well"
                " (a hand still in contact, or what acts at that displacement alone)"
            )
            found = _instead(found, explained, scales, note)
            return Judged(found, verdict_of(found.search))
    with suppress(SimulationError):
        # the main effect with a second law, where both explain what is looked at
        found_pair, scales, left_out = with_second(graded), graded.misfit.scales, graded.misfit.left_out
        if found_pair is not None:
            pair = beside_one_curve(weighed(found_pair, scales.omega), scales)
            judgement = verdict_of(pair)
            if judgement.verdict == "missing_physics":
                note = f"the first {left_out:.4g} s, up to the first turning point, took no part"
                return Judged(_instead(found, pair, scales, *([note] if left_out > 0.0 else [])), judgement)
    graded = beside_curves(graded)
    return Judged(found, verdict_of(found.search, graded), graded)


def _instead(found: Found, search: Search, scales: Scales, *left_out: str) -> Found:
    return replace(found, search=search, scales=scales, coarse=search, left_out=(*found.left_out, *left_out))


def _by_an_integrator(found: Search) -> bool:
    """Whether no law explains a trace without noise, and what the base leaves of it may be its integrator's."""
    problem = found.problem
    if found.left is not Left.STRUCTURE or not problem.moves or any(one.found for one in problem.noise.values()):
        return False
    left = problem.left(found.base.shown)
    return all(np.std(left[c]) < INTEGRATED.value * np.std(y) for c, y in problem.channels.items())


def _graded(found: Search, scales: Scales) -> Graded | None:
    """The catalogue graded against what the base model leaves, where no model explains the recording."""
    if found.left is not Left.STRUCTURE or not found.problem.moves:
        return None
    with suppress(SimulationError):
        seen = misfit(found.problem, found.base, scales)
        later = grade(seen, from_within(found.begun, found.problem, seen.base.model.t0, scales))
        with suppress(SimulationError):
            return from_the_beginning(found, later, scales) or later
        return later
    return None


def explain(judged: Judged) -> Outcome:
    """All that is said of a verdict: mechanisms, numbers with errors, prediction of what was held out, warnings."""
    outcome = _said(judged) if judged.graded is None else _misfit_said(judged, judged.graded)
    graded = judged.graded or judged.found.by_force
    likely = of_search(judged.found.search) if graded is None else of_contest(graded)
    if outcome.verdict in ("adequate", "unexplained"):
        likely = with_unseen(likely)
    each = (
        replace(m, probability=probability(likely, m.name)) if likely and m.grade is not Grade.TABULATED else m
        for m in outcome.mechanisms
    )
    return replace(outcome, posterior=ranked(likely), mechanisms=tuple(each))


def _said(judged: Judged) -> Outcome:
    """The outcome where a model explains the recording, where its force is fitted, or nothing is known of why none
    does.
    """
    found, scales, stepping = judged.found.search, judged.found.scales, judged.found.stepping
    problem, judgement, by_force = found.problem, judged.judgement, judged.found.by_force
    refined, verdict, driven = judgement.refined, judgement.verdict, "driven" in problem.given
    if by_force is None:
        each = (mechanism(found, i, scales.omega) for i in range(len(refined.model.terms)))
        mechanisms = tuple(sorted(each, key=lambda m: -m.delta_bic))
        if verdict == "one_of":
            mechanisms = each_of(mechanisms[0], found, scales.omega)
    else:
        mechanisms = of_force(found, by_force, scales.omega)
    shares = {} if by_force is None else {f.name: f.share for f in by_force.finalists}
    prediction = kind_of(judged.found.coarse.problem).hold_out(judged)
    warned = cautions(found, judgement, prediction) if by_force is None else cautions_of_force(by_force)
    said = () if stepping is None else (stepping.sentence,)
    numbers = base_parameters(found.base, problem, scales.omega, verdict == "adequate")
    shifts: Mapping[str, float] = {}
    if verdict == "adequate" and (driven or not problem.returns):
        hidden = could_hide(found, scales)
        said, shifts = (*said, *hiding(numbers, hidden)), most_shifted(hidden)
        numbers = with_systematic(numbers, shifts)
    told: Mapping[str, Quantity] = numbers
    if refined is not found.base or verdict != "adequate":
        explained = verdict != "unexplained"
        fits = found.rivals if by_force is None else [one.fit for one in by_force.named]
        shifts = shifted_by_form(refined, _listed(mechanisms, fits), problem, scales, explained)
        told = with_systematic(base_parameters(refined, problem, scales.omega, explained), shifts)
        said = (*said, *by_form(told, verdict == "one_of"))
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
        refined_parameters=told,
        next_experiment=next_experiment(left_open(mechanisms, found), problem, scales)
        or to_be_sure(mechanisms, judgement.rules, driven),
        warnings=(
            *judged.found.left_out,
            *said,
            *warned,
            *((prediction.why,) if prediction.why else ()),
            *judged.found.notes,
        ),
        stepping=stepping,
        rules=(*judgement.rules, *(COVARIATES if problem.covariates else ()), *(POOLING if problem.alone else ())),
        remainder=None if by_force is None else remainder_of_force(by_force),
        pooled=judged.found.pooled,
        shifts=shifts,
    )
    return outcome if by_force is None else with_force_tables(outcome, by_force)


def _listed(mechanisms: Sequence[Mechanism], fits: Iterable[Fit]) -> list[Fit]:
    """Those of the names that are listed beside the first."""
    names = {m.name for m in mechanisms[1:] if m.grade is Grade.ONE_OF}
    return [f for f in fits if f.model.terms and f.model.terms[-1].term.name in names]


def _misfit_said(judged: Judged, graded: Graded) -> Outcome:
    """The outcome of a misfit that no model explains; the sensors' noise is what the best model found leaves."""
    seen, scales, rules = graded.misfit, graded.misfit.scales, judged.judgement.rules
    best = graded.named[0].fit if graded.named else seen.base
    problem = seen.sensed(seen.noise_left(best))
    base = under(seen.base, problem)
    refined = base if best is seen.base else under(best, problem)
    mechanisms = tuple(of_misfit(f, graded, base, problem) for f in graded.named)
    first = mechanisms[0].held_out if mechanisms else None
    others = [under(f, problem) for f in _listed(mechanisms, [one.fit for one in graded.named])]
    shifts = shifted_by_form(refined, others, problem, scales, explained=False)
    told = with_systematic(base_parameters(refined, problem, scales.omega, explained=False), shifts)
    outcome = Outcome(
        problem=problem,
        scales=scales,
        base=base,
        refined=refined,
        verdict=judged.judgement.verdict,
        mechanisms=mechanisms,
        holdout=Holdout.none() if first is None else Holdout(first.spans, first.baseline_rmse, first.refined_rmse),
        evidence=tuple(Tried(f.name, base.bic - under(f.fit, problem).bic, f.share) for f in graded.finalists),
        base_parameters=base_parameters(base, problem, scales.omega, explained=False),
        refined_parameters=told,
        next_experiment=next_experiment(left_open_by_grade(mechanisms, graded), problem, scales)
        or to_be_sure(mechanisms, rules, "driven" in problem.given),
        warnings=(
            *judged.found.left_out,
            *cautions_of_misfit(graded, judged.found.search),
            *by_form(told, bool(others)),
            *judged.found.notes,
        ),
        rules=(*rules, *(POOLING if problem.alone else ())),
        remainder=remainder(base, refined, problem),
        pooled=judged.found.pooled,
        shifts=shifts,
    )
    return with_tables(outcome, graded)
