"""What is said of a term that is named: its sentence, parameters, evidence, and what could stand in its place.

A term is named by a search that it explains, or by the grades of a misfit or of a fitted force. Of a misfit stands
here, too, what the best model found leaves of it: how much, and what it hangs on.

A law is named by its mechanism; its formula is one of several that people publish, and beside another one, or beside
another name that is listed, what is left to viscous and Coulomb friction is another share. The standard errors of a fit
know nothing of that: what another form would shift the other numbers by is said here.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.quantity import Quantity
from harness.diagnosis.baseline.words import Strokes
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.standard_errors import AT_LEAST, base_parameters, plain_parameters, term_parameters
from harness.diagnosis.grading.clocks import beat, on_the_swing
from harness.diagnosis.grading.contest import Finalist, of_search
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.grading.lone import next_best, stand_ins
from harness.diagnosis.grading.prediction import Predicted
from harness.diagnosis.inverse_dynamics.grade import ForceGraded
from harness.diagnosis.motion import place_of
from harness.diagnosis.outcome import Alternative, Grade, Mechanism, Prediction, Remainder
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import DECISIVE, MOST_LISTED
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search, forms, under
from harness.fit.series import memory
from harness.kernels.solve import Scales
from harness.model.model import ModelTerm
from harness.model.registry import not_parted, other_forms_of

_SPRING_SEEN = 0.1
"""Of friction and damping: a spring whose force is weaker has no rest position that could be spoken of."""


def _of(found: Fit, problem: Problem, index: int, omega: float, explained: bool, delta_bic: float) -> Mechanism:
    """A term of a fit, number ``index``, with its numbers; explained : whether the fit leaves noise. omega : rad/s."""
    entry = found.model.terms[index]
    parameters = term_parameters(found, problem, index, omega, explained)
    values = {name: f"at least {q}" if q.why == AT_LEAST else str(q) for name, q in parameters.items()}
    # a spring that is there beside friction and damping; 0 of one that no force shows
    model, shown = found.model, found.shown
    rest = model.c * float(np.max(np.abs(shown.v))) + model.f_k
    stiffness = model.k if model.k * float(np.max(np.abs(shown.x))) > _SPRING_SEEN * rest else 0.0
    said = entry.term.say({**values, **entry.term.words(entry.values, stiffness)})
    return Mechanism(entry, said, parameters, delta_bic, place_of(entry, found, problem, omega))


def mechanism(found: Search, index: int, omega: float) -> Mechanism:
    """All of a term of the chosen model."""
    entry = found.chosen.model.terms[index]
    one = _of(found.chosen, found.problem, index, omega, True, left_without(found, index).bic - found.chosen.bic)
    return replace(one, alternatives=_alternatives(found, entry, omega), share=_share(found, entry))


def each_of(first: Mechanism, found: Search, omega: float) -> tuple[Mechanism, ...]:
    """A lone law that is listed, with those that could stand in its place, else the next. omega : rad/s."""
    fits = {key_of(f)[0]: f for f in reversed(found.rivals) if len(f.model.terms) == 1}
    names = [a.name for a in first.alternatives] or [name for name, _ in next_best(found)]
    others = (mechanism(replace(found, chosen=fits[name]), 0, omega) for name in names)
    return tuple(replace(m, grade=Grade.ONE_OF, alternatives=()) for m in (first, *others))


def _share(found: Search, entry: ModelTerm) -> float | None:
    """Share of the base's misfit beyond noise that a term takes off alone; None where it was not fitted alone."""
    excess = found.base.chi2 - found.base.points
    alone = [found.chosen] if len(found.chosen.model.terms) == 1 else list(found.singles)
    same = [f.chi2 for f in alone if key_of(f) == (entry.term.name,)]
    return min(max((found.base.chi2 - min(same)) / excess, 0.0), 1.0) if same and excess > 0.0 else None


def left_without(found: Search, index: int) -> Fit:
    """The chosen model less a term, the rest fitted again; the base where that is all or cannot be simulated."""
    rest = found.without[index] if len(found.chosen.model.terms) > 1 else None
    return found.base if rest is None else rest


def _alternatives(found: Search, entry: ModelTerm, omega: float) -> tuple[Alternative, ...]:
    """Names that could stand in a term's place, the likeliest first where it is alone; a clock on the swing follows any
    other, and comes last.
    """
    listed: list[tuple[bool, float, float, str]] = []
    likely = of_search(found) if len(found.chosen.model.terms) == 1 else {}
    rate = beat(found.base, found.problem, omega)
    for name, rival in stand_ins(found, entry):
        clock = any(on_the_swing(e, rate, found.problem.duration) for e in rival.model.terms)
        listed.append((clock, -likely.get((name,), 0.0), rival.bic - found.chosen.bic, name))
    return tuple(Alternative(name, delta) for *_, delta, name in sorted(listed)[: MOST_LISTED.count - 1])


