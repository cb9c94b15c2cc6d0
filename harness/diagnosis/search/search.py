"""The search for the model: base, one term, two, as long as evidence grows; noise is taken anew from what is left.

BIC with known noise rules. Held-out prediction is reported beside it; where the two disagree BIC stands, because a
stretch that is left out says little of what acts elsewhere, and a warning says so.

The form of a law freed by one number, before a second name is looked for: one effect in another form is one name.
"""

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import zip_longest
from typing import TypeAlias

import numpy as np

from harness.core.errors import SimulationError
from harness.diagnosis.baseline.residual_noise import coloured_whole, residual_noise, window_of
from harness.diagnosis.fit.model_fit import Fit, fit, whitened
from harness.diagnosis.parameters import base_of, free_of
from harness.diagnosis.problem import P, Problem
from harness.diagnosis.residual_tests.structure import Left, left_by, structure
from harness.diagnosis.rules import AMONG_NAMES, COLOUR_ALONE, DECISIVE, MOST_TERMS, SECOND_TERM
from harness.diagnosis.search.against import against, among_names, in_turn, taken_by_two
from harness.diagnosis.search.extend import Step, extend, key_of, pair_up, prune, settle
from harness.diagnosis.search.look import Look
from harness.diagnosis.search.screen import applicable
from harness.estimate.noise import Noise
from harness.kernels.solve import Scales
from harness.model.model import Model, ModelTerm
from harness.model.registry import NAMED, forms_of, term
from harness.model.term import Term


def freed(found: Fit, problem: Problem, scales: Scales) -> Fit | None:
    """A model with the form of one of its laws free, fitted from where it ended; None where no form is another."""
    best = min(forms(found, problem, scales), key=lambda f: f.bic, default=None)
    return None if best is None else settle(best, problem, scales)


def forms(
    found: Fit, problem: Problem, scales: Scales, of: Callable[[str], tuple[Term, ...]] = forms_of
) -> Iterator[Fit]:
    """A model with the form of each of its laws free, as far as it could be fitted. of : what forms a law has."""
    base, terms = base_of(found.free), found.model.terms
    for i, entry in enumerate(terms):
        for form in of(entry.term.key):
            assert form.freed is not None
            own = entry.values[: len(term(form.frees).parameters)]
            for values in form.freed(own, problem.duration, scales.v):
                model = replace(found.model, terms=(*terms[:i], ModelTerm(form, values), *terms[i + 1 :]))
                with suppress(SimulationError):
                    yield fit(model, problem, free_of(model, base), scales, thorough=False)


_BEAM = 4
"""First terms that are extended by a second."""
_FREED = 2
"""First terms whose form is freed."""
_FEWEST_STARTS = 4
"""First terms after which a pair that leaves noise alone ends the search."""
_PAIRED = 6
"""Pairs of laws that no look promised and that are fitted all the same: they bound the work."""
_NOISE_MOVED = 0.01
"""Share by which a noise must move to be taken anew."""


@dataclass(frozen=True, slots=True)
class Search:
    """Where the search ended.

    problem : with the noise as the chosen model leaves it. base, chosen : fits under that noise. singles : each
    catalogue name alone, best first. rivals : fits of as many terms as the chosen one, best first. left : what the
    chosen model leaves. without : where the chosen model has several terms, it less each of them in turn, the best
    fit known of the rest; None where none could be simulated. by_force : whether the force was fitted. begun : where
    first looks left each law alone. doubted : a pair that meets the noise on too few words of the motion to say so, or
    whose laws are both of ``doubted_by`` ("speed", "position") and no likelier than a smooth curve of it.
    """

    problem: Problem
    base: Fit
    chosen: Fit
    singles: tuple[Fit, ...]
    rivals: tuple[Fit, ...]
    left: Left
    without: tuple[Fit | None, ...] = ()
    by_force: bool = False
    begun: tuple[Model, ...] = ()
    doubted: Fit | None = None
    doubted_by: str = ""

    @property
    def explained(self) -> bool:
        """Whether no structure is left."""
        return self.left is not Left.STRUCTURE


