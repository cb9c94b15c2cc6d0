"""Search on a driven recording whose force is fitted: laws one after another, as long as evidence grows.

With another recording as judge a further law is kept only if the force error there falls too, by more than its own
standard error explains; without one, only if it takes more off than a law does where none is needed. What is left of a
real drive is never white, so that evidence counts independent values only.

Laws as inverse dynamics show them, for a search that follows the motion.

A first look at a motion that has gone astray says little: what a law would change is seen from where the slider is not.
What is left of the force is told place by place and speed by speed, wherever a simulation may be.
"""

import math
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.interpolate import CubicSpline

from harness.core.errors import SimulationError
from harness.diagnosis.baseline.base_fit import driven_scales
from harness.diagnosis.fit.model_fit import HASTY, Fit, fit
from harness.diagnosis.fit.rmse import motion_followed
from harness.diagnosis.fit.standard_errors import leading, unit_of
from harness.diagnosis.inverse_dynamics.grade import ForceGraded, graded_by, starts, whole_in
from harness.diagnosis.inverse_dynamics.left_over import LeftOver, beyond_chance, left_over
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.parameters import base_of, free_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.problems.force_covariance import ForceCovariance
from harness.diagnosis.problems.inverse import InverseDynamics, Q
from harness.diagnosis.problems.simulated import COARSE, observe
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.rules import (
    AMONG_NAMES,
    DECISIVE,
    FORCE_HELD,
    MASS_UNSEEN,
    MISSES_MORE,
    MOST_FORCE_TERMS,
    MOVES,
    PREDICTS_WORSE,
    SHOWN_BY_FORCE,
)
from harness.diagnosis.search.search import Search, freed, less_each, under
from harness.diagnosis.smoothed_state.state import Course
from harness.estimate.noise import channel_noise
from harness.fit.series import ENOUGH
from harness.kernels.solve import Drive, Scales
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.registry import NAMED

_PUSH = next(term for term in NAMED if term.push is not None and len(term.parameters) == 1)
"""The term that does nothing but push."""
_LOOKED_AT = 5
"""Names that are extended by a further one."""
_ROUNDS, _ROUNDS_OF_MEANS = 4, 2
"""In which noise and the law beside it are found, of samples at most and of means: under the noise that is found first
another law may be nearer."""
_LAWS_OF_SAMPLES = 1
"""Laws that are named by the noise of each sample: what a second one takes there is as small as what smoothing does to
the first."""
_AS_LIKELY = 1.0
"""Of -2 log L, by which a round that changes it less is the last."""
_FIRST_STEPS, _GO_ON = 3, 2
"""Steps after which of many starts of a law the best go on, and how many: most come to the same place."""


def force_baseline(problem: InverseDynamics) -> tuple[Fit, Scales]:
    """The base model fitted to the force, and what counts as ordinary.

    Raises SimulationError when little moves or the base model cannot be fitted.
    """
    return problem.once(_force_baseline)


def _force_baseline(problem: InverseDynamics) -> tuple[Fit, Scales]:
    scales = driven_scales(problem, problem.first)
    return fit(problem.first, problem, free_of(problem.first, problem.base_names), scales), scales


def nearest(problem: InverseDynamics) -> Fit:
    """The fit that leaves least of a force: the base model's, or one with one law more, hastily.

    Raises SimulationError when little moves or the base model cannot be fitted.
    """
    return problem.once(_nearest)


def _nearest(problem: InverseDynamics) -> Fit:
    base, scales = force_baseline(problem)
    # from no mass at all no descent comes to one
    least = unseen_mass(base, problem) if problem.mass_names else 0.0
    begun = replace(base, model=replace(base.model, m=max(base.model.m, least)))
    return min((base, *with_one_more(scales, begun, problem, HASTY)), key=lambda found: found.chi2)


def unseen_mass(found: Fit, problem: InverseDynamics) -> float:
    """The mass, kg, that accelerates with less force than any fit could tell; 0 where nothing accelerates."""
    measured = problem.measured
    a = float(np.sqrt(np.mean(measured.blocks(measured.a) ** 2)))
    return MASS_UNSEEN.value * float(np.sqrt(np.mean(found.residual**2))) / a if a > 0.0 else 0.0


