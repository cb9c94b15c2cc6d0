"""How many independent words a misfit has said: one a stroke, not one a sample.

What a model leaves of a decay says one thing for about half a swing. So evidence counts strokes (a stroke lasts from
one reversal to the next), up to a bound, and a fit is judged by the logarithm of the squares it leaves: a misfit has
no level that is known.
"""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import DECISIVE, LEAST_CYCLES, LEAST_RATIO, MARGIN, MOST_WORDS


@dataclass(frozen=True, slots=True)
class Strokes:
    """Strokes of a motion: the number (n,) of the stroke that each sample lies in, and how many there are."""

    of: IntArray
    count: int

    @classmethod
    def between(cls, turns: IntArray, samples: int) -> "Strokes":
        """Between turning points (m,) of so many samples; what lies before the first and after the last is one each."""
        of = np.searchsorted(turns, np.arange(samples), side="left").astype(np.int64)
        return cls(of, int(of[-1]) + 1)

    @classmethod
    def by(cls, v: FloatArray) -> "Strokes":
        """From the speed (n,) of a model's motion."""
        turned = np.concatenate(([0], np.cumsum(np.diff(np.sign(v)) != 0)))
        return cls(turned.astype(np.int64), int(turned[-1]) + 1)

    @property
    def cycles(self) -> float:
        """Full swings."""
        return 0.5 * self.count


def strokes_of(shown: Fit, problem: Problem) -> Strokes:
    """Strokes of the motion that a fit shows."""
    return Strokes.between(problem.turns(shown.shown.v), problem.t.size)


def words_of(strokes: Strokes) -> float:
    """Independent words of a misfit: one a stroke, at most so many as a rule allows."""
    return min(float(strokes.count), MOST_WORDS.value)


def words_beside(base: Fit, strokes: Strokes) -> float:
    """Words that are left when the numbers of a base fit have taken theirs, one at least."""
    return max(words_of(strokes) - len(base.free), 1.0)


def margin_of(words: float) -> float:
    """Evidence by which one law is told from another: at many words a margin is a hair in squares.

    Small effects that nobody models shift so little by themselves, so that a least ratio is asked besides.
    """
    return max(MARGIN.value, words * math.log(LEAST_RATIO.value))


def evidence(before: float, after: float, words: float, parameters: float, cells: float) -> float:
    """What a model that leaves ``after`` of the squares ``before`` gains in evidence, twice a log likelihood.

    W ln(before/after) - q ln W - ln(cells): the Bayesian information criterion of W values whose variance is unknown
    (Schwarz 1978, Ann. Stat. 6, 461), with what a scan over so many cells of a parameter may find by chance.
    """
    if after <= 0.0:
        return math.inf
    return words * math.log(before / after) - parameters * math.log(words) - math.log(max(cells, 1.0))


def few_words(base: Fit, chosen: Fit, problem: Problem) -> bool:
    """Whether the cycles are few, and what they say is spent once the base's own numbers have taken their words."""
    strokes = strokes_of(chosen, problem)
    if strokes.cycles >= LEAST_CYCLES.value:
        return False
    more = len(chosen.free) - len(base.free)
    return evidence(base.chi2, chosen.chi2, words_beside(base, strokes), more, 1.0) < DECISIVE.value
