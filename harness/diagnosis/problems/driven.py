"""A driven recording: a measured force acts, whose own noise may show in the motion."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.recording import Recording
from harness.diagnosis.problem import Observation, Problem
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.starts import Windows
from harness.kernels.solve import By, Drive, Effort, Scales
from harness.model.model import Model, Restoring


@dataclass(frozen=True, slots=True, kw_only=True)
class Forced(Problem):
    """A recording with a measured force: what following its motion and fitting its force have in common.

    first : a rough base model with its start. The force gives the mass, and no hand lets go, so that a misfit tells of
    the model from the first sample on. guarded : where the force is fitted, what lies beside a reversal does not count.
    unknown : share of how the force bends from sample to sample that is not known of it between them.
    """

    drive: Drive = field()
    first: Model
    guarded: bool = False
    unknown: float = 0.0
    provides: ClassVar[frozenset[str]] = frozenset({"driven", "one-clock"})

    @property
    def in_newtons(self) -> bool:
        """Always."""
        return True

    @property
    def mass_names(self) -> tuple[str, ...]:
        """The mass, unless it is known."""
        return ("m",) if self.mass is None else ()

    @property
    def pairs_searched(self) -> bool:
        """Always: a driven path comes back to the same places at other speeds, so that two laws can be told."""
        return True

    @property
    def alone(self) -> tuple["Forced", ...]:
        """Each recording by itself, where there are several."""
        return ()

    @property
    def clocks(self) -> tuple[float, ...]:
        """Where each of several recordings' own time is zero, s."""
        return ()

    @property
    def levels(self) -> tuple[float, ...]:
        """Of what each of several recordings leaves of its force, over that of all."""
        return ()

    def of_hand_free(self, fewest: int) -> tuple[Self, float]:
        """Itself: no hand lets it go."""
        return self, 0.0

    def turns(self, v: FloatArray) -> IntArray:
        """Those of the model, which follows it."""
        return np.flatnonzero(np.diff(np.sign(v)) != 0)

    def drive_over(self, begin: float, end: float) -> Drive:
        """A run needs no more of the force than its own stretch."""
        return self.drive.over(begin, end)

    def at_every_sample(self, t: FloatArray, channels: Mapping[str, FloatArray]) -> Self:
        """Itself: samples that were left out are nothing that windows could start from."""
        return self

    def shown_beside(self, recording: Recording) -> Recording:
        """Its own samples."""
        return recording if recording.t.size == self.t.size else recording.cut(np.isin(recording.t, self.t))


@dataclass(frozen=True, slots=True, kw_only=True)
class Driven(Forced):
    """A driven recording followed in its channels, from one start or window after window.

    otherwise : the drive as it acts in other ways: held between samples, smoothly or as straight lines. pulled : what
    else may pull it back, where nobody says. scatter : what the force has lost of its noise where the slider rests.
    """

    otherwise: tuple[Drive, ...] = ()
    scatter: Drive | None = None
    pulled: tuple[Restoring, ...] = ()

    def shows(self, model: Model, by: tuple[By, ...], scales: Scales | None, effort: Effort) -> Observation:
        """By simulation."""
        return observe(model, self, by, scales, effort)

    @property
    def other_ways(self) -> tuple[Self, ...]:
        """With the force acting in each of the other ways, and pulled back by what else it may be in each of all."""
        ways = (self.drive, *self.otherwise)
        each = [replace(self, drive=way, otherwise=tuple(w for w in ways if w is not way)) for way in ways]
        return (*each[1:], *(one.pulled_by(other) for other in self.pulled for one in each))

    def less(self, scatter: Drive, share: float = 1.0) -> Self:
        """With a share of what is noise of its force taken off it, whichever way that acts."""
        drive, *otherwise = (replace(way, u=way.u - share * scatter.at(way.t)) for way in (self.drive, *self.otherwise))
        return replace(self, drive=drive, otherwise=tuple(otherwise), scatter=scatter)

    @property
    def as_recorded(self) -> Self:
        """With the force as it was recorded, none of which is noise."""
        whole = self if self.scatter is None else self.less(self.scatter, -1.0)
        return replace(whole, scatter=None)

    def pulled_by(self, other: Restoring) -> Self:
        """Pulled back by something else."""
        pulled = tuple(self.restoring if one is other else one for one in self.pulled)
        return replace(self, restoring=other, first=replace(self.first, restoring=other), pulled=pulled)

    @property
    def is_held(self) -> bool:
        """Whether the force is held between samples."""
        return self.drive.held

    def condensed(self, shown: Mapping[str, FloatArray], size: int) -> tuple[Self, float]:
        """Windows are thinned, since errors of their starts travel from sample to sample."""
        if isinstance(self.starts, Windows):
            small = self.part(slice(None, None, size))
            return small, self.points / max(small.points, 1)
        return Forced.condensed(self, shown, size)