def under_noise(problem: Q) -> Q:
    """The problem with the noise of its sensors, as what the law leaves that says most of the force is likeliest with,
    and with its force acting as and when the recording says that it does.

    Noise is that of each sample where one law at most leaves no more of the force than that; else that of what is
    smoothed. What a law that is missing leaves is no noise, nor is what smoothing rounds off: a problem that is not
    ``by_noise`` is given back as it is. Raises SimulationError when the base model cannot be fitted.
    """
    if not problem.by_noise:
        return problem
    drive = problem.drive
    scatter = channel_noise(problem.t, drive.at(problem.t), rests=True)
    own = scatter.sigma if scatter.found else 0.0
    with suppress(SimulationError):
        held = Drive(problem.t, drive.at(problem.t), held=True)
        # which way is told by what the base model leaves, nearly
        ways = [_of_base(replace(problem, drive=one), own) for one in (drive, held)]
        likely = _noisy(min(ways, key=_unlikely), own)
        if likely.covariance is None:
            return likely
        found = search_driven(likely).search
        laws = len(found.chosen.model.terms) - len(found.base.model.terms)
        if found.left is Left.NOISE and laws <= _LAWS_OF_SAMPLES:
            return likely
    return _noisy(replace(problem, each_sample=False), own)


def _unlikely(problem: InverseDynamics) -> float:
    return math.inf if problem.covariance is None else problem.covariance.unlikely


def _noisy(problem: Q, own: float) -> Q:
    """With the likeliest noise, and when its force acts as the base model, so weighed, says: a controller that feels
    its encoder's noise makes the force follow that, which unweighed looks like another time. own : scatter of the
    force, N.
    """
    asked, later = problem, 0.0
    for _ in range(_ROUNDS if problem.each_sample else _ROUNDS_OF_MEANS):
        before, problem = problem, _weighed(problem, own, nearest(problem))
        if problem.each_sample:
            # a sample at most, over all
            base, _ = force_baseline(before)
            after, share = before.later(before.rows["u"] - base.shown.y["u"], base.shown.dy["u"])
            by = min(max(later + after, -1.0), 1.0) - later
            if by and base.residual.size * (1.0 - share) > 2.0 * DECISIVE.value:
                later += by
                problem = replace(_acting_later(asked, later), covariance=problem.covariance)
                continue
        if abs(_unlikely(problem) - _unlikely(before)) < _AS_LIKELY:
            break
    if problem.each_sample:
        return problem
    after, share = problem.later(problem.rows["u"] - force_baseline(problem)[0].shown.y["u"])
    if share >= FORCE_HELD.value:
        return problem
    return replace(_acting_later(problem, after), covariance=problem.covariance)


def _of_base(problem: Q, own: float) -> Q:
    return _weighed(problem, own, force_baseline(problem)[0])


def _weighed(problem: Q, own: float, law: Fit) -> Q:
    """With the noise that what a law leaves of the force is likeliest with."""
    seen, left = problem.measured, problem.rows["u"] - law.shown.y["u"]
    left = left - problem.later(left)[0] * seen.late
    if not np.any(left):
        return problem
    base = force_baseline(problem)[0].model
    return replace(problem, covariance=ForceCovariance.likeliest(seen, base, left, own))


def _acting_later(problem: Q, samples: float) -> Q:
    """With its force acting so many samples later, at the same instants, and a sentence that says it."""
    drive, by = problem.drive, samples * float(np.median(np.diff(problem.t)))
    said = f"The force acts {1e3 * abs(by):.2g} ms {'after' if by > 0.0 else 'before'} its stamps."
    if problem.each_sample:
        # a line between two samples would be a little less than what was between them
        at = np.clip(drive.t - by, drive.t[0], drive.t[-1])
        drive = replace(drive, u=np.asarray(CubicSpline(drive.t, drive.u)(at)))
    else:
        drive = replace(drive, t=drive.t + by)
    return replace(problem, drive=drive, enters=(*problem.enters, said))


def moving(found: Fit, problem: InverseDynamics, scales: Scales) -> Fit:
    """The same with the model's own motion over the windows. Raises SimulationError where it cannot be simulated."""
    motion = observe(found.model, problem, (), scales, COARSE)
    return replace(found, shown=replace(motion, y={**motion.y, **found.shown.y}, dy=found.shown.dy))


