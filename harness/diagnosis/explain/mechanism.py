"""What is said of a term that is named: its sentence, parameters, evidence, and what could stand in its place.

What the best model found leaves of a misfit: how much, and what it hangs on.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.quantity import Quantity
from harness.diagnosis.baseline.words import Strokes
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.place import place_of
from harness.diagnosis.fit.standard_errors import AT_LEAST, term_parameters
from harness.diagnosis.grading.clocks import on_the_swing
from harness.diagnosis.grading.lone import next_best, stand_ins
from harness.diagnosis.outcome import Alternative, Grade, Mechanism, Remainder
from harness.diagnosis.problem import Problem
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search
from harness.model.model import ModelTerm
from harness.model.term import Place

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


def remainder(base: Fit, refined: Fit, problem: Problem, floor: float) -> Remainder:
    """What ``refined`` leaves, beside ``base``; both fitted to the problem under the sensors' noise.

    floor : chi-square that noise alone leaves.
    """
    excess = max(base.chi2 - floor, 1e-300)
    share = min(max((refined.chi2 - floor) / excess, 0.0), 1.0)
    depends = depends_on(refined, problem)
    return Remainder(share, math.sqrt(refined.chi2 / max(refined.points, 1)), looks_like(depends), depends)


def looks_like(depends: Mapping[str, float]) -> str:
    """What hangs on single quantities, by these shares of it, in a sentence."""
    first = max(depends, key=lambda name: depends[name])
    if depends[first] >= _CLEARLY:
        return f"what is left looks like {_SAID[first]} ({100.0 * depends[first]:.0f} % of it)"
    return "what is left hangs on no single one of position, speed, time, direction and amplitude"


def depends_on(found: Fit, problem: Problem) -> dict[str, float]:
    """Share of a fit's residual that is a function of one quantity alone; see ``shares_of``."""
    n = problem.t.size
    rows = [found.residual[i * n : (i + 1) * n] for i in range(len(problem.channels))]
    return shares_of(rows, problem.t, found.shown.x, found.shown.v)


def shares_of(rows: Sequence[FloatArray], t: FloatArray, x: FloatArray, v: FloatArray) -> dict[str, float]:
    """Share of residuals, each (n,), that is a function of one quantity alone, corrected for what parts take by chance.

    t (s), x, v (n,) : of the motion.

    The correlation ratio of means over parts, with strokes counted as words (Kelley 1935, Proc. Natl. Acad. Sci. 21,
    554).
    """
    fastest, widest = float(np.max(np.abs(v))), float(np.max(np.abs(x)))
    size = np.hypot(x * fastest, v * widest)
    quantities = {"x": x, "v": v, "t": t, "direction": np.sign(v), "amplitude": size}
    words = max(2.0 * Strokes.by(v).count, 2.0 * _PARTS)
    return {name: _explained(rows, _parts_of(y), words) for name, y in quantities.items()}


def _parts_of(y: FloatArray) -> IntArray:
    values = np.unique(y)
    if values.size <= _PARTS:
        return np.searchsorted(values, y).astype(np.int64)
    edges = np.quantile(y, np.linspace(0.0, 1.0, _PARTS + 1)[1:-1])
    return np.searchsorted(edges, y).astype(np.int64)


def _explained(rows: Sequence[FloatArray], part: IntArray, words: float) -> float:
    """Correlation ratio squared over all channels, less chance."""
    total = sum(float(np.sum(r**2)) for r in rows)
    if total <= 0.0:
        return 0.0
    count = np.bincount(part)
    used = count > 0
    between = sum(float(np.sum(np.bincount(part, r)[used] ** 2 / count[used])) for r in rows)
    taken, k = between / total, float(np.count_nonzero(used))
    return float(min(max(1.0 - (1.0 - taken) * (words - 1.0) / max(words - k, 1.0), 0.0), 1.0))


_SPRING_SEEN = 0.1
"""Of friction and damping: a spring whose force is weaker has no rest position that could be spoken of."""
_MOST_ALTERNATIVES = 3
"""Names that are not ruled out and are told."""


def mechanism(found: Search, index: int, entry: ModelTerm, omega: float, place: Place) -> Mechanism:
    """All of a named term, the chosen model's number ``index``; place : where it acts. omega : rad/s."""
    parameters = term_parameters(found.chosen, found.problem, index, omega)
    return Mechanism(
        entry=entry,
        statement=statement_of(entry, parameters, found.chosen),
        parameters=parameters,
        delta_bic=_lost_without(found, index),
        place=place,
        alternatives=_alternatives(found, entry, omega),
        share=_share(found, entry),
    )


def each_of(first: Mechanism, found: Search, omega: float) -> tuple[Mechanism, ...]:
    """A lone law that is listed, with those that could stand in its place, else the next. omega : rad/s."""
    fits = {key_of(f)[0]: f for f in reversed(found.rivals) if len(f.model.terms) == 1}
    others = []
    for name in [a.name for a in first.alternatives] or [name for name, _ in next_best(found)]:
        rival = replace(found, chosen=fits[name])
        entry = fits[name].model.terms[0]
        others.append(mechanism(rival, 0, entry, omega, place_of(entry, fits[name], found.problem, omega)))
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


def _lost_without(found: Search, index: int) -> float:
    """What BIC loses when a term is taken out of the chosen model and the rest is fitted again."""
    return left_without(found, index).bic - found.chosen.bic


def _alternatives(found: Search, entry: ModelTerm, omega: float) -> tuple[Alternative, ...]:
    """Names that could stand in a term's place; a clock on the swing follows any other, and comes last."""
    listed: list[tuple[bool, float, str]] = []
    for name, rival in stand_ins(found, entry):
        clock = any(on_the_swing(e, omega, found.problem.duration) for e in rival.model.terms)
        listed.append((clock, rival.bic - found.chosen.bic, name))
    return tuple(Alternative(name, delta) for _, delta, name in sorted(listed)[:_MOST_ALTERNATIVES])


def _said(quantity: Quantity) -> str:
    """A number as a sentence shows it."""
    return f"at least {quantity}" if quantity.why == AT_LEAST else str(quantity)


def statement_of(entry: ModelTerm, parameters: dict[str, Quantity], found: Fit) -> str:
    """One plain sentence of a term, with its numbers."""
    values = {name: _said(q) for name, q in parameters.items()}
    return entry.term.say({**values, **entry.term.words(entry.values, _stiffness(found))})


def _stiffness(found: Fit) -> float:
    """Of a spring that is there beside friction and damping; 0 of one that no force shows."""
    model, shown = found.model, found.shown
    spring = model.k * float(np.max(np.abs(shown.x)))
    rest = model.c * float(np.max(np.abs(shown.v))) + model.f_k
    return model.k if spring > _SPRING_SEEN * rest else 0.0
