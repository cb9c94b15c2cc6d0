"""The motion and the force of a driven recording, made ready for inverse dynamics."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.errors import SimulationError
from harness.diagnosis.parameters import in_recording
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.asked import asked, given_force
from harness.diagnosis.problems.differences import felt, sloped
from harness.diagnosis.problems.driven import Forced
from harness.diagnosis.problems.filtered import Filter
from harness.diagnosis.smoothed_state.local_cubics import Smooth, inner, longest_interval, smoothed, smoothing
from harness.diagnosis.smoothed_state.state import state_of
from harness.kernels.solve import By
from harness.model.model import Model

BLOCK = 10
"""Samples whose mean counts as one value of the force."""
_ALIKE = 1.05
"""Smoothing must not round off what the force is compared with."""
_AT_REST = 3.0
"""Standard errors below which a speed is none, and friction may have any value."""
_SOONER = 5
"""Samples by which a joint rests sooner and longer than its speed shows: with them two standard errors hold 334 of 360
true values of 90 sound joints, without them 305 of 335, and with ten fewer values are told (controls of
``python -m benchmarks.draws path:robot-joint --draws 60`` with seeds 8104, 8106 and 8109)."""


@dataclass(frozen=True, slots=True)
class Laid:
    """The samples of one recording among several; clock : s, where its own time is zero."""

    samples: slice
    clock: float


@dataclass(frozen=True, slots=True)
class Measured:
    """Motion t (s), x, v, a and force u (N), each (n,), smoothed; n is a multiple of the block.

    covariates : by name, (n,), through the filter that the force passed.

    moving : (n / block,), blocks in which the slider moves throughout, so that its friction is known, and which lie
    far enough from the ends of a stretch to be smoothed as the others are.

    laid : of several recordings one behind the other, each with its own clock. level : (n / block,), by which what is
    left of each is weighed. stands : (n / block,), blocks in which it is at rest throughout. widest : half widths over
    which most of each channel was smoothed. half : (n,) those of the motion. by : the channel that tells its speed.
    """

    t: FloatArray
    x: FloatArray
    v: FloatArray
    a: FloatArray
    u: FloatArray
    moving: BoolArray
    covariates: Mapping[str, FloatArray] = field(default_factory=dict)
    laid: tuple["Laid", ...] = ()
    level: FloatArray | None = None
    stands: BoolArray | None = None
    widest: Mapping[str, int] = field(default_factory=dict)
    half: IntArray = field(default_factory=lambda: np.empty(0, np.int64))
    by: str = "x"
    filters: tuple[Filter, ...] = ()

    @classmethod
    def of(cls, problem: Forced, other: "Measured | None" = None) -> "Measured":
        """From position or speed; a force that is held counts as it acts. Raises SimulationError when little moves.

        other : a recording as which it is to be smoothed.
        """
        if problem.alone:
            return cls.of_several([cls.of(one) for one in problem.alone], problem)
        t = problem.t
        longest = longest_interval(t)
        widest = {} if other is None else other.widest
        smooth: dict[str, Smooth] = {
            c: smoothed(t, y, longest, _least(problem, c), _ALIKE, everywhere=True, widest=widest.get(c))
            for c, y in problem.channels.items()
            if c in ("x", "v")
        }
        # differences pass the filter that the force and the place pass
        by = _telling(smooth) if other is None else other.by
        half = smooth[by].half

        cubics = smoothing(t, longest, half)

        def alike(y: FloatArray) -> FloatArray:
            return np.asarray(cubics @ y)

        x = alike(problem.channels["x"]) if "x" in smooth else state_of(t, smooth)[0]
        slope = problem.channels["v"] if by == "v" else sloped(t) @ problem.channels["x"]
        v, a = alike(slope), alike(sloped(t) @ slope)
        v_sd = smooth["v"].value_sd if by == "v" else smooth["x"].slope_sd
        kept = t.size // BLOCK * BLOCK
        u = alike(felt(problem.drive, t, by))
        at_rest = np.abs(v) <= _AT_REST * v_sd
        stands = np.all((at_rest & inner(t, longest, half))[:kept].reshape(-1, BLOCK), axis=1)
        # the speed there has its own reach, and two differences; so has what is compared with it
        rests = widened(_stands(at_rest), 2 * (half + 2) + _SOONER if problem.guarded else half + 2)
        if problem.guarded:
            # within the reach of a cubic and a difference friction turns round; where a servo sticks it has any value
            at_rest[1:] |= np.sign(v[1:]) != np.sign(v[:-1])
            at_rest = widened(at_rest, half + 2)
        at_rest |= rests
        slides = ~at_rest[:kept].reshape(-1, BLOCK)
        whole = np.max(np.diff(t[:kept].reshape(-1, BLOCK), axis=1), axis=1) <= longest
        # two differences at the ends of a stretch are one-sided
        central = inner(t[:kept], longest, half[:kept] + 2).reshape(-1, BLOCK)
        moving = whole & np.all(slides & central, axis=1)
        if np.count_nonzero(moving) < BLOCK:
            raise SimulationError("the slider hardly moves")
        given = {name: alike(y)[:kept] for name, y in problem.covariates.items()}
        passed = Filter.of(cubics[:kept, :kept], t[:kept], by, slope[:kept], BLOCK)
        chosen = {c: one.widest for c, one in smooth.items()}
        return cls(
            t[:kept], x[:kept], v[:kept], a[:kept], u[:kept], moving, given, stands=stands, widest=chosen,
            half=half[:kept], by=by, filters=(passed,),
        )  # fmt: skip

    @classmethod
    def of_several(cls, each: Sequence["Measured"], problem: Forced) -> "Measured":
        """Recordings as they lie in a problem of several; itself of one."""
        if not problem.alone:
            return each[0]
        ends = np.cumsum([0, *(one.t.size for one in each)]).tolist()
        laid = tuple(Laid(slice(a, b), c) for a, b, c in zip(ends, ends[1:], problem.clocks, strict=False))
        return cls(
            np.concatenate([one.t + own.clock for one, own in zip(each, laid, strict=True)]),
            np.concatenate([one.x for one in each]),
            np.concatenate([one.v for one in each]),
            np.concatenate([one.a for one in each]),
            np.concatenate([one.u for one in each]),
            np.concatenate([one.moving for one in each]),
            {name: np.concatenate([one.covariates[name] for one in each]) for name in each[0].covariates},
            laid=laid,
            level=np.repeat(problem.levels, [one.moving.size for one in each]),
            half=np.concatenate([one.half for one in each]),
            by=each[0].by,
            filters=tuple(passed for one in each for passed in one.filters),
        )

    @property
    def each(self) -> tuple["Measured", ...]:
        """Every recording by itself, on its own clock."""
        return tuple(self._one(r, own) for r, own in enumerate(self.laid)) or (self,)

    def _one(self, r: int, own: "Laid") -> "Measured":
        at = own.samples
        blocks = slice(at.start // BLOCK, at.stop // BLOCK)
        t, x, v, a, u = (y[at] for y in (self.t, self.x, self.v, self.a, self.u))
        given = {name: values[at] for name, values in self.covariates.items()}
        return Measured(
            t - own.clock, x, v, a, u, self.moving[blocks], given, half=self.half[at], filters=self.filters[r : r + 1]
        )

    @property
    def begins(self) -> tuple[int, ...]:
        """Which of the blocks that count is the first of each further recording."""
        counted = np.concatenate(([0], np.cumsum(self.moving)))
        return tuple(int(counted[own.samples.start // BLOCK]) for own in self.laid[1:])

    def even(self, force: FloatArray) -> FloatArray:
        """A force (m,), N, or its partials (m, q), over the level of its recording."""
        if self.level is None:
            return force
        return np.asarray((force.T / self.level[self.moving]).T, dtype=np.float64)

    def blocks(self, y: FloatArray) -> FloatArray:
        """Means of y (n,) or (n, q) over the blocks that count."""
        found: FloatArray = y.reshape(self.moving.size, y.shape[0] // self.moving.size, *y.shape[1:]).mean(axis=1)
        return found[self.moving]

    def seen(self, forces: FloatArray) -> FloatArray:
        """Forces at the samples (n, q), N, as they are fitted, (m, q): through the filter of the recorded one."""
        return np.asarray(np.concatenate([of.blocks.of @ forces[at] for of, at in self._passed])[self.moving])

    def counted(self, values: FloatArray) -> FloatArray:
        """The other way round: what a force at each sample (n,) counts in a weighed sum of those that are fitted."""
        every = np.zeros(self.moving.size)
        every[self.moving] = values
        size = self.t.size // every.size
        parts = ((of.blocks.of, every[at.start // size : at.stop // size]) for of, at in self._passed)
        return np.asarray(np.concatenate([of.T @ part for of, part in parts]))

    @property
    def _passed(self) -> Iterator[tuple[Filter, slice]]:
        """The filter and the samples of each recording; of one that was not smoothed means alone."""
        size = self.t.size // self.moving.size
        for r, at in enumerate([own.samples for own in self.laid] or [slice(0, self.t.size)]):
            yield self.filters[r] if self.filters else Filter.none(at.stop - at.start, size), at

    def asked(self, model: Model, by: tuple[By, ...] = ()) -> tuple[FloatArray, FloatArray]:
        """Force (m,), N, that a model needs for this motion, mean over the blocks that count, and its partials (m, q).

        by : the numbers whose partials are wanted.
        """
        found = [of.blocks.asked(*one) for of, one in self._needed_by(model, by)]
        force, partials = (np.concatenate(each) for each in zip(*found, strict=True))
        return force[self.moving], partials[self.moving]

    def needed(self, model: Model) -> FloatArray:
        """Force (n,), N, that a model needs for this motion."""
        return np.concatenate([of.samples.asked(*one)[0] for of, one in self._needed_by(model, ())])

    def _needed_by(
        self, model: Model, by: tuple[By, ...]
    ) -> Iterator[tuple[Filter, tuple[Model, FloatArray, FloatArray, tuple[By | None, ...]]]]:
        """Of each recording the filter, its own model, what that needs at the samples, and its numbers there."""
        for r, (of, at) in enumerate(self._passed):
            here = model.of_recording(r) if self.laid else model
            numbers = tuple(in_recording(number, model, r) for number in by) if self.laid else by
            clock = self.laid[r].clock if self.laid else 0.0
            given = {name: values[at] for name, values in self.covariates.items()}
            motion = self.t[at] - clock, self.x[at], self.v[at], self.a[at]
            yield of, (here, *asked(here, *motion, given, numbers), numbers)

    @property
    def late(self) -> FloatArray:
        """What a force that acts a sample later would be less, N (m,), mean over the blocks that count.

        Beside a reversal, where smoothing rounds off a jump of the force, it says nothing of that.
        """
        return self.blocks(np.concatenate([one._less_later() for one in self.each]))

    def _less_later(self) -> FloatArray:
        turns = np.concatenate(([False], np.sign(self.v[1:]) != np.sign(self.v[:-1])))
        smooth = ~widened(turns, self.half + 2)
        return np.asarray(np.where(smooth, np.gradient(self.u, self.t) * float(np.median(np.diff(self.t))), 0.0))

    def held(self, model: Model) -> FloatArray:
        """Force (b,), N, that holds it against a model without friction in each block in which it stands."""
        if self.stands is None or self.laid:
            return np.empty(0)
        still, free = np.zeros_like(self.v), replace(model, f_k=0.0, f_s=None)
        left = self.u - given_force(free, self.t, self.x, still, still, self.covariates)
        return np.asarray(np.mean(left.reshape(-1, BLOCK), axis=1)[self.stands])

    def part(self, keep: BoolArray) -> "Measured":
        """With only these blocks (n / block,) counting."""
        return replace(self, moving=self.moving & keep)


def _telling(smooth: Mapping[str, Smooth]) -> str:
    """The channel that tells the speed with the smaller error: a fine encoder tells more than a noisy tachometer."""
    if len(smooth) == 1:
        return next(iter(smooth))
    return "v" if float(np.median(smooth["v"].value_sd)) <= float(np.median(smooth["x"].slope_sd)) else "x"


def _least(problem: Problem, channel: str) -> float:
    """Noise below which smoothing need not look: what was found; a floor by convention would round off the motion."""
    noise = problem.noise[channel]
    return noise.sigma if noise.found else noise.step / math.sqrt(12.0)


def _stands(at_rest: BoolArray) -> BoolArray:
    """Where at least a block of samples is at rest (n,): friction has any value there, and not that of a turn."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], at_rest, [False])).astype(np.int8)))
    found = np.zeros(at_rest.size, dtype=np.bool_)
    for begin, end in edges.reshape(-1, 2):
        found[begin:end] = end - begin >= BLOCK
    return found


def widened(mask: BoolArray, reach: int | IntArray) -> BoolArray:
    """A mask (n,) with so many samples more on either side of what it holds, or (n,) as many as reach each."""
    total = np.concatenate(([0], np.cumsum(mask)))
    at = np.arange(mask.size)
    return np.asarray(total[np.minimum(at + reach + 1, mask.size)] > total[np.maximum(at - reach, 0)])