@dataclass(frozen=True, slots=True)
class ForceSearch:
    """Where the search ended, what counts as ordinary, what is left beside noise, and grades where that is more."""

    search: Search
    scales: Scales
    over: LeftOver
    graded: ForceGraded | None


def search_driven(problem: InverseDynamics, judge: Judge | None = None) -> ForceSearch:
    """The smallest model that says the force of a recording as well as any; graded where more than noise is left.

    Raises SimulationError when not even the base model can be fitted.
    """
    return problem.once(_searched) if judge is None else _searched(problem, judge)


def _searched(problem: InverseDynamics, judge: Judge | None = None) -> ForceSearch:
    """See ``search_driven``."""
    base, scales = force_baseline(problem)
    ground = _pushed(base, problem, scales, judge) or base
    chosen, singles, rivals, path = _grown(ground, base, problem, scales, judge)
    if chosen is not ground is not base and not _pushes(chosen, problem, scales):
        # what pushed is in the law that was found besides
        ground = base
        chosen, singles, rivals, path = _grown(ground, base, problem, scales, judge)
    if chosen is ground is not base:
        # nothing is left beside the push, which is then what is missing
        ground, singles = base, extended(base, problem, scales) or [base]
    over = left_over(chosen, problem, scales, len(chosen.model.terms) - len(ground.model.terms))
    # a law that says the force but moves worse than the base model is no name either
    as_well = 100.0 - PREDICTS_WORSE.value * (100.0 - _followed(base, problem, scales))
    laws = [f for f in singles if f is not ground and _moves(f, as_well, problem, scales)]
    problem = problem.levelled(chosen.residual, chosen.memory.independent)

    first = moving(under(base, problem), problem, scales)
    last = first if chosen is base else moving(under(chosen, problem), problem, scales)

    def seen(fits: list[Fit]) -> tuple[Fit, ...]:
        # their evidence counts alone: nobody looks at what they would have shown
        again = (last if f is chosen else under(f, problem) for f in fits)
        return tuple(sorted(again, key=lambda f: f.bic))

    if len(chosen.model.terms) == len(ground.model.terms) + 1:
        # beside a lone law other lone ones, as far as they move as well, and models of one law more
        rivals = [*laws, *(f for f in rivals if len(f.model.terms) > len(chosen.model.terms))]
    alone, rest = seen(singles), seen([*rivals, *(f for f in path if all(f is not r for r in rivals))])
    without = less_each(last, list(_refitted(last, problem, scales)), (*alone, *rest))
    left = over.left if _predicts(last, first, problem) else Left.STRUCTURE
    search = Search(problem, first, last, alone, rest, left, without, by_force=True)
    if left is Left.NOISE:
        return ForceSearch(search, scales, over, None)
    names = [under(f, problem) for f in laws]
    graded = graded_by(under(ground, problem), last, names, problem, scales, over, judged=judge is not None)
    return ForceSearch(search, scales, over, _with_motion(graded, problem, scales))


def _with_motion(graded: ForceGraded, problem: InverseDynamics, scales: Scales) -> ForceGraded:
    """With the motion of what is named."""
    named = tuple(replace(f, fit=moving(f.fit, problem, scales)) for f in graded.named)
    return replace(graded, named=named, best=graded.best if graded.kept else named[0].fit)


def _grown(
    ground: Fit, base: Fit, problem: InverseDynamics, scales: Scales, judge: Judge | None
) -> tuple[Fit, list[Fit], list[Fit], list[Fit]]:
    """The model that the search comes to, one law more at a time; single laws, the last step's rivals, and the path."""
    chosen, singles, rivals, path = ground, [ground], [ground], [base, *([] if ground is base else [ground])]
    further = partial(with_one_more, scales)
    least = min(MOVES.value, _followed(base, problem, scales))
    for _ in range(MOST_FORCE_TERMS.count):
        found = extended(chosen, problem, scales)
        if chosen is ground:
            singles = found or singles
        if not found:
            break
        rivals = found
        independent = found[0].memory.independent
        most = chosen.bic_of(independent) - (AMONG_NAMES if chosen is ground else DECISIVE).value
        better = [f for f in found[:_LOOKED_AT] if f.bic_of(independent) < most]
        if judge is not None:
            better = [f for f in better if judge.confirms(chosen.model, f.model)]
        elif better:
            allowed = [(f, f.spare_within(independent, most)) for f in better]
            better = beyond_chance(allowed, chosen, problem, scales, further)
        # what moves otherwise or cannot be followed is no model of the motion, however well it says the force
        moves = (
            f for f in better if _moves(f, least, problem, scales) and (judge or _of_some_size(f, problem, scales))
        )
        kept = _likeliest_form(moves, independent, problem, scales) if chosen is ground else next(moves, None)
        if kept is None:
            break
        if len(chosen.model.terms) == len(ground.model.terms) + 1:
            # one effect in another form than its name's takes two names to follow
            free = freed(chosen, problem, scales)
            if free is not None and kept.bic_of(independent) > free.bic_of(independent) - DECISIVE.value:
                chosen = free
                path.append(free)
                break
        chosen = kept
        path.append(kept)
        if ground is not base and not _pushes(kept, problem, scales):
            # grown again without the push, whatever else there is
            break
    return chosen, singles, rivals, path