def of_misfit(finalist: Finalist, graded: Graded, base: Fit, problem: Problem) -> Mechanism:
    """A law that a misfit was graded by; base : the base fit, under the noise of ``problem``."""
    seen = under(finalist.fit, problem)
    one = _of(
        seen, problem, len(seen.model.terms) - 1, graded.misfit.scales.omega, False, delta_bic=base.bic - seen.bic
    )
    assert graded.grade is not None
    return replace(
        one,
        alternatives=_beside_main(finalist, graded) if graded.grade is Grade.MAIN else (),
        grade=graded.grade,
        share=finalist.share,
        held_out=prediction(graded.base_held, finalist.held),
        forward=prediction(graded.base_run, finalist.run),
        chance=graded.chance if finalist is graded.named[0] else None,
    )


def _beside_main(first: Finalist, graded: Graded) -> tuple[Alternative, ...]:
    """Names that are near, and those that this recording cannot part from the first whatever their evidence says.

    A law of the amplitude and one of the time follow one decay alike, to the shape that small effects give it.
    """
    others = [f for f in graded.finalists if f.name != first.name and not f.clock]
    parted = graded.misfit.problem.parts_amplitude_from_time
    twins = {f.name for f in others if not parted and f.large and not_parted(first.name, f.name)}
    found = [Alternative(f.name, first.gain - f.gain) for f in others]
    listed = [a for a in found if a.delta_bic < DECISIVE.value or a.name in twins]
    return tuple(sorted(listed, key=lambda a: a.name not in twins))[: MOST_LISTED.count - 1]


def prediction(before: Predicted | None, after: Predicted | None) -> Prediction | None:
    """What two models miss of the same blocks, as results say it."""
    if before is None or after is None:
        return None
    ratios = after.by_span / np.maximum(before.by_span, 1e-300)
    return Prediction(before.spans, before.rmse, after.rmse, tuple(float(r) for r in ratios))


def of_force(found: Search, graded: ForceGraded, omega: float) -> tuple[Mechanism, ...]:
    """What is named of a fitted force, the main one first; then what else the search kept beside it. omega : rad/s.

    Last what the base has besides friction, a constant force of an axis that nothing pulls back: it is there whatever
    else is, and the shares of others are of what it leaves.
    """
    finalists = {f.name: f for f in graded.finalists}
    first = {f.name: i for i, f in enumerate(graded.named)}
    base, said = len(graded.base.model.terms), list[tuple[int, Mechanism]]()
    for i in range(base, len(graded.refined.model.terms)) if graded.kept else ():
        one = mechanism(found, i, omega)
        again = any(m.name == one.name for _, m in said)
        one = _with_grade(one, graded, None if again else finalists.get(one.name))
        if one.name in first and not again:
            said.append((first[one.name], one))
            continue
        # alone a law beside the first, or a further one of its name, may take nothing: it was kept for what the model
        # is worse without it
        more = left_without(found, i).chi2 - found.chosen.chi2
        share = float(np.clip(more / graded.excess, 0.0, 1.0))
        said.append((len(first), replace(one, grade=Grade.MINOR, share=share)))
    kept = {m.name for _, m in said}
    for f in (f for f in graded.named if f.name not in kept):
        index = len(f.fit.model.terms) - 1
        alone = replace(found, chosen=f.fit, rivals=found.singles, without=(None,) * index + (graded.base,))
        said.append((first[f.name], _with_grade(mechanism(alone, index, omega), graded, f)))
    ranked = sorted(said, key=lambda one: (one[0], -one[1].delta_bic))
    of_base = (replace(mechanism(found, i, omega), grade=Grade.EXPLAINS, share=None) for i in range(base))
    return (*(m for _, m in ranked), *of_base)


def _with_grade(said: Mechanism, graded: ForceGraded, one: Finalist | None) -> Mechanism:
    named = any(f.name == said.name for f in graded.named)
    grade = graded.grade if named and graded.grade is not None else Grade.MINOR
    # what something else stands in place of is not there for sure
    said = replace(said, grade=Grade.MINOR if grade is Grade.PART and said.alternatives else grade)
    if one is None:
        return said
    chance = graded.chance if graded.named and said.name == graded.named[0].name else None
    return replace(said, share=one.share, held_out=prediction(graded.base_held, one.held), chance=chance)


_PARTS = 6
"""Parts of equal counts that a quantity's range is cut into."""
_SAID = {
    "x": "a force that depends on position, beyond the spring",
    "v": "a force that depends on speed, beyond friction and damping",
    "t": "something that changes with time",
    "direction": "a force that differs by direction",
    "amplitude": "something that changes with amplitude",
}
_CLEARLY = 0.25
"""Share from which one quantity is said."""
_WANDERS = 2.0
"""Values of a residual that count as one, from which it is seen to wander; noise counts by each."""


