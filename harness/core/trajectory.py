"""The one thing that moves between rooms: a sampled motion and where it came from."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray, ModeArray
from harness.core.checks import increasing, vector
from harness.core.errors import InputError
from harness.core.events import Events


@dataclass(frozen=True, slots=True)
class Source:
    """Who made a trajectory, and how.

    name : "reference", an engine's name, or a file's name. preset : "as-shipped", "tuned", "exact", ...
    version : of the engine or package. dt : simulation step in s, None for an exact or measured one.
    settings : every setting in force. ignored : settings and model parts the engine does not honour, one sentence each.
    wall_s : time the simulation took, s, None when not measured.
    """

    name: str
    preset: str = ""
    version: str = ""
    dt: float | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)
    ignored: tuple[str, ...] = ()
    wall_s: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "settings", MappingProxyType(dict(self.settings)))
        object.__setattr__(self, "ignored", tuple(self.ignored))

    @property
    def label(self) -> str:
        """Name and preset, as tables and plots show it."""
        return f"{self.name} {self.preset}".strip()


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Samples of one motion, validated and read-only; every array has shape (n,).

    t : s, increasing. x : m (rad). v : m/s. a : m/s^2; each belongs to its own time stamp.
    u : applied force in N, or None. mode : contact state (core.events.Mode) or None when the source cannot say.
    extra : further channels a source can give (normal force, friction force, height), same length.
    events : exact events where the source knows them.

    Raises InputError for lengths that differ, a value that is not finite, or time that does not increase.
    """

    t: FloatArray
    x: FloatArray
    v: FloatArray
    a: FloatArray
    source: Source
    u: FloatArray | None = None
    mode: ModeArray | None = None
    extra: Mapping[str, FloatArray] = field(default_factory=dict)
    events: Events = field(default_factory=Events)

    def __post_init__(self) -> None:
        where = f"trajectory {self.source.label}"
        t = vector(f"{where}: t", self.t)
        if t.size < 2:
            raise InputError(where, f"{t.size} samples", "at least 2")
        increasing(where, t)
        object.__setattr__(self, "t", t)
        for name in ("x", "v", "a"):
            object.__setattr__(self, name, vector(f"{where}: {name}", getattr(self, name), t.size))
        if self.u is not None:
            object.__setattr__(self, "u", vector(f"{where}: u", self.u, t.size))
        if self.mode is not None:
            mode = np.ascontiguousarray(self.mode, dtype=np.int8)
            if mode.shape != t.shape:
                raise InputError(f"{where}: mode", f"shape {mode.shape}", f"a vector of {t.size} modes")
            mode.flags.writeable = False
            object.__setattr__(self, "mode", mode)
        extra = {name: vector(f"{where}: {name}", values, t.size) for name, values in self.extra.items()}
        object.__setattr__(self, "extra", MappingProxyType(extra))

    def __len__(self) -> int:
        return int(self.t.size)

    @property
    def duration(self) -> float:
        """Time from the first to the last sample, s."""
        return float(self.t[-1] - self.t[0])