def noise_of(found: Fit, problem: Problem, omega: float) -> dict[str, Noise]:
    """Noise per channel from what a fit leaves.

    Windows much shorter than the motion tell noise from misfit, but not the colour of a coarse recording. Where the
    whole residual is nothing but noise of first-order colour, it is that. Of what is no motion it is as prepared.
    """
    if not problem.moves:
        return dict(problem.noise)
    period = 2.0 * math.pi / omega
    left = {c: problem.even(c, y - found.shown.y[c]) for c, y in problem.channels.items()}
    said = {c: residual_noise(problem.t, left[c], y, period, problem.noise[c]) for c, y in problem.channels.items()}
    if not problem.slow_is_sensors:
        return problem.own_noise(said, left)
    width = window_of(problem.t, period)
    whole = {c: coloured_whole(left[c], problem.weight[c], said[c], width) for c in said}
    if all(whole[c] is said[c] for c in said):
        return said
    coloured = replace(problem, noise={**problem.noise, **whole})
    return whole if structure(under(found, coloured), coloured, omega).p_value > COLOUR_ALONE.value else said


def under(found: Fit, problem: Problem) -> Fit:
    """The same model seen with another noise."""
    shown = found.shown
    residual, jacobian = whitened(problem, problem.left(shown)), whitened(problem, shown.dy)
    return replace(found, residual=residual, jacobian=jacobian, chi2=float(residual @ residual), points=problem.points)


def _simplest(fits: tuple[Fit, ...], before: Fit, gain: float, problem: Problem) -> Fit:
    """The best, unless a smaller model is as good that gains as much over the one before."""
    most = min(against(fits[0], problem) + DECISIVE.value, against(before, problem) - gain)
    near = [f for f in fits if against(f, problem) < most] or [fits[0]]
    return min(near, key=lambda f: (len(f.free), against(f, problem)))


def _moved(new: dict[str, Noise], old: Problem) -> bool:
    return any(
        abs(math.log(n.sigma / old.noise[c].sigma)) > _NOISE_MOVED or n.phi != old.noise[c].phi for c, n in new.items()
    )


Again: TypeAlias = Callable[[P, Fit], tuple[P, Fit]]
Renew: TypeAlias = Callable[[P, Fit, Scales, Again[P]], tuple[P, Fit]]
"""What depends on a model, and the model's fit: from a problem and its best fit, by way of one turn of both."""


def once(problem: P, best: Fit, scales: Scales, again: Again[P]) -> tuple[P, Fit]:
    """The noise alone depends on the model, and a turn is worth its time where that has moved."""
    return again(problem, best) if _moved(noise_of(best, problem, scales.omega), problem) else (problem, best)


def _renewed(
    problem: P, scales: Scales, best: Fit, others: tuple[Fit, ...], renew: Renew[P]
) -> tuple[P, Fit, tuple[Fit, ...]]:
    """Take the noise from what the best fit leaves, and see all fits with it."""

    def again(problem: P, found: Fit) -> tuple[P, Fit]:
        problem = replace(problem, noise=noise_of(found, problem, scales.omega))
        return problem, settle(under(found, problem), problem, scales)

    new, found = renew(problem, best, scales, again)
    if found is best:
        return problem, best, others
    return new, found, tuple(under(f, new) for f in others)


def search(problem: P, base: Fit, scales: Scales, renew: Renew[P] = once, alone: Step | None = None) -> Search:
    """Find the smallest model that explains a recording. renew : what else follows a model once it is found.

    alone : each law on the base, where that step has been made.
    """
    found = levelled(_search(problem, base, scales, renew, alone or extend(base, problem, scales)))
    gained = against(found.base, found.problem) - against(found.chosen, found.problem)
    if not found.chosen.model.terms or gained > AMONG_NAMES.value + problem.spare:
        return found
    # what counts as noise has grown since the term was decided for
    return replace(
        found, chosen=found.base, without=(), left=left_by(found.base, found.problem, scales.omega, found.base)
    )


