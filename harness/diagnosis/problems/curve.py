"""A friction curve: speeds that were held, each with the force that held it; no time, no motion, and no mass."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.events import Events
from harness.core.recording import Recording
from harness.diagnosis.problem import Observation, Problem
from harness.diagnosis.problems.asked import asked
from harness.diagnosis.starts import Starts, Windows
from harness.kernels.solve import By, Effort, Scales
from harness.model.model import Model, Restoring

_NOWHERE = Windows((), np.zeros(1), np.zeros(1))


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve(Problem):
    """See Problem; "u" is its one channel, N, at speeds v (n,), m/s, which never lie at rest.

    t is the number of a row. order : the rows of the recording in the order they are kept in.
    """

    v: FloatArray
    order: IntArray
    restoring: Restoring = Restoring.NONE
    starts: Starts = field(default=_NOWHERE)
    moves: ClassVar[bool] = False
    returns: ClassVar[bool] = False

    def shows(self, model: Model, by: tuple[By, ...], scales: Scales | None, effort: Effort) -> Observation:
        """The force that a model asks for, at speeds that do not change."""
        still = np.zeros(self.t.size)
        force, partials = asked(model, self.t, still, self.v, still, self.covariates, by)
        mode = np.sign(self.v).astype(np.int8)
        return Observation({"u": force}, {"u": partials}, still, self.v, still, mode, Events())

    @property
    def in_newtons(self) -> bool:
        """Always: a mass would say nothing."""
        return True

    @property
    def simulated(self) -> bool:
        """Never."""
        return False

    @property
    def both_ways(self) -> bool:
        """Whether it has both directions."""
        return bool(np.any(self.v > 0.0) and np.any(self.v < 0.0))

    @property
    def given(self) -> frozenset[str]:
        """A push is told where both directions are."""
        return super(Curve, self).given | (frozenset({"zero"}) if self.both_ways else frozenset())

    @property
    def scales(self) -> Scales:
        """Its fastest speed; a unit of mass is slowed by its largest force within one over omega."""
        fastest = float(np.max(np.abs(self.v)))
        omega = float(np.max(np.abs(self.channels["u"]))) / fastest
        return Scales(fastest / omega, fastest, omega)

    def of_hand_free(self, fewest: int) -> tuple[Self, float]:
        """Itself."""
        return self, 0.0

    def turns(self, v: FloatArray) -> IntArray:
        """Each row says a word of its own."""
        return np.arange(1, self.t.size)

    def part(self, keep: slice) -> Self:
        """See Problem."""
        return replace(Problem.part(self, keep), v=self.v[keep], order=self.order[keep])

    def first_part(self, share: float) -> Self:
        """Itself: no part of it is earlier."""
        return self

    def at_every_sample(self, t: FloatArray, channels: Mapping[str, FloatArray]) -> "Curve":
        """Itself."""
        return self

    def shown_beside(self, recording: Recording) -> Recording:
        """Its rows in their order, each force as what holds the speed."""
        channels = {"v": self.v, "u": self.channels["u"]}
        return replace(recording, t=self.t, channels=channels, covariates=self.covariates)
