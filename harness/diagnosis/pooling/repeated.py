"""What each of several recordings says alone under the model that was found for all of them.

Whether recordings are pooled, in a sentence that stands beside the verdict.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

from harness.core.errors import SimulationError
from harness.core.quantity import Quantity
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.standard_errors import term_parameters
from harness.diagnosis.parameters import free_of
from harness.diagnosis.pooling.forces import force_alone
from harness.diagnosis.pooling.own import Alone, begun_apart, median_of
from harness.diagnosis.pooling.pooled import Pooled
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.forces_together import ForcesTogether
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.together import Together
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.diagnosis.rules import POOLED
from harness.diagnosis.search.against import in_turn
from harness.diagnosis.search.extend import extend, key_of, settle
from harness.diagnosis.search.search import Search, noise_of, search, under
from harness.kernels.solve import Scales
from harness.model.model import Model

_LAWS = 3
"""Laws that are tried with numbers of each recording's own: what recordings differ in puts another first."""


def alone_under(found: Fit, problem: Together | ForcesTogether, scales: Scales, base: Sequence[Alone]) -> list[Alone]:
    """Each recording with the named terms of a model, all of it fitted anew; the base where there are none.

    base : the recordings under the base model. What cannot be simulated alone is as it was there.
    """
    terms = tuple(entry for entry in found.model.terms if entry.term.searched)
    if not terms:
        return list(base)
    read = list(base)
    each: Sequence[Problem] = problem.each if isinstance(problem, ForcesTogether) else problem.alone
    for i, one in enumerate(each):
        model = replace(found.model.of_recording(i), terms=terms)
        with suppress(SimulationError):
            if isinstance(one, InverseDynamics):
                read[i] = force_alone(one, replace(model, covariates=one.first.covariates), scales)
            else:
                read[i] = _followed(one, model, scales)
    return _as_the_others(read)


def _as_the_others(read: list[Alone]) -> list[Alone]:
    """Decays that a law does not explain, tried again with the numbers of those that it does: a fit may stray."""
    explained = [one.fit.model for one in read if one.explained and one.fit.model.terms]
    for i, one in enumerate(read):
        if explained and not one.explained and not isinstance(one.problem, InverseDynamics):
            with suppress(SimulationError):
                again = _followed(one.problem, median_of(one.fit.model, explained), one.scales)
                read[i] = min(one, again, key=lambda tried: tried.fit.chi2)
    return read


def own_of_each(found: Search, before: Pooled[Together]) -> tuple[Search, Pooled[Together]]:
    """A search with what repetitions differ in, where the law that was found does not explain all of them as they are.

    They differ a little in spring, damping and friction, which is no reason to doubt a law: as many of these as it
    takes until noise is left become each one's own. Where the numbers of the law differ as well, it stands if it
    explains each recording by itself, as it would alone; the misfit of all together then widens the errors.
    """
    whole, scales = found.problem, before.scales
    assert isinstance(whole, Together)
    if found.explained:
        return found, before
    first = (found.chosen, *in_turn(found.singles, whole)) if found.chosen.model.terms else found.singles
    laws = [f for i, f in enumerate(first) if key_of(f) not in map(key_of, first[:i])][:_LAWS]
    apart = [alone_under(law, whole, scales, before.compared.alone) for law in laws]
    for law, alone in zip(laws, apart, strict=True):
        with suppress(SimulationError):
            again = _with_own(law, found, before, alone)
            if again is not None:
                return again
    needed = not any(one.explained for one in before.compared.alone)
    if needed and found.chosen.model.terms and all(one.explained for one in apart[0]):
        found = replace(found, left=Left.NOISE)
    return found, before


