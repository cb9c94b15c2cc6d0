"""The motion and the force of a driven recording, made ready for inverse dynamics."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d

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
"""Samples by which a joint that is smoothed rests sooner and longer than its speed shows: with them two standard errors
hold 334 of 360 true values of 90 sound joints, without them 305 of 335, and with ten fewer values are told (controls of
``python -m benchmarks.draws path:robot-joint --draws 60`` with seeds 8104, 8106 and 8109)."""
_SPREAD = 7.0
"""Standard deviations within which a block of samples lies that may be at rest: two counts of an encoder, or what noise
hardly ever leaves."""
_BENT = 4
"""A speed that is smoothed over so many samples turns round up to one of these parts of them beside where it does: that
of a cubic with three times the acceleration on one side shifts by a tenth."""
_BESIDE = 2
"""Samples to either side that two differences reach to."""


@dataclass(frozen=True, slots=True)
class Laid:
    """The samples of one recording among several; clock : s, where its own time is zero."""

    samples: slice
    clock: float


@dataclass(frozen=True, slots=True)
class Measured:
    """Motion t (s), x, v, a and force u (N), each (n,), smoothed; n is a multiple of the block.

    covariates : by name, (n,), through the filter that the force passed.

    moving : (b,), values at which the slider surely moves, so that its friction is known, and which lie far enough from
    the ends of a stretch: means over blocks or, where the noise of each is known, samples. recorded : (n,), N, the
    force of these as it was recorded; empty of means.

    laid : of several recordings one behind the other, each with its own clock. level : (b,), by which what is left of
    each is weighed. stands : (n / block,), blocks in which it is at rest throughout. widest : half widths over which
    most of each channel was smoothed. half : (n,) those of the motion. by : the channel that tells its speed. repeats :
    (n,) samples in a row with the same reading.
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
    repeats: IntArray = field(default_factory=lambda: np.empty(0, np.int64))
    recorded: FloatArray = field(default_factory=lambda: np.empty(0))

    @classmethod
    def of(cls, problem: Forced, other: "Measured | None" = None, *, each_sample: bool = False) -> "Measured":
        """From position or speed; a force that is held counts as it acts. Raises SimulationError when little moves.

        other : a recording as which it is to be smoothed. each_sample : whether the force is fitted at every sample, as
        it was recorded.
        """
        if problem.alone:
            return cls.of_several([cls.of(one) for one in problem.alone], problem)
        t = problem.t
        longest = longest_interval(t)
        widest = {} if other is None else other.widest
        smooth: dict[str, Smooth] = {
            c: smoothed(t, y, longest, least(problem, c), _ALIKE, everywhere=True, widest=widest.get(c))
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
        acts = felt(problem.drive, t, by)
        at_rest = np.abs(v) <= _AT_REST * v_sd
        stands = np.all((at_rest & inner(t, longest, half))[:kept].reshape(-1, BLOCK), axis=1)
        size = 1 if each_sample else BLOCK
        turns = np.concatenate(([False], np.sign(v[1:]) != np.sign(v[:-1])))
        if each_sample:
            unsure = at_rest | widened(turns, half // _BENT) | _rests(problem, v, widened(at_rest, half + 2))
            slides = ~widened(unsure, _BESIDE)
        else:
            # the speed there has its own reach, and two differences; so has what is compared with it
            rests = widened(_stands(at_rest), 2 * (half + 2) + _SOONER if problem.guarded else half + 2)
            if problem.guarded:
                # within the reach of a cubic and a difference friction turns round; where a servo sticks it has any
                at_rest = widened(at_rest | turns, half + 2)
            slides = ~(at_rest | rests)
        # at the ends of a stretch cubics are off centre, and two differences one-sided
        near = inner(t[:kept], longest, half[:kept] + 2)
        whole = np.max(np.diff(t[:kept].reshape(-1, BLOCK), axis=1), axis=1) <= longest
        moving = np.all((slides[:kept] & near & np.repeat(whole, BLOCK)).reshape(-1, size), axis=1)
        if np.count_nonzero(moving) * size < BLOCK * BLOCK:
            raise SimulationError("the slider hardly moves")
        given = {name: alike(y)[:kept] for name, y in problem.covariates.items()}
        passed = Filter.of(cubics[:kept, :kept], t[:kept], by, slope[:kept], (BLOCK, size))
        chosen = {c: one.widest for c, one in smooth.items()}
        return cls(
            t[:kept], x[:kept], v[:kept], a[:kept], alike(acts)[:kept], moving, given, stands=stands, widest=chosen,
            half=half[:kept], by=by, filters=(passed,), repeats=_repeats(problem.channels[by])[:kept],
            recorded=acts[:kept] if each_sample else np.empty(0),
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

    @property
    def force(self) -> FloatArray:
        """The values that are fitted, N, (b,), those that do not count among them."""
        return self.recorded if self.recorded.size else self.u.reshape(self.moving.size, -1).mean(axis=1)

    @property
    def slides(self) -> BoolArray:
        """Samples (n,) of the values that count."""
        return np.repeat(self.moving, self.t.size // self.moving.size)

    def even(self, force: FloatArray) -> FloatArray:
        """A force (m,), N, or its partials (m, q), over the level of its recording."""
        if self.level is None:
            return force
        return np.asarray((force.T / self.level[self.moving]).T, dtype=np.float64)

    def blocks(self, y: FloatArray) -> FloatArray:
        """Means of y (n,) or (n, q) over the samples of each value that counts."""
        found: FloatArray = y.reshape(self.moving.size, y.shape[0] // self.moving.size, *y.shape[1:]).mean(axis=1)
        return found[self.moving]

    def seen(self, forces: FloatArray) -> FloatArray:
        """Forces at the samples (n, q), N, as they are fitted, (m, q): through the filter of the recorded one."""
        return np.asarray(np.concatenate([of.fitted.of @ forces[at] for of, at in self._passed])[self.moving])

    def counted(self, values: FloatArray) -> FloatArray:
        """The other way round: what a force at each sample (n,) counts in a weighed sum of those that are fitted."""
        every = np.zeros(self.moving.size)
        every[self.moving] = values
        size = self.t.size // every.size
        parts = ((of.fitted.of, every[at.start // size : at.stop // size]) for of, at in self._passed)
        return np.asarray(np.concatenate([of.T @ part for of, part in parts]))

    @property
    def _passed(self) -> Iterator[tuple[Filter, slice]]:
        """The filter and the samples of each recording; of one that was not smoothed means alone."""
        size = self.t.size // self.moving.size
        for r, at in enumerate([own.samples for own in self.laid] or [slice(0, self.t.size)]):
            yield self.filters[r] if self.filters else Filter.none(at.stop - at.start, size), at

    def asked(self, model: Model, by: tuple[By, ...] = ()) -> tuple[FloatArray, FloatArray]:
        """Force (m,), N, that a model needs for this motion, at the values that count, and its partials (m, q).

        by : the numbers whose partials are wanted.
        """
        found = [of.fitted.asked(*one) for of, one in self._needed_by(model, by)]
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
        """What a force that acts a sample later would be less, N (m,), at the values that count.

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
        """With only these values (b,) counting."""
        return replace(self, moving=self.moving & keep)


def _telling(smooth: Mapping[str, Smooth]) -> str:
    """The channel that tells the speed with the smaller error: a fine encoder tells more than a noisy tachometer."""
    if len(smooth) == 1:
        return next(iter(smooth))
    return "v" if float(np.median(smooth["v"].value_sd)) <= float(np.median(smooth["x"].slope_sd)) else "x"


def least(problem: Problem, channel: str) -> float:
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


def _rests(problem: Forced, v: FloatArray, near: BoolArray) -> BoolArray:
    """Samples (n,) of blocks over which the position does not move beyond its noise, though its smoothed speed v (n,),
    which reaches further, says that it does, or where that was smoothed ``near`` (n,) a rest.
    """
    if "x" not in problem.channels:
        return np.zeros(problem.t.size, dtype=np.bool_)
    x, least_seen = problem.channels["x"], _SPREAD * least(problem, "x")
    still = maximum_filter1d(x, BLOCK, mode="nearest") - minimum_filter1d(x, BLOCK, mode="nearest") <= least_seen
    passed = np.abs(v) * BLOCK * float(np.median(np.diff(problem.t)))
    return widened(still & (near | (passed > least_seen)), BLOCK // 2)


def _repeats(y: FloatArray) -> IntArray:
    """How many samples in a row have the reading that each of y (n,) has."""
    begins = np.flatnonzero(np.concatenate(([True], np.diff(y) != 0.0)))
    runs = np.diff(np.append(begins, y.size))
    return np.asarray(np.repeat(runs, runs), dtype=np.int64)


def widened(mask: BoolArray, reach: int | IntArray) -> BoolArray:
    """A mask (n,) with so many samples more on either side of what it holds, or (n,) as many as reach each."""
    total = np.concatenate(([0], np.cumsum(mask)))
    at = np.arange(mask.size)
    return np.asarray(total[np.minimum(at + reach + 1, mask.size)] > total[np.maximum(at - reach, 0)])
