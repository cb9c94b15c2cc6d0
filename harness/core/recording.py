"""A recording: channels as somebody measured them, already in SI units."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.checks import increasing, vector
from harness.core.errors import InputError

CHANNELS = ("x", "v", "a", "u")
MINIMUM_SAMPLES, FEWEST_STEADY = 50, 6
LARGEST, SMALLEST = 1e20, 1e-20
"""Of a channel's values and of its range, in SI units."""
LONGEST_TIME, SHORTEST_INTERVAL = 9e9, 1e-15
"""Of a time stamp and of the median interval, s. The viewer counts nanoseconds in 64 bits; and within these bounds the
fourth power of a second difference over the square of an interval, 1e20 / 1e-30, stays a number of double precision."""


@dataclass(frozen=True, slots=True)
class Recording:
    """Measured channels over time, validated and read-only; every array has shape (n,).

    t : s, increasing. channels : any of x (m or rad), v, a, u (N; per unit mass when the mass is unknown).
    covariates : further columns (n,) by name, in the units they came in, which ``units`` has too where a header says.
    file : where it came from. sha256 : of that file. units : the unit each channel was given in.
    angular : whether x or a was given as an angle. notes : what the reader did, one sentence each. columns : by
    channel, the column of the file as --columns takes it. mended : of the notes, those on what was changed or skipped.
    steady : whether each row is a speed v that was held, with the force u that held it; t is then the row's number.

    Raises InputError for fewer than 50 samples, a value not finite or out of all proportion, time that does not
    increase, no channel, or a channel that is constant.
    """

    t: FloatArray
    channels: Mapping[str, FloatArray]
    file: str = "recording"
    sha256: str = ""
    units: Mapping[str, str] = field(default_factory=dict)
    angular: bool = False
    notes: tuple[str, ...] = ()
    extra: Mapping[str, Any] = field(default_factory=dict)
    covariates: Mapping[str, FloatArray] = field(default_factory=dict)
    columns: Mapping[str, str] = field(default_factory=dict)
    mended: tuple[str, ...] = ()
    steady: bool = False

    def __post_init__(self) -> None:
        t = vector(f"{self.file}: column t", self.t)
        fewest = FEWEST_STEADY if self.steady else MINIMUM_SAMPLES
        if t.size < fewest:
            raise InputError(self.file, f"{t.size} samples", f"at least {fewest}")
        _within(f"{self.file}: column t", t, LONGEST_TIME)
        increasing(f"{self.file}: column t", t)
        interval = float(np.median(np.diff(t)))
        if interval < SHORTEST_INTERVAL:
            accepted = f"{SHORTEST_INTERVAL:g} s or more"
            raise InputError(f"{self.file}: column t", f"samples {interval:.3g} s apart", accepted)
        object.__setattr__(self, "t", t)
        unknown = [name for name in self.channels if name not in CHANNELS]
        if unknown or not any(name in self.channels for name in ("x", "v", "a")):
            found = f"channels {', '.join(self.channels) or 'none'}"
            raise InputError(self.file, found, "t and one or more of x, v, a, and u")
        kept = {}
        for name in CHANNELS:
            if name in self.channels:
                values = vector(f"{self.file}: column {name}", self.channels[name], t.size)
                where = f"{self.file}: column {name}"
                _within(where, values, LARGEST)
                spread = float(np.ptp(values))
                if name != "u" and spread == 0.0:
                    raise InputError(where, f"the constant {values[0]:g}", "a channel that moves")
                if 0.0 < spread < SMALLEST:
                    raise InputError(where, f"a range of {spread:.3g}", f"one of {SMALLEST:g} or more")
                kept[name] = values
        object.__setattr__(self, "channels", MappingProxyType(kept))
        beside = {}
        for name, column in self.covariates.items():
            beside[name] = vector(f"{self.file}: column {name}", column, t.size)
            _within(f"{self.file}: column {name}", beside[name], LARGEST)
        object.__setattr__(self, "covariates", MappingProxyType(beside))
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
    def name(self) -> str:
        """Of its file, without the folder."""
        return Path(self.file).name

    @property
    def rate(self) -> float:
        """Median sampling rate, Hz."""
        return 1.0 / self.interval

    def turned(self) -> "Recording":
        """The same seen from the other side: every channel with the other sign."""
        channels = {c: -y for c, y in self.channels.items()}
        return replace(self, channels=channels, notes=(*self.notes, "its signs are turned, as it went the other way"))

    def cut(self, keep: slice | BoolArray) -> "Recording":
        """The same recording restricted to a slice or a choice (n,) of its samples."""
        return Recording(
            self.t[keep],
            {name: values[keep] for name, values in self.channels.items()},
            self.file,
            self.sha256,
            self.units,
            self.angular,
            self.notes,
            self.extra,
            {name: values[keep] for name, values in self.covariates.items()},
            self.columns,
            self.mended,
            self.steady,
        )


def _within(where: str, values: FloatArray, largest: float) -> None:
    beyond = np.flatnonzero(np.abs(values) > largest)
    if beyond.size:
        row = int(beyond[0])
        raise InputError(f"{where}, row {row + 1}", f"{values[row]:g}", f"at most {largest:g} in size")
