"""A recording made ready for fitting: channels, their noise, the drive, and what was asked."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.estimate.noise import Noise
from harness.kernels.solve import Drive
from harness.model.model import Restoring


@dataclass(frozen=True, slots=True)
class Problem:
    """What is to be explained; arrays have shape (n,).

    t : s. channels : "x", "v", "a" as measured. noise : per channel. weight : 0 leaves a sample out of the fit, or 1.
    drive : measured force or None. mass : kg, None when unknown (then m = 1 and forces are per unit mass).
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

    def __post_init__(self) -> None:
        ones = np.ones(self.t.size)
        object.__setattr__(self, "channels", MappingProxyType(dict(self.channels)))
        object.__setattr__(self, "noise", MappingProxyType(dict(self.noise)))
        object.__setattr__(self, "weight", MappingProxyType({c: self.weight.get(c, ones) for c in self.channels}))

    @property
    def points(self) -> int:
        """Measured values that count."""
        return int(sum(np.count_nonzero(w) for w in self.weight.values()))

    def weighted(self, keep: Mapping[str, BoolArray] | BoolArray) -> "Problem":
        """The same with only these samples counting."""
        mask = keep if isinstance(keep, Mapping) else dict.fromkeys(self.channels, keep)
        return replace(self, weight={c: self.weight[c] * mask[c] for c in self.channels})

    def part(self, keep: slice) -> "Problem":
        """A stretch or a thinning of it; colour fades with the distance of the samples kept."""
        stride = keep.step or 1
        return replace(
            self,
            t=self.t[keep],
            noise={c: replace(n, phi=n.phi**stride) for c, n in self.noise.items()},
            channels={c: y[keep] for c, y in self.channels.items()},
            weight={c: w[keep] for c, w in self.weight.items()},
        )