def _likeliest_form(laws: Iterable[Fit], independent: float, problem: InverseDynamics, scales: Scales) -> Fit | None:
    """Of laws, best first, that which says most in its likeliest form, of those that the evidence does not part.

    An effect in another form than its name's is as far from that as from another name.
    """
    first, by_form = None, list[tuple[float, Fit]]()
    for law in laws:
        first = first or law
        if law.bic_of(independent) > first.bic_of(independent) + DECISIVE.value:
            break
        free = freed(law, problem, scales)
        by_form.append((min(f.bic_of(independent) for f in (law, free) if f is not None), law))
    return min(by_form, key=lambda one: one[0])[1] if len(by_form) > 1 else first


def _of_some_size(found: Fit, problem: InverseDynamics, scales: Scales) -> bool:
    """Whether the last law of a model is surely there by its own number, where reversals do not count.

    A branch that relaxes within what is left out beside them is viscous friction in all but name: it takes that over
    whole, and what its own two numbers are the force does not show.
    """
    if not problem.guarded or problem.alone:
        return True
    seen = problem.levelled(found.residual, found.memory.independent)
    share = leading(under(found, seen), seen, len(found.model.terms) - 1, scales.omega)
    return not share > SHOWN_BY_FORCE.value


def _pushes(found: Fit, problem: InverseDynamics, scales: Scales) -> bool:
    """Whether a model that begins with a constant force is worse without it."""
    bare, independent = next(_refitted(found, problem, scales)), found.memory.independent
    return bare is None or bare.bic_of(independent) > found.bic_of(independent) + AMONG_NAMES.value


def _pushed(base: Fit, problem: InverseDynamics, scales: Scales, judge: Judge | None) -> Fit | None:
    """The base model with a constant force, which an axis without a spring has beside what else is missing.

    A weight or a tilt is no rival of other laws: what they take is a share of what it leaves. None where it is not
    seen, and for several recordings, of which each has a level of its own.
    """
    if problem.restoring is not Restoring.NONE or problem.alone:
        return None
    model = replace(base.model, terms=(ModelTerm(_PUSH, (0.0,)),))
    try:
        found = fit(model, problem, free_of(model, base_of(base.free)), scales)
    except SimulationError:
        return None
    independent = found.memory.independent
    seen = found.bic_of(independent) < base.bic_of(independent) - AMONG_NAMES.value
    return found if seen and (judge is None or judge.confirms(base.model, found.model)) else None


def _predicts(found: Fit, base: Fit, problem: InverseDynamics) -> bool:
    """Whether a model's own motion misses hardly more than the base model's: what says a force but moves worse explains
    nothing, though noise that its law makes large, or a controller's answer to noise, may leave as much of the force.

    What is not known of the force between its samples moves both astray.
    """
    missed, usual = (100.0 - motion_followed(one.shown.y, problem) for one in (found, base))
    return missed <= MISSES_MORE.value * usual


def _moves(found: Fit, least: float, problem: InverseDynamics, scales: Scales) -> bool:
    """Whether a model's own motion over the windows can be simulated and follows at least so much (%)."""
    percent = _followed(found, problem, scales)
    return percent > -math.inf and percent >= least


def _followed(found: Fit, problem: InverseDynamics, scales: Scales) -> float:
    """NRMSE fit of a model's own motion, %; -inf where it cannot be simulated."""
    try:
        return motion_followed(moving(found, problem, scales).shown.y, problem)
    except SimulationError:
        return -math.inf


