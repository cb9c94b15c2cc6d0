"""From a prepared recording to an outcome: fit, search, decide, say."""

import math
from dataclasses import replace

import numpy as np

from harness.core.quantity import Quantity
from harness.diagnosis.advice import next_experiment
from harness.diagnosis.baseline import baseline
from harness.diagnosis.decided import doubt
from harness.diagnosis.driven.holdout import holdout_windows
from harness.diagnosis.driven.search import left_said, search_driven
from harness.diagnosis.driven.validate import Judge
from harness.diagnosis.fit import Fit
from harness.diagnosis.holdout import forced, holdout
from harness.diagnosis.numbers import AT_LEAST, base_parameters, term_parameters
from harness.diagnosis.outcome import Alternative, Mechanism, Outcome, Verdict
from harness.diagnosis.problem import Problem
from harness.diagnosis.release import SHOWN, UNSEEN, without_hand
from harness.diagnosis.search import AMONG_NAMES, Search, noise_of, search, under
from harness.diagnosis.select import DECISIVE, extend, key_of, settle
from harness.diagnosis.spans import spans_of
from harness.diagnosis.stepping import as_stepped
from harness.diagnosis.steps import Stepping
from harness.diagnosis.structure import explains
from harness.kernels.solve import Scales
from harness.model.model import ModelTerm

_MOST_ALTERNATIVES = 3
_MOST_CLOSEST = 3
_FEWEST_TURNS = 3
"""Reversals that must stay after what a hand touched: a slider at rest agrees with any model."""
_JUDGED = (
    "terms were kept because the force error on the other recording falls with them, so that its errors took part in"
    " the choice; what stays was not tested for being noise"
)


def diagnose(problem: Problem, judge: Judge | None = None) -> Outcome:
    """Diagnose a recording: what viscous and Coulomb friction leave unexplained, and what explains it.

    judge : another driven recording, which must confirm what is named where nothing explains this one to its noise.
    Raises InputError when the recording holds no free decay to fit, SimulationError when no model could be simulated.
    """
    if problem.restarts is not None:
        driven, scales = search_driven(problem, judge)
        outcome = conclude(driven, scales)
        said = (left_said(outcome.problem), *(() if judge is None else (_JUDGED,)))
        return replace(outcome, warnings=(*outcome.warnings, *said))
    base, scales = baseline(problem)
    problem = replace(problem, noise=noise_of(base, problem, scales.omega))
    base = settle(under(base, problem), problem, scales)
    found = search(problem, base, scales)
    doubtful = problem.drive is None and (not found.explained or _knocked_at_release(found.chosen, scales))
    free = after_hand(found.problem, scales) if doubtful else None
    if free is not None:
        return free
    trace = as_stepped(found, scales)
    return conclude(found, scales) if trace is None else conclude(trace[0], scales, trace[1])


def _knocked_at_release(found: Fit, scales: Scales) -> bool:
    """Whether all that was named is a knock in the first quarter of a period: what a hand does that lets go."""
    if key_of(found) != ("impulse",):
        return False
    since = found.model.terms[0].value("time") - found.model.t0
    return since < SHOWN * math.pi / scales.omega


def after_hand(problem: Problem, scales: Scales) -> Outcome | None:
    """What is concluded where viscous and Coulomb friction explain all but the beginning; None where they do not."""
    problem, touched = without_hand(problem, math.pi / scales.omega, UNSEEN)
    if touched == 0.0:
        return None
    base, scales = baseline(problem)
    problem = replace(problem, noise=noise_of(base, problem, scales.omega))
    base = settle(under(base, problem), problem, scales)
    if len(base.shown.events) < _FEWEST_TURNS or not explains(base, problem, scales.omega):
        return None
    if _something_later(problem, scales):
        return None
    outcome = conclude(Search(problem, base, base, (), (), explained=True), scales)
    said = f"the first {touched:.4g} s are left out: no free decay, as if a hand had not yet been off"
    return replace(outcome, warnings=(*outcome.warnings, said))


def _something_later(problem: Problem, scales: Scales) -> bool:
    """Whether a term improves what follows the first quarter of a period, where no hand is any more."""
    later = problem.part(slice(int(np.searchsorted(problem.t, problem.t[0] + SHOWN * math.pi / scales.omega)), None))
    base, scales = baseline(later)
    singles = extend(base, later, scales).fits
    return bool(singles) and singles[0].bic < base.bic - AMONG_NAMES