def _search(problem: P, base: Fit, scales: Scales, renew: Renew[P], alone: Step) -> Search:
    # what a term must take off besides: as much as may be left beyond what whitening allows for
    beyond = problem.spare
    first, second = AMONG_NAMES.value + beyond, SECOND_TERM.value + beyond
    singles = in_turn(alone.fits, problem)
    if not singles or against(singles[0], problem) > against(base, problem) - first:
        left = left_by(base, problem, scales.omega, base)
        return Search(problem, base, base, singles, singles, left, begun=alone.begun)
    problem, best, singles = _renewed(problem, scales, singles[0], singles, renew)
    base = under(base, problem)
    singles = in_turn((*(f for f in singles if key_of(f) != key_of(best)), best), problem)
    chosen, rivals = _simplest(singles, base, first, problem), singles
    left = left_by(chosen, problem, scales.omega, base)
    beam = _beam(singles)
    # of a table the form is asked at once: beside a curve of any shape a name is worth what its best form says
    if chosen.model.terms and (left is Left.STRUCTURE or not problem.moves):
        free, alike, rest = _with_free_form(chosen, singles[:_FREED], singles, problem, scales, base)
        if rest is not Left.STRUCTURE:
            problem, best, singles = _renewed(problem, scales, free, alike, renew)
            return Search(problem, under(base, problem), best, singles, singles, rest, begun=alone.begun)
    while len(chosen.model.terms) < (MOST_TERMS.count if problem.pairs_searched else 1):
        step = extend(chosen, problem, scales) if left is Left.NOISE else to_an_end(chosen, problem, scales)
        least = against(chosen, problem) - second
        promising = any(against(f, problem) < least for f in step.fits)
        if left is Left.NOISE and not promising:
            break
        # where a noisy force leaves as much as a second term would, pairs are no better than one another
        plain = left is Left.NOISE or beyond > SECOND_TERM.value
        found = step.fits if plain else _wider(step, chosen, beam, singles, problem, scales, base)
        found = in_turn(found, problem)
        if not found or against(found[0], problem) > least:
            break
        if lone := _lone_before(found[0], chosen, singles, problem, scales, base):
            problem, chosen, rivals = _renewed(problem, scales, lone[0], lone, renew)
            base = under(base, problem)
            left = left_by(chosen, problem, scales.omega, base)
            break
        problem, best, found = _renewed(problem, scales, found[0], found, renew)
        found = in_turn((*(f for f in found if key_of(f) != key_of(best)), best), problem)
        base = under(base, problem)
        singles = in_turn([under(f, problem) for f in singles], problem)
        chosen, rivals = _simplest(found, under(chosen, problem), second, problem), found
        left = left_by(chosen, problem, scales.omega, base)
        beam = list(found[:2])
    chosen, rivals = _beside_rivals(chosen, rivals, problem, scales) if left is Left.NOISE else (chosen, rivals)
    # beside a push, which is the same either way, the form of a law of friction is found as it is alone
    pushed = any(entry.term.push is not None for entry in chosen.model.terms)
    if left is Left.STRUCTURE and pushed and not problem.moves and len(chosen.model.terms) == 2:
        bent = freed(chosen, problem, scales)
        if bent is not None and bent.bic < chosen.bic and left_by(bent, problem, scales.omega, base) is Left.NOISE:
            chosen, left, rivals = bent, Left.NOISE, in_turn((bent, *rivals), problem)
    pruned, without = prune(chosen, problem, scales)
    if len(pruned.model.terms) < len(chosen.model.terms):
        chosen = settle(pruned, problem, scales)
        rivals = singles if len(chosen.model.terms) <= 1 else rivals
        left = left_by(chosen, problem, scales.omega, base)
    without = less_each(chosen, without, (*singles, *rivals))
    return Search(problem, base, chosen, singles, rivals, left, without, begun=alone.begun)


def _lone_before(
    pair: Fit, chosen: Fit, singles: tuple[Fit, ...], problem: Problem, scales: Scales, base: Fit
) -> tuple[Fit, ...]:
    """What comes before a pair: one of its laws with its form free, and the others alone; none where the pair does.

    A law whose formula is off may need company to be seen at all, and none once its form is free.
    """
    if len(chosen.model.terms) != 1:
        return ()
    first = [chosen]
    for entry in pair.model.terms:
        if (entry.term.name,) != key_of(chosen) and forms_of(entry.term.key):
            model = replace(pair.model, terms=(entry,))
            with suppress(SimulationError):
                first.append(fit(model, problem, free_of(model, base_of(pair.free)), scales, thorough=False))
    free, alike, _ = _with_free_form(chosen, first, (chosen,), problem, scales, base)
    if against(pair, problem) <= against(free, problem) - SECOND_TERM.value - problem.spare:
        return ()
    rest = in_turn((*alike, *singles[1:]), problem)
    return (free, *(f for f in rest if f is not free))


