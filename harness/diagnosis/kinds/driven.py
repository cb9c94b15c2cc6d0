"""The steps of a driven recording that is followed in its channels, under the noise of its force."""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

from harness.core.errors import SimulationError
from harness.diagnosis.baseline.base_fit import driven_baseline
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.rmse import as_started, motion_followed, only_started
from harness.diagnosis.input_noise.noisy_base_fit import along, in_turn
from harness.diagnosis.input_noise.propagation import left_of, unknown_between, unlikely
from harness.diagnosis.inverse_dynamics.prepare import with_unseen_mass
from harness.diagnosis.inverse_dynamics.search import by_the_force
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.kinds.inverse_dynamics import FittedForces
from harness.diagnosis.kinds.kind import Kind
from harness.diagnosis.prepare.driven import ALL_FELT, by_its_force
from harness.diagnosis.prepare.intersample import ACTS_HELD, FAR_OFF
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.diagnosis.rules import AMONG_NAMES, DECISIVE, FOLLOWED, FORCE_HELD
from harness.diagnosis.search.extend import Step, extend, settle
from harness.diagnosis.search.search import Again, Search, freed, noise_of, once, search, under
from harness.diagnosis.stages import Based, Found
from harness.diagnosis.starts import Windows
from harness.estimate.noise import FLOOR
from harness.kernels.solve import Scales
from harness.model.model import Model

_BY_FORCE = (
    "followed, the base model misses far more than the noise and no law explains it: the force is fitted instead"
)
_UNKNOWN_BETWEEN = (
    "the force is not known between its samples: it bends from one to the next, and what a controller does there is"
    " allowed for (a log of more samples a second tells more)"
)
_NOT_FOLLOWED = "The base model cannot be followed, so that the force is fitted."
_ASKED = 3
"""Laws, the nearest, beside which the level of the force's noise is asked again."""
_SAME = 0.01
"""Share of a chi-square that has not moved; noise taken anew each turn moves it too."""


class DrivenRecordings(Kind[Driven]):
    """See Kind."""

    of = Driven

    def fit_base(self, problem: Driven) -> Based[Any]:
        """Along the base model's own motion; its force is fitted where that cannot be followed."""
        with suppress(SimulationError):
            return self._followed(problem)
        unfollowed = by_its_force(problem)
        unfollowed = replace(unfollowed, enters=(*unfollowed.enters, _NOT_FOLLOWED))
        return FittedForces().fit_base(with_unseen_mass(unfollowed))

    def _followed(self, problem: Driven) -> Based[Driven]:
        """Along the base model's own motion, which says what noise of the force does."""
        base, scales = driven_baseline(problem)
        seen, base = along(base, problem, scales)
        seen = replace(seen, noise=noise_of(base, seen, scales.omega))
        return Based(problem, seen, settle(under(base, seen), seen, scales), scales)

    def search(self, based: Based[Driven], other: Judge | None) -> Found:
        """Windows start as the model has them: a poor one starts them poorly, so both are taken in turn.

        How the force acts between samples was told by the base model, which a law that is left out may have misled: it
        is asked again beside the law that comes nearest.
        """
        renew = _in_turns if isinstance(based.problem.starts, Windows) else once
        other_way = self._other_way(based)
        if other_way is not None and _leaves_noise(other_way.fit, other_way):
            based, other_way = other_way, None
        alone = _alone(based)
        if other_way is not None and not (alone.fits and _leaves_noise(alone.fits[0], based)):
            based, alone = _nearer(based, alone, other_way)
        notes = [ACTS_HELD] if based.whole.is_held else []
        felt = self._all_felt(based, alone)
        if felt is not None:
            (based, alone), notes = felt, [*notes, ALL_FELT]
        based, alone = _quieter(based, alone)
        far = _far_off(based.fit, based.problem)
        if far and not any(_leaves_noise(one, based) for law in alone.fits[:1] for one in _forms(law, based)):
            with suppress(SimulationError):
                return self._by_force(based, other, notes)
        found = search(based.problem, based.fit, based.scales, renew, alone=alone)
        unknown = self._unknown_between(found, based)
        if unknown is not None:
            found, based = unknown
            notes = [*(one for one in notes if one is not ACTS_HELD or based.whole.is_held), _UNKNOWN_BETWEEN]
        if not found.explained and (far or _strays(found.base, found.problem)):
            with suppress(SimulationError):
                return self._by_force(based, other, notes)
        return Found(found, based.scales, found, notes=tuple(notes))

    def _by_force(self, based: Based[Driven], other: Judge | None, notes: Sequence[str]) -> Found:
        """Of the force itself, which tells more of laws that explain a part. Raises SimulationError."""
        forces = FittedForces()
        forced = forces.search(forces.fit_base(with_unseen_mass(by_its_force(based.whole))), other)
        return replace(forced, notes=(_BY_FORCE, *notes, *forced.notes))

    def _all_felt(self, based: Based[Driven], noisy: Step) -> tuple[Based[Driven], Step] | None:
        """With a held force as it is recorded and one law each; None where its scatter may as well be noise.

        What the base model leaves out may be what spoke for noise, so that this is asked again beside the best law.
        noisy : what one law each does beside that noise.
        """
        force = based.problem.force_noise
        if not (based.whole.is_held and force is not None and force.noise.found and not np.any(force.start)):
            return None
        with suppress(SimulationError):
            quiet = self._followed(replace(based.whole.as_recorded, force_noise=None, otherwise=()))
            alone = _alone(quiet)
            least = min(_with_its_noise(one, based) for one in (based.fit, *noisy.fits[:1])) - DECISIVE.value
            if alone.fits and any(_with_its_noise(one, quiet) < least for one in _forms(alone.fits[0], quiet)):
                return quiet, alone
        return None

    def _unknown_between(self, found: Search, based: Based[Driven]) -> tuple[Search, Based[Driven]] | None:
        """The search with a force that is not known between its samples, where that is likelier; None where it is not.

        What a controller does between the samples of a slow log looks like another law of friction, and a law that is
        left out looks like such a force.
        """
        if not found.chosen.model.terms and found.explained:
            return None
        whole, known = based.whole, _likely(found.chosen, found.problem)
        if whole.is_held:
            # of a force that is held all is known: whether it is, its base model alone tells
            ways = [(way, 1.0) for way in whole.other_ways if not way.is_held]
        else:
            ways = [(whole, unknown_between(found.chosen, found.problem))]
        for way, share in ways:
            if share == 0.0:
                continue
            with suppress(SimulationError):
                again = self._followed(replace(way, unknown=share, otherwise=()))
                if whole.is_held and _likely(again.fit, again.problem) >= known:
                    continue
                late = search(again.problem, again.fit, again.scales)
                if _likely(late.chosen, late.problem) < known:
                    return late, again
        return None

    def _other_way(self, based: Based[Driven]) -> Based[Driven] | None:
        """With the force acting in the other way that lets the base model come nearest.

        None where there is no other, and where the base model explains the recording. Between them was chosen without
        regard to what noise of the force does.
        """
        if _leaves_noise(based.fit, based):
            return None
        found = []
        for whole in based.whole.other_ways:
            with suppress(SimulationError):
                found.append(self._followed(whole))
        return min(found, key=lambda other: under(other.fit, based.problem).chi2, default=None)

    def tried(self, problem: Driven, models: Sequence[Model], scales: Scales) -> list[Mapping[str, float]]:
        """Over the same windows, or from the start of its own base fit."""
        if isinstance(problem.starts, Windows):
            return [as_started(model, problem, scales) for model in models]
        own, scales = driven_baseline(problem)
        return [only_started(model, problem, own.model, scales) for model in models]


