"""A graded misfit or force, said: fits under the noise, mechanisms with shares and predictions, what is left."""

import math
from dataclasses import dataclass, replace

import numpy as np

from harness.diagnosis.explain.cautions import keeping_time, unlikely
from harness.diagnosis.explain.mechanism import left_without, looks_like, mechanism, remainder, shares_of, statement_of
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.place import place_of
from harness.diagnosis.fit.standard_errors import term_parameters
from harness.diagnosis.grading.contest import Finalist
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.grading.prediction import Predicted
from harness.diagnosis.inverse_dynamics.grade import ForceGraded
from harness.diagnosis.outcome import Alternative, Grade, Holdout, Mechanism, Prediction, Remainder, Tried
from harness.diagnosis.problem import Problem
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.rules import DECISIVE, LEAST_CYCLES
from harness.diagnosis.search.search import Search, under
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
    twins = {f.name for f in others if not parted and f.large and not_parted(first.name, f.name)}
    listed = [a for a in found if a.delta_bic < DECISIVE.value or a.name in twins]
    return tuple(sorted(listed, key=lambda a: a.name not in twins))[:_MOST_ALTERNATIVES]


def prediction(before: Predicted | None, after: Predicted | None) -> Prediction | None:
    """What two models miss of the same blocks, as results say it."""
    if before is None or after is None:
        return None
    ratios = after.by_span / np.maximum(before.by_span, 1e-300)
    return Prediction(before.spans, before.rmse, after.rmse, tuple(float(r) for r in ratios))


def mechanisms_of(found: Search, graded: ForceGraded, omega: float) -> tuple[Mechanism, ...]:
    """What is named, the main one first; then what else the search kept beside it. omega : rad/s."""
    of_base = _of_base(found, graded, omega)
    if not graded.kept:
        return (*(_alone(found, graded, f, omega) for f in graded.named), *of_base)
    fit, finalists = graded.refined, {f.name: f for f in graded.finalists}
    first = {f.name: i for i, f in enumerate(graded.named)}
    said: list[tuple[int, Mechanism]] = []
    for i, entry in enumerate(fit.model.terms[len(of_base) :], len(of_base)):
        one = mechanism(found, i, entry, omega, place_of(entry, fit, found.problem, omega))
        again = any(m.name == one.name for _, m in said)
        if one.name in first and not again:
            said.append((first[one.name], _graded(one, graded, finalists[one.name])))
            continue
        # alone a law beside the first, or a further one of its name, may take nothing: it was kept for what the model
        # is worse without it
        beside = _graded(one, graded, None if again else finalists.get(one.name))
        said.append((len(first), replace(beside, grade=Grade.MINOR, share=_share_beside(found, i, graded))))
    also = [_alone(found, graded, f, omega) for f in graded.named if f.name not in {m.name for _, m in said}]
    ranked = sorted([*said, *((first[m.name], m) for m in also)], key=lambda one: (one[0], -one[1].delta_bic))
    return (*(m for _, m in ranked), *of_base)


def _of_base(found: Search, graded: ForceGraded, omega: float) -> tuple[Mechanism, ...]:
    """What the base has besides friction: it is there whatever else is, and the shares of others are of what it leaves.

    A constant force of an axis that nothing pulls back.
    """
    fit = graded.refined
    entries = fit.model.terms[: len(graded.base.model.terms)]
    said = (mechanism(found, i, e, omega, place_of(e, fit, found.problem, omega)) for i, e in enumerate(entries))
    return tuple(replace(one, grade=Grade.EXPLAINS, share=None) for one in said)


def _share_beside(found: Search, index: int, graded: ForceGraded) -> float:
    """Share of the misfit beyond noise that the kept model leaves more without one of its laws."""
    chosen = found.chosen
    more = (left_without(found, index).chi2 - chosen.chi2) / chosen.chi2
    return float(np.clip(more * graded.reference.squares / graded.excess, 0.0, 1.0))


def _alone(found: Search, graded: ForceGraded, one: Finalist, omega: float) -> Mechanism:
    entry = one.fit.model.terms[-1]
    index = len(one.fit.model.terms) - 1
    alone = replace(found, chosen=one.fit, rivals=found.singles, without=(None,) * index + (graded.ground,))
    place = place_of(entry, one.fit, found.problem, omega)
    return _graded(mechanism(alone, index, entry, omega, place), graded, one)


def _graded(said: Mechanism, graded: ForceGraded, one: Finalist | None) -> Mechanism:
    named = any(f.name == said.name for f in graded.named)
    grade = graded.grade if named and graded.grade is not None else Grade.MINOR
    if one is None:
        return replace(said, grade=grade)
    likely = graded.chance if graded.named and said.name == graded.named[0].name else None
    held = prediction(graded.base_held, one.held)
    return replace(said, grade=grade, share=one.share, held_out=held, chance=likely)


def remainder_of(graded: ForceGraded) -> Remainder:
    """What the best model found leaves of the force."""
    measured, left = graded.measured, graded.best
    noise = graded.noise
    share = (left.squares - noise) / graded.excess
    t, x, v = (measured.blocks(y) for y in (measured.t, measured.x, measured.v))
    depends = shares_of([left.residual], t, x, v)
    over = math.sqrt(left.squares / noise) if noise > 0.0 else math.inf
    return Remainder(float(np.clip(share, 0.0, 1.0)), over, looks_like(depends), depends)


def cautions_of_force(graded: ForceGraded) -> tuple[str, ...]:
    """What a reader of a graded force is warned of."""
    none = "no entry of the catalogue says the force to its noise"
    if graded.over.left is Left.NOISE:
        none = "what says the force to its noise moves worse than viscous and Coulomb friction alone"
    said = [f"{none}; standard errors allow for what is left"]
    if LEAST_CYCLES in graded.rules:
        many = f"{2.0 * LEAST_CYCLES.value:g}"
        said.append(f"{graded.words:.3g} effective samples are few to exclude every other name; {many} would do")
    return (*said, *unlikely(graded), *keeping_time(graded))