def remainder(base: Fit, refined: Fit, problem: Problem) -> Remainder:
    """What ``refined`` leaves, beside ``base``; both fitted to the problem under the sensors' noise."""
    floor = float(base.points)
    share = min(max((refined.chi2 - floor) / max(base.chi2 - floor, 1e-300), 0.0), 1.0)
    rows = list(problem.by_sample(refined.residual).values())
    depends = shares_of(rows, problem.t, refined.shown.x, refined.shown.v)
    return Remainder(share, math.sqrt(refined.chi2 / max(refined.points, 1)), _looks_like(depends, rows), depends)


def remainder_of_force(graded: ForceGraded) -> Remainder:
    """What the best model found leaves of the force."""
    measured, left, noise = graded.problem.measured, graded.best, graded.noise
    share = float(np.clip((left.chi2 - noise) / graded.excess, 0.0, 1.0))
    rows = [left.residual]
    depends = shares_of(rows, *(measured.blocks(y) for y in (measured.t, measured.x, measured.v)))
    over = math.sqrt(left.chi2 / noise) if noise > 0.0 else math.inf
    return Remainder(share, over, _looks_like(depends, rows), depends)


def _looks_like(depends: Mapping[str, float], rows: Sequence[FloatArray]) -> str:
    first = max(depends, key=lambda name: depends[name])
    if depends[first] >= _CLEARLY:
        return f"the residual looks like {_SAID[first]} ({100.0 * depends[first]:.0f} % of it)"
    if max(memory(row).time for row in rows) >= _WANDERS:
        return "the residual wanders, as no function of position, speed, time, direction or amplitude alone"
    return "the residual shows no trend"


def shares_of(rows: Sequence[FloatArray], t: FloatArray, x: FloatArray, v: FloatArray) -> dict[str, float]:
    """Share of residuals, each (n,), that is a function of one quantity alone, corrected for what parts take by chance.

    t (s), x, v (n,) : of the motion. The correlation ratio of means over parts, with strokes counted as words (Kelley
    1935, Proc. Natl. Acad. Sci. 21, 554).
    """
    size = np.hypot(x * float(np.max(np.abs(v))), v * float(np.max(np.abs(x))))
    quantities = {"x": x, "v": v, "t": t, "direction": np.sign(v), "amplitude": size}
    words = max(2.0 * Strokes.by(v).count, 2.0 * _PARTS)
    return {name: _explained(rows, y, words) for name, y in quantities.items()}


def _explained(rows: Sequence[FloatArray], y: FloatArray, words: float) -> float:
    """Correlation ratio squared over all channels, less chance; y (n,) : the quantity that is cut into parts."""
    total = sum(float(np.sum(r**2)) for r in rows)
    if total <= 0.0:
        return 0.0
    values = np.unique(y)
    edges = values if values.size <= _PARTS else np.quantile(y, np.linspace(0.0, 1.0, _PARTS + 1)[1:-1])
    part: IntArray = np.searchsorted(edges, y).astype(np.int64)
    count = np.bincount(part)
    used = count > 0
    between = sum(float(np.sum(np.bincount(part, r)[used] ** 2 / count[used])) for r in rows)
    k = float(np.count_nonzero(used))
    return float(min(max(1.0 - (1.0 - between / total) * (words - 1.0) / max(words - k, 1.0), 0.0), 1.0))


def shifted_by_form(
    refined: Fit, listed: Iterable[Fit], problem: Problem, scales: Scales, explained: bool
) -> dict[str, float]:
    """The most by which other forms of a model's laws, or listed ones, would shift each of its numbers, by name.

    A shift counts with as much of its error as it has beyond the number's own. Beside a form that is free already one
    that is free otherwise counts by what the one leaves beyond noise over what the other leaves, in rms: so far is what
    is true from either.
    """
    here, found = _numbers(refined, problem, scales, explained), dict[str, float]()
    # a free form has those of its law as special cases, and leaves no more
    freed = ((other, _nearer(refined, other)) for other in forms(refined, problem, scales, other_forms_of))
    whole = ((other, 1.0) for other in (*forms(refined, problem, scales), *listed))
    for other, share in (*whole, *freed):
        for name, there in _numbers(other, problem, scales, explained).items():
            by = _shift(here.get(name), there)
            if by is not None:
                found[name] = max(share * by, found.get(name, 0.0))
    return found


def _nearer(here: Fit, there: Fit) -> float:
    """What one fit leaves beyond noise over what another leaves, rms; 1 at most."""
    left, more = (max(one.chi2 - one.points, 0.0) for one in (here, there))
    return math.sqrt(left / more) if more > left else 1.0


def _numbers(found: Fit, problem: Problem, scales: Scales, explained: bool) -> dict[str, Quantity]:
    """As results give them, and as they stand in the model."""
    plain = plain_parameters(found, problem, scales.omega, explained)
    return plain | base_parameters(found, problem, scales.omega, explained)


def _shift(here: Quantity | None, there: Quantity) -> float | None:
    if here is None or here.value is None or there.value is None or here.stderr is None or there.stderr is None:
        return None
    return math.hypot(there.value - here.value, math.sqrt(max(there.stderr**2 - here.stderr**2, 0.0)))
