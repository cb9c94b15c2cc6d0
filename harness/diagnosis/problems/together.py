"""Several free decays, or run-downs, of one slider: one set of physics, a start, a zero and a noise for each recording.

They lie one behind the other on a common axis of time, so that all that looks at samples sees one recording. Each is
simulated on its own clock, which begins at its own release. Where run-downs go in both directions, a push is told from
dry friction.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.diagnosis.problem import Observation, Problem
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.problems.run_down import RunDown, patient
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.rules import AMPLITUDES_APART
from harness.diagnosis.starts import OneStart, Several, Stretch
from harness.estimate.noise import Noise
from harness.kernels.solve import By, Effort, Scales
from harness.model.elsewhere import named
from harness.model.model import Model, Restoring


@dataclass(frozen=True, slots=True, kw_only=True)
class Together(Problem):
    """See Problem.

    said : what was found of the recordings before the search, one sentence each. piece : what each is by itself.
    """

    starts: Several = field()
    said: tuple[str, ...] = ()
    piece: ClassVar[type[Problem]] = FreeDecay

    @classmethod
    def laid(cls, alone: Sequence[Problem]) -> Self:
        """Recordings of the same channels, held alike, one behind the other: the next begins a sample later."""
        clocks, now = [], 0.0
        for one in alone:
            clocks.append(now - float(one.t[0]))
            now = float(one.t[-1]) + clocks[-1] + float(np.median(np.diff(one.t)))
        return cls.of(alone, clocks)

    @classmethod
    def of(
        cls, alone: Sequence[Problem], clocks: Sequence[float], own: tuple[str, ...] = (), said: tuple[str, ...] = ()
    ) -> Self:
        """Recordings each on its own clock; clocks : where it is zero on the common axis, s. own : see Several."""
        first = alone[0]
        sizes = [one.t.size for one in alone]
        ends = np.cumsum([0, *sizes]).tolist()
        stretches = []
        for one, clock, begin, end in zip(alone, clocks, ends, ends[1:], strict=False):
            starts = one.starts if isinstance(one.starts, OneStart) else OneStart()
            stretches.append(Stretch(begin, end, clock, float(one.t[0]), starts))
        noise = {c: typical([one.noise[c] for one in alone], sizes) for c in first.channels}
        level = {
            c: np.concatenate([one.level[c] * (one.noise[c].sigma / n.sigma) for one in alone])
            for c, n in noise.items()
        }
        return cls(
            np.concatenate([one.t + clock for one, clock in zip(alone, clocks, strict=True)]),
            {c: np.concatenate([one.channels[c] for one in alone]) for c in first.channels},
            noise,
            weight={c: np.concatenate([one.weight[c] for one in alone]) for c in first.channels},
            mass=first.mass,
            restoring=first.restoring,
            zero_free=first.zero_free,
            zero_chosen=first.zero_chosen,
            angular=first.angular,
            starts=Several(tuple(stretches), own),
            level=level,
            jitter=max(one.jitter for one in alone),
            share=max(one.share for one in alone),
            said=said,
        )

    def shows(self, model: Model, by: tuple[By, ...], scales: Scales | None, effort: Effort) -> Observation:
        """By simulation."""
        return observe(model, self, by, scales, effort)

    @property
    def places(self) -> tuple[slice, ...]:
        """The samples of each recording."""
        return tuple(slice(s.start, s.stop) for s in self.starts.stretches)

    @property
    def alone(self) -> tuple[Problem, ...]:
        """Each recording by itself, on its own clock."""
        return tuple(self._one(s) for s in self.starts.stretches)

    def _one(self, s: Stretch) -> Problem:
        at = slice(s.start, s.stop)
        over = {c: float(np.sqrt(np.mean(y[at] ** 2))) for c, y in self.level.items()}
        return self.piece(
            self.t[at] - s.clock,
            {c: y[at] for c, y in self.channels.items()},
            {c: replace(n, sigma=n.sigma * over[c]) for c, n in self.noise.items()},
            weight={c: w[at] for c, w in self.weight.items()},
            level={c: y[at] / over[c] for c, y in self.level.items()},
            jitter=self.jitter,
            share=self.share,
            mass=self.mass,
            restoring=self.restoring,
            zero_free=self.zero_free,
            zero_chosen=self.zero_chosen,
            angular=self.angular,
            starts=s.starts,
        )

    def with_own(self, own: tuple[str, ...]) -> Self:
        """The same with these base parameters each recording's own."""
        return replace(self, starts=replace(self.starts, own=own))

    def under_levels(self, each: Sequence[Mapping[str, Noise]]) -> Self:
        """The same with the noise of the recordings in this proportion to each other."""
        sizes = [s.stop - s.start for s in self.starts.stretches]
        noise = {c: typical([one[c] for one in each], sizes) for c in self.channels}
        alone = [one.level for one in self.alone]
        level = {
            c: np.concatenate([own[c] * (one[c].sigma / n.sigma) for own, one in zip(alone, each, strict=True)])
            for c, n in noise.items()
        }
        return replace(self, level=level)

    @property
    def own_names(self) -> tuple[str, ...]:
        """Start and zero, and what else was found to differ."""
        zero = ("offset",) if self.zero_free and "x" in self.channels else ()
        return (*self.starts.own, *zero, *self.starts.stretches[0].starts.names)

    @property
    def base_names(self) -> tuple[str, ...]:
        """Those shared, then every recording's own."""
        shared = [name for name in self.physics if name not in self.starts.own]
        count = len(self.starts.stretches)
        own = [named(stem, r) for r in range(count) for stem in self.own_names if (stem, r) != ("m", 0)]
        return (*shared, *own)

    @property
    def choices(self) -> tuple[str, ...]:
        """Whether they are pooled, and what stamps are worth."""
        return (*self.said, *super(Together, self).choices)

    @property
    def duration(self) -> float:
        """Of the longest recording."""
        return max(float(self.t[s.stop - 1] - self.t[s.start]) for s in self.starts.stretches)

    @property
    def parts_amplitude_from_time(self) -> bool:
        """Where they begin at amplitudes that differ: each passes through those of a smaller one, but later."""
        name = next(iter(self.channels))
        swings = [float(np.ptp(self.channels[name][at])) for at in self.places]
        return max(swings) >= AMPLITUDES_APART.value * min(swings)

    def whitened(self, values: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Each recording by itself: no sample knows of the one before it in another."""
        found = {}
        for c, noise in self.noise.items():
            wide = (slice(None),) + (None,) * (values[c].ndim - 1)
            even = self.even(c, values[c])
            parts = [noise.whitened(even[at]) for at in self.places]
            found[c] = np.concatenate(parts) * self.weight[c][wide]
        return found

    def opening(self, share: float) -> BoolArray:
        """The first part of every recording."""
        inside = np.zeros(self.t.size, dtype=bool)
        for s in self.starts.stretches:
            inside[s.start : s.start + int(share * (s.stop - s.start))] = True
        return inside

    def first_part(self, share: float) -> Self:
        """Of every recording."""
        return self._each(lambda one, _: one.first_part(share))

    def of_hand_free(self, fewest: int) -> tuple[Self, float]:
        """Each recording from its own first turning point; the longest time that is left out."""
        found = [one.of_hand_free(fewest) for one in self.alone]
        left_out = max(time for _, time in found)
        return (self if left_out == 0.0 else self._anew([one for one, _ in found])), left_out

    def turns(self, v: FloatArray) -> IntArray:
        """Those of each recording, and where the next one begins."""
        found = [
            np.concatenate(([s.start], s.start + one.turns(v)))
            for s, one in zip(self.starts.stretches, self.alone, strict=True)
        ]
        return np.concatenate(found)[1:].astype(np.int64)

    def condensed(self, shown: Mapping[str, FloatArray], size: int) -> tuple[Self, float]:
        """Every recording by itself."""
        at = self.places
        small = self._each(lambda one, i: one.condensed({c: shown[c][at[i]] for c in one.channels}, size)[0])
        return small, 1.0

    def at_every_sample(self, t: FloatArray, channels: Mapping[str, FloatArray]) -> Problem:
        """The same question at every sample t (m,), s, of the common axis, on which recordings keep their places."""
        gap, old = 0.5 * float(np.median(np.diff(t))), self.starts.stretches
        begins = np.searchsorted(t, [s.clock - gap for s in old]).tolist()
        ends = [*begins[1:], t.size]
        moved = zip(old, begins, ends, strict=True)
        starts = replace(self.starts, stretches=tuple(replace(s, start=low, stop=high) for s, low, high in moved))
        return replace(super(Together, self).at_every_sample(t, channels), starts=starts)

    def _each(self, change: Callable[[Problem, int], Problem]) -> Self:
        """Each changed, from the same start: it began when it did, wherever the first of fewer samples lies."""
        found, old = self._anew([change(one, i) for i, one in enumerate(self.alone)]), self.starts.stretches
        moved = (replace(s, t0=was.t0) for s, was in zip(found.starts.stretches, old, strict=True))
        return replace(found, starts=replace(found.starts, stretches=tuple(moved)))

    def _anew(self, alone: Sequence[Problem]) -> Self:
        return self.of(alone, [s.clock for s in self.starts.stretches], self.starts.own, self.said)


def typical(each: Sequence[Noise], sizes: Sequence[int]) -> Noise:
    """The noise of a channel over recordings, of so many samples each."""
    share = np.asarray(sizes) / sum(sizes)
    sigma = float(np.sqrt(np.sum(share * [n.sigma**2 for n in each])))
    phi = float(np.sum(share * [n.phi for n in each]))
    return Noise(sigma, any(n.found for n in each), phi, max(n.step for n in each))


@dataclass(frozen=True, slots=True, kw_only=True)
class RunDownsTogether(Together):
    """See Together."""

    restoring: Restoring = Restoring.NONE
    returns: ClassVar[bool] = False
    piece: ClassVar[type[Problem]] = RunDown

    def shows(self, model: Model, by: tuple[By, ...], scales: Scales | None, effort: Effort) -> Observation:
        """By simulation, as of one."""
        return observe(model, self, by, scales, patient(effort, model))

    @property
    def both_ways(self) -> bool:
        """Whether some go the other way."""
        name = "v" if "v" in self.channels else "x"
        y = self.channels[name]
        ways = {bool((np.mean(y[at]) if name == "v" else y[at][-1] - y[at][0]) > 0.0) for at in self.places}
        return len(ways) > 1

    @property
    def given(self) -> frozenset[str]:
        """A push is told where both directions are."""
        return super(RunDownsTogether, self).given | (frozenset({"zero"}) if self.both_ways else frozenset())

    @property
    def scales(self) -> Scales:
        """The longest way, the fastest speed, and what is ordinary in time."""
        each = [one.scales for one in self.alone if one.scales is not None]
        omega = math.exp(float(np.mean([math.log(one.omega) for one in each])))
        return Scales(max(one.x for one in each), max(one.v for one in each), omega)

    def periods(self, x: FloatArray, residual: FloatArray) -> tuple[float, ...]:
        """Those that stand out in the longest, where all count places from one zero: nowhere without a place."""
        if "x" not in self.channels:
            return ()
        at = max(self.places, key=lambda one: one.stop - one.start)
        return self._one(next(s for s in self.starts.stretches if s.start == at.start)).periods(x[at], residual[at])
