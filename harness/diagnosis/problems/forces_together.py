"""Several driven recordings of one slider, whose force is fitted: one set of physics, a zero and a noise for each.

They lie one behind the other on a common axis of time, with a gap between them that nothing is smoothed over. Each
keeps its own clock, its own force and its own level of what is left of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

import numpy as np

from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.together import typical
from harness.diagnosis.starts import Driven, SeveralWindows, Start
from harness.kernels.solve import Drive
from harness.model.elsewhere import Elsewhere, named
from harness.model.model import Model

_APART = 20.0
"""Longest sampling intervals between one recording and the next on the common axis."""


def begun_alike(model: Model, *stems: str) -> Model:
    """The model with these base parameters every recording's own, each as it is in the first where it was not."""
    values = {stem: float(getattr(model, stem)) for stem in stems}
    return replace(model, elsewhere=tuple(one.having(**{**values, **dict(one.values)}) for one in model.elsewhere))


@dataclass(frozen=True, slots=True, kw_only=True)
class ForcesTogether(InverseDynamics):
    """See InverseDynamics.

    each : the recordings by themselves, on their own clocks. levels : of what each leaves of its force, over that of
    all. said : what was found of the recordings before the search, one sentence each.
    """

    starts: SeveralWindows = field()
    each: tuple[InverseDynamics, ...]
    levels: tuple[float, ...]
    said: tuple[str, ...] = ()
    provides: ClassVar[frozenset[str]] = frozenset({"driven"})

    @classmethod
    def laid(cls, each: Sequence[InverseDynamics]) -> "ForcesTogether":
        """Recordings of the same channels, held alike, each of whole blocks of samples, one behind the other."""
        first = each[0]
        gap = _APART * max(float(np.median(np.diff(one.t))) for one in each)
        sizes = [one.t.size for one in each]
        ends = np.cumsum([0, *sizes]).tolist()
        windows, stretches, now = [], [], 0.0
        for one, begin, end in zip(each, ends, ends[1:], strict=False):
            clock = now - float(one.t[0])
            now = float(one.t[-1]) + clock + gap
            stretches.append(Driven(begin, end, begin, end, clock))
            moved = (
                replace(w, start=w.start + begin, stop=w.stop + begin, t0=w.t0 + clock) for w in one.starts.windows
            )
            windows += list(moved)
        clocks = [s.clock for s in stretches]
        t = np.concatenate([one.t + clock for one, clock in zip(each, clocks, strict=True)])
        held = all(one.drive.held for one in each)
        drives = [one.drive if held else one.drive.straight for one in each]
        knots = np.concatenate([drive.t + clock for drive, clock in zip(drives, clocks, strict=True)])
        speed = np.concatenate([one.starts.v for one in each])
        given = {name: np.concatenate([one.covariates[name] for one in each]) for name in first.covariates}
        elsewhere = tuple(Elsewhere((("offset", one.first.offset),) if one.zero_free else ()) for one in each[1:])
        return cls(
            t,
            {c: np.concatenate([one.channels[c] for one in each]) for c in first.channels},
            {c: typical([one.noise[c] for one in each], sizes) for c in first.channels},
            weight={c: np.concatenate([one.weight[c] for one in each]) for c in first.channels},
            mass=first.mass,
            restoring=first.restoring,
            zero_free=first.zero_free,
            angular=first.angular,
            starts=SeveralWindows(tuple(windows), t, speed, tuple(stretches)),
            drive=Drive(knots, np.concatenate([drive.u for drive in drives]), held),
            first=replace(first.first.recentred(given), elsewhere=elsewhere),
            covariates=given,
            guarded=first.guarded,
            each=tuple(each),
            levels=(1.0,) * len(each),
        )

    @property
    def alone(self) -> tuple[InverseDynamics, ...]:
        """Each recording by itself, whole, on its own clock."""
        return self.each

    @property
    def clocks(self) -> tuple[float, ...]:
        """Where each recording's own time is zero, s."""
        return tuple(s.clock for s in self.starts.stretches)

    @property
    def places(self) -> tuple[slice, ...]:
        """The samples of each recording."""
        return tuple(slice(s.start, s.stop) for s in self.starts.stretches)

    @property
    def own_names(self) -> tuple[str, ...]:
        """The zero, and what else was found to differ."""
        zero = ("offset",) if self.zero_free and "x" in self.channels else ()
        return (*self.starts.own, *zero)

    @property
    def base_names(self) -> tuple[str, ...]:
        """Those shared, and every recording's own."""
        names, own, count = Problem.base_names.fget(self), self.own_names, len(self.each)  # type: ignore[attr-defined]
        known = ("m",) if "m" in own and "m" not in names else ()
        further = (named(stem, r) for stem in (*known, *names) if stem in own for r in range(1, count))
        return (*names, *further)

    @property
    def choices(self) -> tuple[str, ...]:
        """What mass was taken, and whether they are pooled."""
        return (*self.enters, *self.said)

    def under_levels(self, left: Sequence[float]) -> Self:
        """The same with what is left of the recordings' forces in this proportion to each other."""
        sizes = np.array([one.t.size for one in self.each], dtype=np.float64)
        level = np.array(left)
        typical_level = float(np.exp(np.sum(sizes * np.log(level)) / np.sum(sizes)))
        return replace(self, levels=tuple((level / typical_level).tolist()), fixed=None)

    def with_own(self, own: tuple[str, ...]) -> Self:
        """The same with these base parameters each recording's own."""
        first = begun_alike(self.first, *own)
        return replace(self, starts=replace(self.starts, own=own), first=first, fixed=self.measured)

    def with_mass(self, mass: float, model: Model, enters: tuple[str, ...]) -> Self:
        """The same with a mass that is not fitted, in each recording too."""
        each = tuple(replace(one, mass=mass, first=replace(one.first, m=mass)) for one in self.each)
        return replace(self, mass=mass, first=model, enters=enters, each=each)

    def runs(self, model: Model) -> list[Start]:
        """The recordings, each from its first window."""
        starts = self.starts.of(model)
        begins = [one.samples.start for one in starts]
        firsts = (next(one for one, b in zip(starts, begins, strict=True) if at.start <= b) for at in self.places)
        return [replace(one, samples=at) for one, at in zip(firsts, self.places, strict=True)]
