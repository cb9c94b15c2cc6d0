"""A model's force through the filter that the recorded one has passed.

A motion is smoothed and differentiated, and the force beside it smoothed alike: friction that jumps or bends within the
reach of that is compared with what is left of it there, not with its law at a smoothed speed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.sparse import csr_array, eye_array

from harness.core.arrays import FloatArray
from harness.diagnosis.problems.differences import sloped, spanned
from harness.kernels.solve import By
from harness.model.model import Model


@dataclass(frozen=True, slots=True)
class Passed:
    """What forces at n samples are seen as, of (m, n).

    a, v (m,) : what an acceleration and a speed that have passed it, are more than those that pass it twice.
    """

    of: csr_array
    a: FloatArray
    v: FloatArray

    def asked(
        self, model: Model, force: FloatArray, partials: FloatArray, by: Sequence[By | None]
    ) -> tuple[FloatArray, FloatArray]:
        """A model's force (n,) at a smoothed motion, and its partials (n, q), as they are seen, (m,) and (m, q)."""
        seen, moved = self.of @ force, self.of @ partials
        for q, number in enumerate(by):
            if number in ("m", "c"):
                moved[:, q] += self.a if number == "m" else self.v
        return seen + model.m * self.a + model.c * self.v, moved


@dataclass(frozen=True, slots=True)
class Filter:
    """What forces at the samples are seen as through the cubics, at the samples, and as the values that are fitted.

    means (b, n) : over blocks of samples, of what has passed the cubics. shaken (m, 2) : acceleration and speed that
    the differences of the motion have, at the values that are fitted, and that a model's force there has not.
    """

    samples: Passed
    fitted: Passed
    means: csr_array
    shaken: FloatArray

    @classmethod
    def of(cls, smooth: csr_array, t: FloatArray, by: str, slope: FloatArray, sizes: tuple[int, int]) -> Self:
        """At times t (n,), s; slope (n,) : differences of the motion, two of "x" or one of "v", as ``by`` says it.

        smooth (n, n) : the cubics. sizes : samples of a block, and of a value that is fitted, of both of which n is a
        multiple; one of a single sample is fitted as it was recorded, through no cubic.
        """
        block, size = sizes
        spans, bend = csr_array(spanned(t, by, smooth=size == 1)), sloped(t) @ slope
        v, a, means = smooth @ slope, smooth @ bend, csr_array(_means(t.size, block) @ smooth)

        def passed(through: csr_array) -> Passed:
            of = csr_array(through @ spans)
            return Passed(of, through @ bend - of @ a, of @ (slope - v))

        samples = passed(smooth)
        if size > 1:
            fitted = passed(means)
            return cls(samples, fitted, means, np.zeros((fitted.a.size, 2)))
        # a mass times the noise of its acceleration is noise: no mass is the smaller for it
        nothing = np.zeros(t.size)
        shaken = np.column_stack((bend - spans @ a, spans @ (slope - v)))
        return cls(samples, Passed(spans, nothing, nothing), means, shaken)

    @classmethod
    def none(cls, n: int, size: int) -> Self:
        """Of forces that are seen as they are, and as means over blocks."""
        same, nothing, mean = csr_array(eye_array(n)), np.zeros(n), _means(n, size)
        fitted = Passed(mean, mean @ nothing, mean @ nothing)
        return cls(Passed(same, nothing, nothing), fitted, mean, np.zeros((fitted.a.size, 2)))


def _means(n: int, size: int) -> csr_array:
    """Means over blocks of so many of n samples, (n / size, n)."""
    at = np.arange(n)
    return csr_array((np.full(n, 1.0 / size), (at // size, at)), shape=(n // size, n))
