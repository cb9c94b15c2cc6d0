"""Is a hand that lets go all that is missing? Then nothing is, once the beginning is left out."""

import math
from dataclasses import replace

import numpy as np

from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.motion import place_of
from harness.diagnosis.prepare.release import without_hand
from harness.diagnosis.problem import Problem
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.diagnosis.rules import AMONG_NAMES, HAND_KNOCKS, HAND_SHOWN, HAND_TURNS, HAND_UNSEEN
from harness.diagnosis.search.extend import extend, settle
from harness.diagnosis.search.search import Search, noise_of, under
from harness.kernels.solve import Scales
from harness.model.term import Slot


def over_by(found: Fit, problem: Problem, scales: Scales) -> float | None:
    """When all that was named is over, s, if that is while a hand lets go: before a first turn; else None.

    So act knocks, and friction that holds the slider and is then gone. A free motion turns a half-cycle after it began,
    and a knock before that is another release.
    """
    terms = found.model.terms
    if not terms:
        return None
    begin, half = found.model.t0, math.pi / scales.omega
    if all(entry.term.slot is Slot.EVENT for entry in terms):
        last = max(entry.values[0] for entry in terms)
    else:
        spans = (place_of(entry, found, problem, scales.omega).spans for entry in terms)
        last = max(one[-1][1] if one else begin for one in spans)
    return last if last - begin < HAND_KNOCKS.value * half else None


def of_a_hand(found: Fit, problem: Problem, scales: Scales) -> bool:
    """Whether a fit holds a knock, or all that it names is over while a hand lets go."""
    knocked = any(entry.term.slot is Slot.EVENT for entry in found.model.terms)
    return knocked or over_by(found, problem, scales) is not None


def after_hand(problem: Problem, scales: Scales, over: float | None = None) -> tuple[Search, Scales, float] | None:
    """A recording without its beginning, where viscous and Coulomb friction explain all else; None where they do not.

    With what counts as ordinary in it, and the time left out, s. over : when all that was named is (s); it is left out
    up to there where a hand is off before enough samples show it.
    """
    t = problem.t
    problem, touched = without_hand(problem, math.pi / scales.omega, HAND_UNSEEN.value)
    if touched == 0.0 and over is not None:
        off = int(np.searchsorted(t, over, side="right"))
        problem, touched = problem.part(slice(off, None)), float(t[off] - t[0])
    if touched == 0.0:
        return None
    base, scales = baseline(problem)
    problem = replace(problem, noise=noise_of(base, problem, scales.omega))
    base = settle(under(base, problem), problem, scales)
    if len(base.shown.events) < HAND_TURNS.value or left_by(base, problem, scales.omega, base) is not Left.NOISE:
        return None
    if _something_later(problem, scales):
        return None
    return Search(problem, base, base, (), (), Left.NOISE), scales, touched


def _something_later(problem: Problem, scales: Scales) -> bool:
    """Whether a term improves what follows the first quarter of a period, where no hand is any more."""
    later = problem.part(
        slice(int(np.searchsorted(problem.t, problem.t[0] + HAND_SHOWN.value * math.pi / scales.omega)), None)
    )
    base, scales = baseline(later)
    singles = extend(base, later, scales).fits
    return bool(singles) and singles[0].bic < base.bic - AMONG_NAMES.value