def _refitted(found: Fit, problem: InverseDynamics, scales: Scales) -> Iterator[Fit | None]:
    """A model of several terms less each of them in turn, fitted again; None where a law overflows."""
    terms = found.model.terms
    for i in range(len(terms)):
        model = replace(found.model, terms=terms[:i] + terms[i + 1 :])
        try:
            yield fit(model, problem, free_of(model, base_of(found.free)), scales)
        except SimulationError:
            yield None


def extended(current: Fit, problem: InverseDynamics, scales: Scales) -> list[Fit]:
    """Fits with one more law, the best of each, best first by evidence."""
    best: dict[str, Fit] = {}
    for found in with_one_more(scales, current, problem):
        key = found.model.terms[-1].term.key
        if key not in best or found.chi2 < best[key].chi2:
            best[key] = found
    if not best:
        return []
    independent = min(best.values(), key=lambda f: f.chi2).memory.independent
    return sorted(best.values(), key=lambda f: f.bic_of(independent))


def with_one_more(scales: Scales, current: Fit, problem: InverseDynamics, share: float = 0.0) -> Iterator[Fit]:
    """Fits with one more law, each from its best probes. share : that a step must gain; 0 for a thorough fit."""
    for law in _by_law(starts(current, problem, scales)):
        for model in _begun(law, current, problem, scales):
            for found in _fitted(model, current, problem, scales, share):
                if whole_in(found.model, problem.measured):
                    yield found


def _begun(law: list[Model], current: Fit, problem: InverseDynamics, scales: Scales) -> list[Model]:
    """Starts of a law that go on: of many those that a few steps have brought furthest down."""
    if len(law) <= _GO_ON:
        return law
    begun = (f for model in law for f in _fitted(model, current, problem, scales, HASTY, _FIRST_STEPS))
    return [f.model for f in sorted(begun, key=lambda f: f.chi2)[:_GO_ON]]


def _by_law(models: Iterable[Model]) -> Iterable[list[Model]]:
    """Models by the law that each has last."""
    laws: dict[str, list[Model]] = {}
    for model in models:
        laws.setdefault(model.terms[-1].term.key, []).append(model)
    return laws.values()


def _fitted(
    model: Model, current: Fit, problem: InverseDynamics, scales: Scales, share: float, steps: int = 40
) -> Iterator[Fit]:
    """The fit of a model with one law more, where it can be made."""
    with suppress(SimulationError):
        free = free_of(model, base_of(current.free))
        yield fit(model, problem, free, scales, steps, thorough=share == 0.0, share=share)


def left_said(problem: Problem, drive: Drive, independent: int, over: LeftOver) -> str:
    """What a fitted force leaves, as so many independent values, said plainly, beside what noise would leave."""
    level = problem.noise["u"].sigma
    unit = unit_of("N", problem)
    share = 100.0 * level / math.sqrt(float(np.mean(drive.u**2)))
    few = f"; they count as {independent} independent values, too few for their errors to be trusted"
    if over.noise is None:
        beside = "the model's own motion cannot be simulated to tell whether that is noise"
    elif over.left is Left.NOISE:
        beside = "the model's own motion, simulated with the noise that was found, leaves as much"
    else:
        noise = f"{math.sqrt(over.noise):.3g} {unit}"
        beside = (
            f"the model's own motion, simulated with the noise that was found, leaves {noise}, so that the rest is the"
            " drive's own"
        )
    rest = few if independent < ENOUGH else ""
    return f"{level:.3g} {unit} rms of the force ({share:.2g} %) are left over; {beside}{rest}"


_LAWS = 6
"""Laws that go on, of those that say most of the force: they bound the work."""


def by_the_force(problem: Driven, base: Model) -> tuple[Model, ...]:
    """The base model with one law each, and with numbers that its force asks for; none where too little moves.

    base : fitted to the motion, released as these are.
    """
    with suppress(SimulationError):
        forces = InverseDynamics.of(problem, Course.of(problem.t, problem.channels, problem.noise).anew(math.inf))
        found, scales = force_baseline(forces)
        laws = extended(found, forces, scales)[:_LAWS]
        return tuple(_released_as(base, one.model) for one in laws)
    return ()


def _released_as(base: Model, model: Model) -> Model:
    return replace(model, x0=base.x0 + base.offset - model.offset, v0=base.v0, t0=base.t0)
