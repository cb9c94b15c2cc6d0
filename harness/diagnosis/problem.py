"""A recording made ready for fitting: channels, their noise, the drive, and what was asked."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.input_noise.force_noise import ForceNoise
from harness.estimate.noise import Noise
from harness.kernels.solve import Drive
from harness.model.model import Model, Restoring


@dataclass(frozen=True, slots=True)
class Window:
    """A stretch of a driven recording, simulated from its own start.

    start, stop : its samples. t0 (s), x0, v0 : the start, from the smoothed recording. x_sd, v_sd : standard errors.
    """

    start: int
    stop: int
    t0: float
    x0: float
    v0: float
    x_sd: float
    v_sd: float


@dataclass(frozen=True, slots=True)
class Restarts:
    """How a driven recording is simulated: window after window, none longer than the horizon.

    t (k,), v (k,) : smoothed speed of the whole recording.
    """

    windows: tuple[Window, ...]
    t: FloatArray
    v: FloatArray

    def part(self, keep: range) -> "Restarts":
        """The windows as they lie in these samples of the recording."""

        def place(sample: int) -> int:
            return min(max(-((keep.start - sample) // keep.step), 0), len(keep))

        windows = (replace(w, start=place(w.start), stop=place(w.stop)) for w in self.windows)
        return replace(self, windows=tuple(w for w in windows if w.stop > w.start))


@dataclass(frozen=True, slots=True)
class Problem:
    """What is to be explained; arrays have shape (n,).

    t : s. channels : "x", "v", "a" as measured. noise : per channel. weight : 0 leaves a sample out of the fit, or 1.
    drive : measured force or None. force_noise : what its noise does to the whole, None where nothing shows.
    restarts : of a driven recording, None where the whole is simulated from one start. by_force : whether the force is
    what is fitted, and the motion over the windows only shown. mass : kg, None when unknown
    (then m = 1 and forces are per unit mass, unless a measured force gives the mass).
    first : of a driven recording, a rough base model with its start.
    zero_free : x is measured from an unknown zero. angular : x or a was given as an angle.
    """

    t: FloatArray
    channels: Mapping[str, FloatArray]
    noise: Mapping[str, Noise]
    weight: Mapping[str, FloatArray] = field(default_factory=dict)
    drive: Drive | None = None
    mass: float | None = None
    restoring: Restoring = Restoring.SPRING
    zero_free: bool = False
    angular: bool = False
    restarts: Restarts | None = None
    by_force: bool = False
    force_noise: ForceNoise | None = None
    first: Model | None = None

    def __post_init__(self) -> None:
        ones = np.ones(self.t.size)
        object.__setattr__(self, "channels", MappingProxyType(dict(self.channels)))
        object.__setattr__(self, "noise", MappingProxyType(dict(self.noise)))
        object.__setattr__(self, "weight", MappingProxyType({c: self.weight.get(c, ones) for c in self.channels}))

    @property
    def points(self) -> int:
        """Measured values that count, but for two that each start of a window takes."""
        starts = 0 if self.restarts is None else 2 * len(self.restarts.windows)
        return max(int(sum(np.count_nonzero(w) for w in self.weight.values())) - starts, 1)

    @property
    def in_newtons(self) -> bool:
        """Whether forces are known, and not only forces per unit mass."""
        return self.mass is not None or self.drive is not None

    def weighted(self, keep: Mapping[str, BoolArray] | BoolArray) -> "Problem":
        """The same with only these samples counting."""
        mask = keep if isinstance(keep, Mapping) else dict.fromkeys(self.channels, keep)
        return replace(self, weight={c: self.weight[c] * mask[c] for c in self.channels})

    def part(self, keep: slice) -> "Problem":
        """A stretch or a thinning of it; colour fades with the distance of the samples kept."""
        stride = keep.step or 1
        samples = range(*keep.indices(self.t.size))
        return replace(
            self,
            restarts=None if self.restarts is None else self.restarts.part(samples),
            t=self.t[keep],
            noise={c: replace(n, phi=n.phi**stride) for c, n in self.noise.items()},
            channels={c: y[keep] for c, y in self.channels.items()},
            weight={c: w[keep] for c, w in self.weight.items()},
        )
