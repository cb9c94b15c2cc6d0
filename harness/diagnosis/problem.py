"""A recording made ready for fitting: channels, their noise, and what was asked.

A problem says itself what distinguishes its kind (harness.diagnosis.problems has them); no room asks which one it is.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import ClassVar, Self, TypeVar

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray, ModeArray
from harness.core.events import Events
from harness.core.recording import Recording
from harness.diagnosis.covariates.values import Acting
from harness.diagnosis.problems.force_noise import ForceNoise
from harness.diagnosis.starts import OneStart, Start, Starts
from harness.estimate.noise import Noise
from harness.kernels.solve import By, Drive, Effort, Scales
from harness.model.model import Model, Restoring

SETTLED = 1e-5
"""A step that promises less in chi-square, of what a value leaves on average, changes nothing that one could see."""


@dataclass(frozen=True, slots=True)
class Observation:
    """What a model shows of a recording: rows y[c] (m,) with partials dy[c] (m, q), and the motion behind them.

    x, v, a, mode : (n,), with the events between them.
    """

    y: dict[str, FloatArray]
    dy: dict[str, FloatArray]
    x: FloatArray
    v: FloatArray
    a: FloatArray
    mode: ModeArray
    events: Events


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem(ABC):
    """What is to be explained; arrays have shape (n,).

    t : s. channels : "x", "v", "a" as measured. noise : per channel. weight : 0 leaves a sample out of
    the fit, 1 of any other, more of one that stands for several.
    level : by channel, each sample's noise over the channel's. jitter : of the time stamps, s, and share : of a
    speed's noise over the speed, 0 where none shows.
    mass : kg, None when unknown (then m = 1 and forces are per unit mass, unless a measured force gives the mass).
    zero_free : x is measured from an unknown zero. zero_chosen : nobody said whether it is. angular : x or a was given
    as an angle. starts : from where it is simulated. drive : the measured force as the solver takes it, None where none
    acts. covariates : by name, measured columns that act too: given, not predicted. acting : how each enters, where the
    motion is followed. enters : how each was found to, and what mass was taken, one sentence each. force_noise : what
    the own noise of a measured force, or of a covariate, does to the whole; None where nothing shows and every start is
    known.
    """

    t: FloatArray = field(kw_only=False)
    channels: Mapping[str, FloatArray] = field(kw_only=False)
    noise: Mapping[str, Noise] = field(kw_only=False)
    weight: Mapping[str, FloatArray] = field(default_factory=dict)
    level: Mapping[str, FloatArray] = field(default_factory=dict)
    jitter: float = 0.0
    share: float = 0.0
    mass: float | None = None
    restoring: Restoring = Restoring.SPRING
    zero_free: bool = False
    zero_chosen: bool = False
    angular: bool = False
    starts: Starts = field(default_factory=OneStart)
    drive: Drive | None = None
    covariates: Mapping[str, FloatArray] = field(default_factory=dict)
    acting: tuple[Acting, ...] = ()
    enters: tuple[str, ...] = ()
    force_noise: ForceNoise | None = None
    provides: ClassVar[frozenset[str]] = frozenset()
    """What a term may need that every problem of this kind has; see ``given``."""
    returns: ClassVar[bool] = True
    """Whether the motion comes back to the same places and speeds, in both directions."""
    moves: ClassVar[bool] = True
    """Whether it is of a motion, which can be simulated beside it."""

    def __post_init__(self) -> None:
        ones = np.ones(self.t.size)
        object.__setattr__(self, "channels", MappingProxyType(dict(self.channels)))
        object.__setattr__(self, "noise", MappingProxyType(dict(self.noise)))
        object.__setattr__(self, "covariates", MappingProxyType(dict(self.covariates)))
        for name, given in (("weight", self.weight), ("level", self.level)):
            object.__setattr__(self, name, MappingProxyType({c: given.get(c, ones) for c in self.channels}))

    @property
    def points(self) -> int:
        """Measured values that count, but for those that starts take."""
        return max(int(sum(np.count_nonzero(w) for w in self.weight.values())) - self.starts.taken, 1)

    @property
    def rows(self) -> Mapping[str, FloatArray]:
        """What a model is fitted to, by name, (m,) each: the channels, sample by sample."""
        return self.channels

    @abstractmethod
    def shows(self, model: Model, by: tuple[By, ...], scales: Scales | None, effort: Effort) -> Observation:
        """What a model shows of the rows, with partials by numbers of it. Raises SimulationError."""

    def left(self, shown: Observation) -> dict[str, FloatArray]:
        """What of the rows a model leaves, (m,) each."""
        return {c: y - shown.y[c] for c, y in self.rows.items()}

    def by_sample(self, residual: FloatArray) -> dict[str, FloatArray]:
        """A fit's residual (N,) as (n,) for every row, in units of the noise of one value."""
        return dict(zip(self.rows, residual.reshape(len(self.rows), -1), strict=True))

    @property
    def simulated(self) -> bool:
        """Whether a look at a model is a simulation, which fewer samples make cheaper."""
        return True

    @property
    def looked_at(self) -> tuple[float, float] | None:
        """Speed above which friction counts, and the share of the recording that counts; None where all of it does."""
        return None

    @property
    def settled(self) -> tuple[float, float]:
        """Gain of a step, and share of chi-square, below which nobody could see what it changes."""
        return SETTLED, SETTLED / self.points

    @property
    def seams(self) -> tuple[int, ...] | None:
        """Where a further recording begins in rows whose residuals stay coloured; None of rows that are whitened."""
        return None

    @property
    def in_newtons(self) -> bool:
        """Whether forces are known, and not only forces per unit mass."""
        return self.mass is not None

    @property
    def given(self) -> frozenset[str]:
        """What a term may need of a recording (see ``Term.needs``), "spring" apart, which is the model's."""
        # on a linear spring what pushes all the time moves the rest position, which no speed or acceleration shows
        shown = "x" in self.channels or self.restoring is not Restoring.SPRING
        zero = shown and not self.zero_free and self.returns
        own = {"angle": self.angular, "zero": zero, "returns": self.returns, "both-ways": self.both_ways}
        return self.provides | {need for need, met in own.items() if met}

    @property
    def both_ways(self) -> bool:
        """Whether it goes in both directions."""
        return self.returns

    @property
    def followed(self) -> "Problem":
        """The same with its motion followed, or what stands for one."""
        return self

    @property
    def rough(self) -> tuple[Model, ...]:
        """Base models to start from, where the recording itself tells them; else they are made from its swing."""
        return ()

    @property
    def scales(self) -> Scales | None:
        """What counts as ordinary in it, where that is not its swing's."""
        return None

    def periods(self, x: FloatArray, residual: FloatArray) -> tuple[float, ...]:
        """Periods of travel (m) at which a fit's residual (N,) stands out over its places x (n,), where they are looked
        for.
        """
        return ()

    @property
    def base_names(self) -> tuple[str, ...]:
        """Base parameters that are fitted."""
        physics = self.physics
        zero = ("offset",) if self.zero_free and "k" in physics and "x" in self.channels else ()
        return (*self.mass_names, *physics, *zero, *self.starts.names)

    @property
    def physics(self) -> tuple[str, ...]:
        """What slows it and pulls it back, which recordings of one machine share."""
        return tuple(name for name in ("c", "k", "f_k") if name != "k" or self.restoring is not Restoring.NONE)

    @property
    def mass_names(self) -> tuple[str, ...]:
        """The mass where the recording itself gives it: then it is fitted."""
        return ()

    @property
    def pairs_searched(self) -> bool:
        """Whether two laws together may explain it: where the zero is known, as on a bench built for one effect.

        On a machine a crowd of small effects is expected, which two laws follow as well as their own.
        """
        return not self.zero_free

    @property
    def on_bench(self) -> bool:
        """Whether somebody says that x is measured from the spring, as on a bench built for an effect or two."""
        return not (self.zero_free or self.zero_chosen)

    @property
    def spare(self) -> float:
        """Chi-square that may be left beyond what whitening allows for: by noise of a force beyond first order."""
        return 0.0 if self.force_noise is None else self.force_noise.beyond

    def holds(self, model: Model) -> float | None:
        """Force, N, that it withstands at rest, where that is decidedly more than a model's friction; None else."""
        return None

    @property
    def choices(self) -> tuple[str, ...]:
        """What was chosen before the search and belongs beside the verdict, one sentence each."""
        jitter = f"The time stamps jitter by {1e3 * self.jitter:.2g} ms; samples count less where the signal is fast."
        share = f"The noise of v grows with the speed, by {100.0 * self.share:.2g} % of it; samples count accordingly."
        said = [text for text, size in ((jitter, self.jitter), (share, self.share)) if size > 0.0]
        return (*self.enters, *said)

    @property
    def slow_is_sensors(self) -> bool:
        """Whether what is slow beside a sample can be the sensors' own: beside a noisy force it is the force's."""
        return self.force_noise is None or not self.force_noise.noise.found

    def own_noise(self, said: Mapping[str, Noise], left: Mapping[str, FloatArray]) -> dict[str, Noise]:
        """The sensors' own noise, where a model leaves (n,) of each channel what is ``said`` to be such a noise.

        Beside a noisy force it is less: what the motion has of that bends within the windows that tell a noise.
        """
        force = self.force_noise
        if force is None or not force.noise.found:
            return dict(said)
        return force.sensors(self.t, said, self.weight, left)

    def whitened(self, values: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Residuals (m,) or partials (m, q) of every row in units of the noise, neighbours independent.

        Beside a noisy force all channels tell of it together: each sample counts as what it adds to those before.
        """
        if self.force_noise is None:
            return apart(self, values)
        own = {c: values[c] for c in self.rows}
        return self.force_noise.whitened(self.t, self.noise, self.weight, own)[0]

    @property
    def alone(self) -> tuple["Problem", ...]:
        """Each recording by itself, where there are several."""
        return ()

    def runs(self, model: Model) -> list[Start]:
        """Each recording as a whole, with the model at its start; one alone stretch by stretch."""
        return self.starts.of(model)

    @property
    def own_names(self) -> tuple[str, ...]:
        """Base parameters that each of several recordings has of its own."""
        return ()

    @property
    def duration(self) -> float:
        """How long the motion is followed from one start, s."""
        return float(self.t[-1] - self.t[0])

    @property
    def parts_amplitude_from_time(self) -> bool:
        """Whether one amplitude is seen at several times since the release: else a law of either follows the other."""
        return False

    def even(self, channel: str, values: FloatArray) -> FloatArray:
        """Residuals (n,) or partials (n, q) of a channel as if its noise were the same throughout."""
        return np.asarray((values.T / self.level[channel]).T, dtype=np.float64)

    def opening(self, share: float) -> BoolArray:
        """The samples (n,) of the first part, this share of all."""
        return np.arange(self.t.size) < int(share * self.t.size)

    def first_part(self, share: float) -> Self:
        """The first part by itself."""
        return self.part(slice(0, int(share * self.t.size)))

    @abstractmethod
    def of_hand_free(self, fewest: int) -> tuple[Self, float]:
        """What follows the first turning point, and the time left out, s: from there on a misfit tells of the model.

        Itself where no hand lets go, and where fewer than so many samples stay.
        """

    @abstractmethod
    def turns(self, v: FloatArray) -> IntArray:
        """Samples (m,) at which the motion turns round, in order; v (n,) : speed of a model that follows it."""

    def under_noise(self, noise: Mapping[str, Noise]) -> Self:
        """The same with each channel's noise so, and no other: what noise of a force does is no longer allowed for."""
        return replace(self, noise=noise, force_noise=None)

    def giving(self, covariate: str, values: FloatArray) -> Self:
        """The same with other values (n,) of a covariate, which no filter changes."""
        return replace(self, covariates={**self.covariates, covariate: values})

    def drive_over(self, begin: float, end: float) -> Drive | None:
        """The force that acts between two times, s, in time since the first."""
        return None

    def on_clock(self, clock: float, t: FloatArray) -> Self:
        """With the force on a clock that is zero at ``clock`` (s), over times t (k,) of that."""
        if self.drive is None or clock == 0.0:
            return self
        at, force = self.drive.within(float(t[0]) + clock, float(t[-1]) + clock)
        return replace(self, drive=replace(self.drive, t=at - clock, u=force))

    def weighted(self, keep: Mapping[str, BoolArray] | BoolArray) -> Self:
        """The same with only these samples counting."""
        mask = keep if isinstance(keep, Mapping) else dict.fromkeys(self.channels, keep)
        return replace(self, weight={c: self.weight[c] * mask[c] for c in self.channels})

    def part(self, keep: slice) -> Self:
        """A stretch or a thinning of it; colour fades with the distance of the samples kept."""
        stride = keep.step or 1
        return replace(
            self,
            starts=self.starts.part(range(*keep.indices(self.t.size))),
            t=self.t[keep],
            noise={c: replace(n, phi=n.phi**stride) for c, n in self.noise.items()},
            channels={c: y[keep] for c, y in self.channels.items()},
            weight={c: w[keep] for c, w in self.weight.items()},
            level={c: y[keep] for c, y in self.level.items()},
            covariates={name: values[keep] for name, values in self.covariates.items()},
        )

    def condensed(self, shown: Mapping[str, FloatArray], size: int) -> tuple[Self, float]:
        """In means of ``size`` neighbours, and by how much its chi-square falls short of the whole one's.

        shown (n,) : by channel, what a model that follows the recording shows; means are taken of what it leaves.
        """
        small, force = in_means(self, shown, size), self.force_noise
        return replace(small, force_noise=None if force is None else replace(force, averaged=True)), 1.0

    def at_every_sample(self, t: FloatArray, channels: Mapping[str, FloatArray]) -> "Problem":
        """The same question at every sample t (m,), s, of the recording it was made from; channels (m,) of it."""
        given = {name: np.interp(t, self.t, values) for name, values in self.covariates.items()}
        level = {c: np.interp(t, self.t, y) for c, y in self.level.items()}
        own = {c: channels[c] for c in self.channels}
        return replace(self, t=t, channels=own, weight={}, level=level, covariates=given)

    def shown_beside(self, recording: Recording) -> Recording:
        """What of the recording it was made from models can be shown beside: all of it."""
        return recording


P = TypeVar("P", bound=Problem)


def apart(problem: Problem, values: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Residuals (n,) or partials (n, q) whitened channel by channel; samples without weight are zero."""
    white = {c: problem.noise[c].whitened(problem.even(c, values[c])) for c in problem.channels}
    return {c: w * (problem.weight[c] if w.ndim == 1 else problem.weight[c][:, None]) for c, w in white.items()}


def in_means(problem: P, shown: Mapping[str, FloatArray], size: int) -> P:
    """A problem in means of neighbours; see ``Problem.condensed``."""
    first = np.arange(0, problem.t.size - size + 1, size)
    middle = first + size // 2
    used = int(first[-1]) + size
    channels, weight, level = {}, {}, {}
    for c, y in problem.channels.items():
        counts = problem.weight[c][:used]
        total = np.add.reduceat(counts, first)
        left = np.add.reduceat((y - shown[c])[:used] * counts, first)
        channels[c] = shown[c][middle] + left / np.maximum(total, 1e-300)
        weight[c] = np.sqrt(total / size)
        level[c] = np.sqrt(np.add.reduceat(problem.level[c][:used] ** 2, first) / size)
    noise = {c: n.of_means(size) for c, n in problem.noise.items()}
    given = {name: np.add.reduceat(values[:used], first) / size for name, values in problem.covariates.items()}
    t = problem.t[middle]
    return replace(problem, t=t, channels=channels, weight=weight, level=level, noise=noise, covariates=given)