def _with_own(
    law: Fit, found: Search, before: Pooled[Together], alone: Sequence[Alone]
) -> tuple[Search, Pooled[Together]] | None:
    """The search with as few own numbers of each as it takes for a law to leave noise; None where it never does."""
    problem, scales = found.problem, before.scales
    assert isinstance(problem, Together)
    reference, stems = under(found.base, problem), _differing(alone)
    for count in range(1, len(stems) + 1):
        problem = problem.with_own(tuple(stems[:count]))
        law = _jointly(law.model, problem, scales, alone)
        if left_by(law, problem, scales.omega, reference) is Left.NOISE:
            base = _jointly(before.base.model, problem, scales, before.compared.alone)
            problem = replace(problem, noise=noise_of(base, problem, scales.omega))
            base = settle(under(base, problem), problem, scales)
            parts = [replace(law.model, terms=(entry,)) for entry in law.model.terms]
            again = search(problem, base, scales, alone=extend(base, problem, scales, also=parts))
            return (again, replace(before, problem=problem, base=base)) if again.explained else None
    return None


def _differing(alone: Sequence[Alone]) -> list[str]:
    """Base parameters of which each recording may have its own, the one they differ in most first."""
    far: dict[str, float] = {}
    for stem in alone[0].problem.physics:
        at = [[f.name for f in one.fit.free].index(stem) for one in alone]
        values = np.array([one.fit.values[i] for one, i in zip(alone, at, strict=True)])
        variance = np.array([float(one.fit.covariance()[i, i]) for one, i in zip(alone, at, strict=True)])
        told = variance > 0.0
        far[stem] = float(np.sum((values - np.mean(values))[told] ** 2 / variance[told]))
    return sorted(far, key=lambda stem: -far[stem])


def _jointly(model: Model, problem: Together, scales: Scales, alone: Sequence[Alone]) -> Fit:
    """A model fitted to all, begun where each recording ends alone: with its own numbers, and the median of what
    is shared. Numbers of laws too: beside what recordings differ in, those of all together are far from any of them.
    """
    begun = begun_apart(model, problem.own_names, [one.fit.model for one in alone])
    return fit(begun, problem, free_of(begun, problem.base_names), scales)


def _followed(problem: Problem, model: Model, scales: Scales) -> Alone:
    """What a recording alone cannot tell from its base parameters is as all of them tell it."""
    spring = {"spring"} if model.k > 0.0 else set()
    told = [problem.given | spring >= set(entry.term.needs) for entry in model.terms]
    free = free_of(model, problem.base_names)
    found = fit(model, problem, tuple(f for f in free if not isinstance(f.by, tuple) or told[f.by[0]]), scales)
    return Alone.of(found, problem, scales)


def parameters_of(one: Alone) -> dict[str, Quantity]:
    """Its numbers by name, those of a term as "quadratic-drag.c2"."""
    read = dict(one.parameters)
    for i, entry in enumerate(one.fit.model.terms):
        numbers = term_parameters(one.fit, one.problem, i, one.scales.omega, one.explained)
        read |= {f"{entry.term.key}.{name}": number for name, number in numbers.items()}
    return read


_EACH = 3
"""Recordings whose values are said one by one; of more the least and the most."""


def sentences(before: Pooled[Any]) -> tuple[str, ...]:
    """What is shared and what differs."""
    count = len(before.problem.starts.stretches)
    chance = before.compared.chance
    if before.own:
        return (f"The recordings differ in {before.differs_in}; all else is shared.",)
    if chance >= POOLED.value:
        return (f"The {count} recordings are pooled: alone they agree in their base parameters (chance {chance:.2g}).",)
    return (
        f"The {count} recordings are pooled: read alone they differ ({'; '.join(_apart(before))}), and what is missing"
        " in all of them says that as well as a parameter of their own would.",
    )


def _apart(before: Pooled[Any]) -> list[str]:
    """The base parameters that are furthest apart alone, with their values."""
    each = [one.parameters for one in before.compared.alone]
    far: list[tuple[float, str]] = []
    for name in each[0]:
        read = [one[name] for one in each]
        values = [q.value for q in read if q.value is not None]
        errors = [q.stderr for q in read if q.stderr is not None]
        if len(values) == len(read) and errors:
            scale = (sum(e**2 for e in errors) / len(errors)) ** 0.5
            far.append(
                ((max(values) - min(values)) / scale, f"{name} {' and '.join(f'{v:.4g}' for v in _ends(values))}")
            )
    far.sort(reverse=True)
    return [said for _, said in far[:1]]


def _ends(values: Sequence[float]) -> Sequence[float]:
    return values if len(values) <= _EACH else (min(values), max(values))
