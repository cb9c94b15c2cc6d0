"""Search on a driven recording: what explains it to its noise, else what another recording confirms.

A real drive leaves more than one law can say, so that BIC would name ever more terms for it. Where nothing explains a
recording to its noise, a term is named only if the force error on another recording falls with it.
"""

from dataclasses import replace

from harness.diagnosis.driven.validate import RIPPLE, Judge
from harness.diagnosis.fit import Fit
from harness.diagnosis.problem import Problem
from harness.diagnosis.search import Search, noise_of, under
from harness.diagnosis.search import search as search_all
from harness.diagnosis.select import DECISIVE, extend, key_of, settle
from harness.kernels.solve import Scales

_FALLS = 0.99
"""What the force error on the other recording must fall to for a further term."""
_LOOKED_AT = 5
_MOST_TERMS = 3


def search_driven(problem: Problem, base: Fit, scales: Scales, judge: Judge | None = None) -> Search:
    """The smallest model that explains a driven recording, or, with a judge, the one another recording confirms."""
    if judge is None:
        return search_all(problem, base, scales)
    chosen = base
    singles: tuple[Fit, ...] = (base,)
    rivals: tuple[Fit, ...] = (base,)
    for _ in range(_MOST_TERMS):
        step = extend(chosen, problem, scales)
        better = [f for f in step.fits if f.bic < chosen.bic - DECISIVE]
        error = judge.errors(chosen.model)
        confirmed = next((f for f in better[:_LOOKED_AT] if _confirms(judge, f, error)), None)
        rivals = step.fits or rivals
        if chosen is base:
            singles = step.fits or singles
        if confirmed is None:
            break
        problem = replace(problem, noise=noise_of(confirmed, problem, scales.omega))
        chosen = settle(under(confirmed, problem), problem, scales)
        base, singles, rivals = (
            under(base, problem),
            *(tuple(sorted((under(f, problem) for f in group), key=lambda f: f.bic)) for group in (singles, rivals)),
        )
        rivals = tuple(sorted((*(f for f in rivals if key_of(f) != key_of(chosen)), chosen), key=lambda f: f.bic))
    return Search(problem, base, chosen, singles, rivals, True)


def _confirms(judge: Judge, found: Fit, before: tuple[float, float]) -> bool:
    """Whether the other recording confirms a term: a ripple, whose phase is each recording's own, by its refit."""
    if any(entry.term.name == RIPPLE for entry in found.model.terms):
        refitted = judge.compared(found.model, found.model).refitted
        return refitted is not None and refitted < _FALLS * before[1]
    fit, cross = judge.errors(found.model)
    return cross < _FALLS * before[1] and fit < before[0]