def _with_free_form(
    chosen: Fit, first: Sequence[Fit], singles: Sequence[Fit], problem: Problem, scales: Scales, base: Fit
) -> tuple[Fit, tuple[Fit, ...], Left]:
    """The first laws with their form free, beside all laws, and the one among them that is chosen with what it leaves.

    One effect in another form than its name's takes two names to follow; a name with one number more comes first. One
    that leaves noise alone comes before those that do not, unless they are as likely: chance decides which side of a
    test two fall that fit alike.
    """
    forms = [f for f in (freed(one, problem, scales) for one in first) if f is not None]
    better = [f for f in forms if f.bic < chosen.bic]
    alone = [f.bic for f in better if left_by(f, problem, scales.omega, base) is Left.NOISE]
    noise = [f for f in better if alone and f.bic < min(alone) + DECISIVE.value]
    names = {key_of(f) for f in noise or better}
    both = in_turn((*(noise or better), *(f for f in singles if key_of(f) not in names)), problem)
    return (both[0] if names else chosen), both, Left.NOISE if noise else Left.STRUCTURE


def _beside_rivals(
    chosen: Fit, rivals: tuple[Fit, ...], problem: Problem, scales: Scales
) -> tuple[Fit, tuple[Fit, ...]]:
    """A lone law and its rivals, the nearest of other names in a form that fits as well: a formula does not say which
    it is.

    What fits less well in any form stays as the catalogue has it. What is bent beyond its name gives way where another
    says as much within its own: the two are one function there, as a stop on both sides that acts from near the middle
    on is play.
    """
    if len(chosen.model.terms) != 1 or not problem.moves:
        return chosen, rivals
    own, least = key_of(chosen), among_names(chosen, problem) + DECISIVE.value
    nearest = [f for f in in_turn(rivals, problem) if f.model.terms and key_of(f) != own][:_FREED]

    def best(one: Fit) -> Fit:
        if not any(one is other for other in nearest):
            return one
        bent = [f for f in forms(one, problem, scales) if among_names(f, problem) < least]
        return min((one, *bent), key=lambda f: among_names(f, problem))

    rivals = in_turn([best(one) for one in rivals], problem)
    alike = [f for f in (chosen, *rivals) if f.model.terms and among_names(f, problem) < least]
    named = sorted((f for f in alike if f.explains_as_named), key=lambda f: among_names(f, problem))
    if not named:
        return chosen, rivals
    beyond = [f for f in alike if not f.explains_as_named]
    best_named = chosen if chosen.explains_as_named else named[0]
    return best_named, tuple(f for f in rivals if all(f is not one for one in beyond))


def less_each(chosen: Fit, fitted: Sequence[Fit | None], searched: Sequence[Fit]) -> tuple[Fit | None, ...]:
    """A model of several terms less each in turn, the best fit known of each; none of a lone term.

    fitted : from the model's own numbers, which may end beside what the search came to from others. searched : fits of
    any laws.
    """
    laws = sorted(entry.term.key for entry in chosen.model.terms)
    found = []
    for entry, one in zip(chosen.model.terms, fitted, strict=True) if len(laws) > 1 else ():
        rest = laws.copy()
        rest.remove(entry.term.key)
        same = [f for f in searched if sorted(e.term.key for e in f.model.terms) == rest]
        found.append(min((f for f in (one, *same) if f is not None), key=lambda f: f.bic, default=None))
    return tuple(found)


def levelled(found: Search) -> Search:
    """The noise as what an explaining model leaves: every sample says something of it then, not the fast part alone."""
    if not found.explained:
        return found
    problem, n = found.problem, found.problem.t.size
    noise = {}
    for i, channel in enumerate(problem.channels):
        r = found.chosen.residual[i * n : (i + 1) * n]
        count = max(np.count_nonzero(problem.weight[channel]) - len(found.chosen.free) / len(problem.channels), 1.0)
        level = math.sqrt(float(r @ r) / count)
        old = problem.noise[channel]
        noise[channel] = replace(old, sigma=old.sigma * level) if old.found and level > 0.0 else old
    problem = replace(problem, noise=noise)
    same = found.chosen is found.base
    base = under(found.base, problem)
    chosen = base if same else under(found.chosen, problem)

    def seen(fits: tuple[Fit, ...]) -> tuple[Fit, ...]:
        again = (chosen if f is found.chosen else under(f, problem) for f in fits)
        return tuple(sorted(again, key=lambda f: f.bic))

    without = tuple(f if f is None else under(f, problem) for f in found.without)
    return replace(
        found,
        problem=problem,
        base=base,
        chosen=chosen,
        singles=seen(found.singles),
        rivals=seen(found.rivals),
        without=without,
    )


