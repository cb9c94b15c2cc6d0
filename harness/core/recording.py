"""A recording: channels as somebody measured them, already in SI units."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.checks import increasing, vector
from harness.core.errors import InputError

CHANNELS = ("x", "v", "a", "u")
MINIMUM_SAMPLES = 50


@dataclass(frozen=True, slots=True)
class Recording:
    """Measured channels over time, validated and read-only; every array has shape (n,).

    t : s, increasing. channels : any of x (m or rad), v, a, u (N; per unit mass when the mass is unknown).
    file : where it came from. sha256 : of that file. units : the unit each channel was given in.
    angular : whether x or a was given as an angle. notes : what the reader did, one sentence each.

    Raises InputError for fewer than 50 samples, a value not finite, time that does not increase, no channel,
    or a channel that is constant.
    """

    t: FloatArray
    channels: Mapping[str, FloatArray]
    file: str = "recording"
    sha256: str = ""
    units: Mapping[str, str] = field(default_factory=dict)
    angular: bool = False
    notes: tuple[str, ...] = ()
    extra: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        t = vector(f"{self.file}: column t", self.t)
        if t.size < MINIMUM_SAMPLES:
            raise InputError(self.file, f"{t.size} samples", f"at least {MINIMUM_SAMPLES} are accepted")
        increasing(f"{self.file}: column t", t)
        object.__setattr__(self, "t", t)
        unknown = [name for name in self.channels if name not in CHANNELS]
        if unknown or not any(name in self.channels for name in ("x", "v", "a")):
            found = f"channels {', '.join(self.channels) or 'none'}"
            raise InputError(self.file, found, "t and one or more of x, v, a, and u are accepted")
        kept = {}
        for name in CHANNELS:
            if name in self.channels:
                values = vector(f"{self.file}: column {name}", self.channels[name], t.size)
                if name != "u" and float(np.ptp(values)) == 0.0:
                    raise InputError(
                        f"{self.file}: column {name}", f"the constant {values[0]:g}", "a channel that moves is accepted"
                    )
                kept[name] = values
        object.__setattr__(self, "channels", MappingProxyType(kept))
        object.__setattr__(self, "units", MappingProxyType(dict(self.units)))
        object.__setattr__(self, "extra", MappingProxyType(dict(self.extra)))
        object.__setattr__(self, "notes", tuple(self.notes))

    def __len__(self) -> int:
        return int(self.t.size)

    def __contains__(self, channel: object) -> bool:
        return channel in self.channels

    def __getitem__(self, channel: str) -> FloatArray:
        return self.channels[channel]

    @property
    def duration(self) -> float:
        """Time from the first to the last sample, s."""
        return float(self.t[-1] - self.t[0])

    @property
    def interval(self) -> float:
        """Median sampling interval, s."""
        return float(np.median(np.diff(self.t)))

    @property
    def rate(self) -> float:
        """Median sampling rate, Hz."""
        return 1.0 / self.interval

    def cut(self, keep: slice) -> "Recording":
        """The same recording restricted to a slice of its samples."""
        return Recording(
            self.t[keep],
            {name: values[keep] for name, values in self.channels.items()},
            self.file,
            self.sha256,
            self.units,
            self.angular,
            self.notes,
            self.extra,
        )