def _likely(found: Fit, problem: Problem) -> float:
    """BIC of a fit under the noise it leaves, and each of its names one of many."""
    names = AMONG_NAMES.value * len(found.model.terms)
    return unlikely(found, problem) + len(found.free) * math.log(problem.points) + names


def _strays(base: Fit, problem: Problem) -> bool:
    """Whether a base model shows another motion than the recording."""
    return motion_followed(base.shown.y, problem) < FOLLOWED.value


def _far_off(base: Fit, problem: Problem) -> bool:
    """Whether a base model misses hundreds of times its sensors' noise, a fine encoder's no less than any other's."""
    left = left_of(problem, base.shown)
    level = {c: max(problem.noise[c].sigma, FLOOR * float(np.std(y))) for c, y in problem.channels.items()}
    return sum(float(np.sum((left[c] / level[c]) ** 2)) for c in left) > FAR_OFF**2 * base.points


def _leaves_noise(found: Fit, based: Based[Driven]) -> bool:
    return left_by(found, based.problem, based.scales.omega, based.fit) is Left.NOISE


def _nearer(based: Based[Driven], alone: Step, other_way: Based[Driven]) -> tuple[Based[Driven], Step]:
    """The way in which the law that comes nearest comes nearer."""
    others = _alone(other_way)
    nearest = min(f.chi2 for f in (based.fit, *alone.fits[:1]))
    seen = under(min((other_way.fit, *others.fits[:1]), key=lambda f: f.bic), based.problem)
    return (other_way, others) if seen.chi2 < FORCE_HELD.value * nearest else (based, alone)


def _alone(based: Based[Driven]) -> Step:
    """Each law on the base; those that say most of the force are tried whatever they promise of the motion."""
    also = by_the_force(based.problem, based.fit.model)
    return extend(based.fit, based.problem, based.scales, also=also)


def _forms(law: Fit, based: Based[Driven]) -> Iterator[Fit]:
    """A law as its name has it, and in another form, if it has one."""
    yield law
    free = freed(law, based.problem, based.scales)
    if free is not None:
        yield free


def _with_its_noise(found: Fit, based: Based[Driven]) -> float:
    """BIC of a fit under the noise that it leaves, and each of its names one of many."""
    own = replace(based.problem, noise=noise_of(found, based.problem, based.scales.omega))
    return _likely(found, own)


def _quieter(based: Based[Driven], alone: Step) -> tuple[Based[Driven], Step]:
    """With as little noise of the force as shows beside the law that comes nearest, where that is likelier.

    Noise that stands for what a law leaves out carries the motion along as that does, and hides it.
    """
    problem, scales = based.problem, based.scales
    force, least = problem.force_noise, _likely(based.fit, problem)
    if force is None or not force.noise.found or np.any(force.start):
        return based, alone
    less: Driven | None = None
    for law in alone.fits[:_ASKED]:
        with suppress(SimulationError):
            seen, again = along(law, problem, scales)
            by = _likely(again, seen)
            # the level that is taken is not the base model's likeliest, and no law is needed for that
            least = min(least, _likely(under(based.fit, seen), seen))
            if by < least and (seen.force_noise is None or seen.force_noise.noise.sigma < force.noise.sigma):
                less, least = seen, by
    if less is None:
        return based, alone
    based = Based(based.whole, less, settle(under(based.fit, less), less, scales), scales)
    return based, _alone(based)


def _in_turns(problem: Driven, best: Fit, scales: Scales, again: Again[Driven]) -> tuple[Driven, Fit]:
    return in_turn(problem, best, scales, again, _SAME)
