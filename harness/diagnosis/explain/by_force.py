"""A graded force, said: mechanisms with shares and predictions, and what is left beside noise."""

import math
from dataclasses import replace

import numpy as np

from harness.diagnosis.explain.cautions import keeping_time, unlikely
from harness.diagnosis.explain.graded import prediction
from harness.diagnosis.explain.mechanism import left_without, mechanism
from harness.diagnosis.explain.remainder import looks_like, shares_of
from harness.diagnosis.fit.place import place_of
from harness.diagnosis.grading.grade import Finalist
from harness.diagnosis.inverse_dynamics.grade import ForceGraded
from harness.diagnosis.outcome import Grade, Mechanism, Remainder
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.rules import LEAST_CYCLES
from harness.diagnosis.search.search import Search


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
    if LEAST_CYCLES in graded.rules or (graded.grade is Grade.ONE_OF and graded.cycles < LEAST_CYCLES.value):
        many = f"{2.0 * LEAST_CYCLES.value:g}"
        said.append(f"{graded.words:.3g} effective samples are few to exclude every other name; {many} would do")
    return (*said, *unlikely(graded), *keeping_time(graded))