def conclude(found: Search, scales: Scales, stepping: Stepping | None = None) -> Outcome:
    """Say what a search has come to; stepping : of the engine whose trace the recording is."""
    problem, refined = found.problem, found.chosen
    verdict: Verdict = "adequate"
    rival = doubt(found) if found.explained and problem.restarts is None else None
    if not found.explained or rival is not None:
        verdict = "unexplained"
    elif refined.model.terms:
        verdict = "missing_physics"
    if verdict != "missing_physics":
        refined = found.base
    named = refined.model.terms if verdict == "missing_physics" else ()
    acting = [(entry, spans_of(entry, refined, problem, scales.omega)) for entry in named]
    mechanisms = sorted(
        (_mechanism(found, i, entry, problem, spans) for i, (entry, spans) in enumerate(acting)),
        key=lambda m: -m.delta_bic,
    )
    if problem.restarts is not None:
        prediction = holdout_windows(found.base, refined, problem, scales)
    else:
        prediction = holdout(found.base, refined, problem, scales, acting)
    if verdict == "adequate" and problem.restarts is None:
        prediction = replace(prediction, forced=forced(found.base, found.singles, problem, scales))
    warnings = [] if stepping is None else [stepping.sentence]
    if rival is not None:
        warnings.append(_undecided(chosen=found.chosen, rival=rival))
    elif verdict == "unexplained":
        warnings.append("no entry or pair of the catalogue explains it; standard errors are inflated by the misfit")
        warnings += _closest(found)
    if verdict == "missing_physics" and prediction.refined_rmse:
        worse = [c for c, after in prediction.refined_rmse.items() if after > 1.05 * prediction.baseline_rmse[c]]
        if worse:
            warnings.append(f"BIC decides for the refined model although it predicts {', '.join(worse)} worse")
    return Outcome(
        problem=problem,
        scales=scales,
        base=found.base,
        refined=refined,
        verdict=verdict,
        mechanisms=tuple(mechanisms),
        holdout=prediction,
        evidence=tuple((key_of(f)[0], found.base.bic - f.bic) for f in found.singles),
        base_parameters=base_parameters(found.base, problem, scales.omega, verdict == "adequate"),
        refined_parameters=base_parameters(refined, problem, scales.omega, verdict != "unexplained"),
        next_experiment=next_experiment(tuple(mechanisms), problem),
        warnings=tuple(warnings),
        stepping=stepping,
    )


def _undecided(chosen: Fit, rival: Fit) -> str:
    """Why a pair that explains a recording is not named."""
    one, other = (" with ".join(key_of(f)) for f in (chosen, rival))
    return (
        f"{one} would explain it, but {other} nearly as well (BIC {rival.bic - chosen.bic:.0f} worse): when pairs of"
        " different kinds do, it is as likely an effect of no catalogue, and none is named; standard errors are"
        " inflated by the misfit"
    )


def _closest(found: Search) -> list[str]:
    """What of the catalogue would take off most, where nothing explains a recording."""
    misfit = found.base.chi2 - found.base.points
    near = [(key_of(f)[0], (found.base.chi2 - f.chi2) / misfit) for f in found.singles[:_MOST_CLOSEST]]
    if misfit <= 0.0 or not near:
        return []
    said = ", ".join(f"{name} {100.0 * share:.0f} %" for name, share in near)
    return [f"of the misfit the closest entries take off, each alone: {said}; none is named, because none explains it"]


def _mechanism(
    found: Search, index: int, entry: ModelTerm, problem: Problem, spans: tuple[tuple[float, float], ...]
) -> Mechanism:
    parameters = term_parameters(found.chosen, problem, index)
    return Mechanism(
        entry=entry,
        statement=_statement(entry, parameters, found.chosen),
        parameters=parameters,
        delta_bic=_lost_without(found, entry),
        spans=spans,
        alternatives=_alternatives(found, entry),
    )


def _lost_without(found: Search, entry: ModelTerm) -> float:
    """What BIC loses without a term: against the best of the models searched that lack its name."""
    lacking = [f.bic for f in (found.base, *found.singles, *found.rivals) if entry.term.name not in key_of(f)]
    others = tuple(sorted(e.term.name for e in found.chosen.model.terms if e is not entry))
    same = [f.bic for f in (found.base, *found.singles, *found.rivals) if key_of(f) == others]
    return min(same or lacking) - found.chosen.bic


def _alternatives(found: Search, entry: ModelTerm) -> tuple[Alternative, ...]:
    """Names that could stand in a term's place, by less than what is decisive."""
    rest = sorted(e.term.name for e in found.chosen.model.terms if e is not entry)
    near = []
    for rival in found.rivals:
        names = list(key_of(rival))
        delta = rival.bic - found.chosen.bic
        if delta >= DECISIVE or len(names) != len(rest) + 1:
            continue
        for name in rest:
            if name in names:
                names.remove(name)
        if len(names) == 1 and names[0] != entry.term.name:
            near.append(Alternative(names[0], delta))
    return tuple(sorted(near, key=lambda a: a.delta_bic)[:_MOST_ALTERNATIVES])


def _said(quantity: Quantity) -> str:
    """A number as a sentence shows it."""
    return f"at least {quantity}" if quantity.why == AT_LEAST else str(quantity)


def _statement(entry: ModelTerm, parameters: dict[str, Quantity], found: Fit) -> str:
    values = {name: _said(q) for name, q in parameters.items()}
    if entry.term.name == "constant-force" and found.model.k > 0.0:
        values["offset"] = f"{entry.value('force') / found.model.k:.4g}"
    elif entry.term.name == "constant-force":
        values["offset"] = "nothing, without a spring"
    return entry.term.say(values)