def _beam(singles: tuple[Fit, ...]) -> list[Fit]:
    """Singles to build pairs on: the best and, in turn, the best of the plain laws that a flexible one may outdo."""
    plain = [f for f in singles if len(f.model.terms[0].values) == 1]
    in_turn = [f for pair in zip_longest(singles[:_BEAM], plain[:_BEAM]) for f in pair if f is not None]
    return [f for i, f in enumerate(in_turn) if all(f is not other for other in in_turn[:i])]


def _wider(
    first: Step,
    chosen: Fit,
    beam: list[Fit],
    singles: Sequence[Fit],
    problem: Problem,
    scales: Scales,
    base: Fit,
) -> tuple[Fit, ...]:
    """Extensions of the chosen model and of its rivals, best first, as far as it takes to find one that explains.

    A pair is tried with each of its terms exchanged before it counts as the best one. Where none explains, singles are
    paired that no look saw beside one another, and the best are extended though no law promises an end.
    """
    steps, waiting, tried = [first], [f for f in beam if f is not chosen], 1
    while waiting:
        best = _merged(steps)[:1]
        parts = [f for f in waiting if best and set(key_of(f)) < set(key_of(best[0]))]
        enough = tried >= _FEWEST_STARTS and not parts
        if enough and best and left_by(best[0], problem, scales.omega, base) is Left.NOISE:
            break
        following, tried = (parts[0] if parts else waiting[0]), tried + 1
        steps.append(to_an_end(following, problem, scales))
        waiting = [f for f in waiting if f is not following]
    fitted = {key for step in steps for key in map(key_of, step.fits)}
    unseen = [f for f in beam[:_FEWEST_STARTS] if all(step.before is not f or not step.fits for step in steps)]
    further: list[Callable[[], Step]] = [
        lambda: pair_up(complementary(singles, fitted, base, problem), base, problem, scales),
        *(partial(extend, f, problem, scales) for f in unseen),
    ]
    for step in further:
        best = _merged(steps)[:1]
        if best and left_by(best[0], problem, scales.omega, base) is Left.NOISE:
            break
        steps.append(step())
    return _merged(steps)


def complementary(
    alone: Sequence[Fit], fitted: Collection[tuple[str, ...]], base: Fit, problem: Problem
) -> list[tuple[Model, ...]]:
    """Starts of the pairs of laws that together explain most to first order, each from where both ended alone.

    A law that is alone bends the base model's numbers to what the other does, from where no look sees the other.
    alone : fits of one law. fitted : names of pairs that need not be. base : under the same noise.
    """
    taken = taken_by_two(alone, base)
    pairs = []
    for i, one in enumerate(alone):
        for j, other in enumerate(alone[:i]):
            names = tuple(sorted((*key_of(one), *key_of(other))))
            if names not in fitted and applicable(other.model.terms[0].term, one.model, problem):
                pairs.append((float(taken[i, j]), one, other))
    pairs.sort(key=lambda pair: -pair[0])
    return [(_both(one, other), _both(other, one)) for _, one, other in pairs[:_PAIRED]]


def _both(one: Fit, other: Fit) -> Model:
    """The model of a law with another as that ended alone."""
    return replace(one.model, terms=(*one.model.terms, *other.model.terms))


def to_an_end(current: Fit, problem: Problem, scales: Scales) -> Step:
    """Extensions that may explain, of a model that does not; none where no law promises that."""
    look = Look.at(current, problem, scales, NAMED)
    return extend(current, problem, scales, look=look) if look.promises_an_end else Step(current, ())


def _merged(steps: list[Step]) -> tuple[Fit, ...]:
    """Fits of several steps, the best of each set of names, best first."""
    best: dict[tuple[str, ...], Fit] = {}
    for step in steps:
        for found in step.fits:
            key = key_of(found)
            if key not in best or found.bic < best[key].bic:
                best[key] = found
    return tuple(sorted(best.values(), key=lambda f: f.bic))
