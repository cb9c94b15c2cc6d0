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
    """The cubics, smooth (n, n), and what forces are seen as through them: at the samples, and as means over blocks."""

    smooth: csr_array
    samples: Passed
    blocks: Passed

    @classmethod
    def of(cls, smooth: csr_array, t: FloatArray, by: str, slope: FloatArray, size: int) -> Self:
        """At times t (n,), s; slope (n,) : differences of the motion, two of "x" or one of "v", as ``by`` says it.

        size : samples of a block, of which n is a multiple.
        """
        through = csr_array(smooth @ spanned(t, by))
        v, a = smooth @ slope, smooth @ (sloped(t) @ slope)
        samples, mean = Passed(through, a - through @ a, through @ (slope - v)), _means(t.size, size)
        return cls(smooth, samples, Passed(csr_array(mean @ through), mean @ samples.a, mean @ samples.v))

    @classmethod
    def none(cls, n: int, size: int) -> Self:
        """Of forces that are seen as they are, and as means over blocks."""
        same, nothing, mean = csr_array(eye_array(n)), np.zeros(n), _means(n, size)
        return cls(same, Passed(same, nothing, nothing), Passed(mean, mean @ nothing, mean @ nothing))

    @property
    def noise(self) -> csr_array:
        """What noise of each sample (n,) is in the means over blocks, (b, n)."""
        return csr_array(_means(self.smooth.shape[0], self.smooth.shape[0] // self.blocks.a.size) @ self.smooth)


def _means(n: int, size: int) -> csr_array:
    """Means over blocks of so many of n samples, (n / size, n)."""
    at = np.arange(n)
    return csr_array((np.full(n, 1.0 / size), (at // size, at)), shape=(n // size, n))
