"""Is a hand that lets go all that is missing? Then nothing is, once the beginning is left out."""

import math
from dataclasses import replace

import numpy as np

from harness.diagnosis.baseline import baseline
from harness.diagnosis.fit import Fit
from harness.diagnosis.problem import Problem
from harness.diagnosis.release import SHOWN, UNSEEN, without_hand
from harness.diagnosis.search import AMONG_NAMES, Search, noise_of, under
from harness.diagnosis.select import extend, key_of, settle
from harness.diagnosis.structure import explains
from harness.kernels.solve import Scales

_FEWEST_TURNS = 3
"""Reversals that must stay after what a hand touched: a slider at rest agrees with any model."""


def knocked_at_release(found: Fit, scales: Scales) -> bool:
    """Whether all that was named is a knock in the first quarter of a period: what a hand does that lets go."""
    if key_of(found) != ("impulse",):
        return False
    since = found.model.terms[0].value("time") - found.model.t0
    return since < SHOWN * math.pi / scales.omega


def after_hand(problem: Problem, scales: Scales) -> tuple[Search, Scales, float] | None:
    """A recording without its beginning, where viscous and Coulomb friction explain all else; None where they do not.

    With what counts as ordinary in it, and the time left out, s.
    """
    problem, touched = without_hand(problem, math.pi / scales.omega, UNSEEN)
    if touched == 0.0:
        return None
    base, scales = baseline(problem)
    problem = replace(problem, noise=noise_of(base, problem, scales.omega))
    base = settle(under(base, problem), problem, scales)
    if len(base.shown.events) < _FEWEST_TURNS or not explains(base, problem, scales.omega, base):
        return None
    if _something_later(problem, scales):
        return None
    return Search(problem, base, base, (), (), explained=True), scales, touched


def _something_later(problem: Problem, scales: Scales) -> bool:
    """Whether a term improves what follows the first quarter of a period, where no hand is any more."""
    later = problem.part(slice(int(np.searchsorted(problem.t, problem.t[0] + SHOWN * math.pi / scales.omega)), None))
    base, scales = baseline(later)
    singles = extend(base, later, scales).fits
    return bool(singles) and singles[0].bic < base.bic - AMONG_NAMES
