"""A free decay of very many samples: searched in means of neighbours, told on all of its samples.

Means of what a fitted model leaves keep nearly all that a recording says of slower things, so that a
search costs no more for a hundred times the samples; the models it ends at are fitted to every sample.
"""

from dataclasses import replace

import numpy as np

from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.problem import P, Problem
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.rules import DECISIVE, LEAST_RATIO
from harness.diagnosis.search.against import among_names
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.few_pieces import condensed
from harness.diagnosis.search.search import Search, noise_of
from harness.kernels.solve import Scales

LONG = 40_000
"""Samples that a search is given at most, unless the cycles are so many that these were too few for each."""
_FEW = 4
"""Iterations of a fit that begins at the one to fewer samples."""


def shortened(problem: P) -> tuple[P, Fit, Scales]:
    """A free decay to search in, its base fit, and what counts as ordinary; the problem itself unless it is long.

    Raises InputError, SimulationError: see ``baseline``.
    """
    size = problem.t.size // LONG
    if size < 2:
        return problem, *baseline(problem)
    base, scales = baseline(problem.part(slice(None, None, size)))
    small, _ = condensed(problem, observe(base.model, problem, (), scales), LONG, scales.omega)
    if small is problem:
        return problem, *baseline(problem)
    return small, fit(base.model, small, base.free, scales), scales


def lifted(found: Search, whole: Problem, scales: Scales) -> Search:
    """A search in means as if it had been made in the whole problem.

    Base, chosen model, best single and what could stand in the chosen one's place are fitted to all samples that are
    not before the start of the base; of the others the differences in BIC are kept, and nothing else is to be asked.
    """
    problem = whole.part(slice(int(np.searchsorted(whole.t, found.base.model.t0)), None))
    seen = fit(found.chosen.model, problem, found.chosen.free, scales, 0, thorough=False)
    problem = replace(problem, noise=noise_of(seen, problem, scales.omega))

    def fitted(one: Fit) -> Fit:
        return fit(one.model, problem, one.free, scales, _FEW, thorough=False)

    chosen = fitted(found.chosen)
    base = chosen if found.chosen is found.base else fitted(found.base)
    by = chosen.bic - found.chosen.bic

    def moved(fits: tuple[Fit, ...]) -> tuple[Fit, ...]:
        return tuple(replace(one, chi2=one.chi2 + by) for one in fits)

    least, alike = among_names(found.chosen, found.problem) + DECISIVE.value, LEAST_RATIO.value * found.chosen.chi2

    def beside(one: Fit) -> Fit:
        near = one.chi2 < alike or among_names(one, found.problem) < least
        return fitted(one) if near else moved((one,))[0]

    first = found.singles[:1]
    best = tuple(chosen if key_of(one) == key_of(chosen) else fitted(one) for one in first)
    return replace(
        found,
        problem=problem,
        base=base,
        chosen=chosen,
        singles=(*best, *moved(found.singles[1:])),
        rivals=tuple(beside(one) for one in found.rivals),
        without=tuple(f if f is None else moved((f,))[0] for f in found.without),
    )
