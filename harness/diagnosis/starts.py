"""From where a recording is simulated: as a whole from the model's own start, or window after window.

A window starts with position and speed as recorded, and internal states as the motion before it has left them.

From where several recordings of one slider are simulated: each from its own start, on its own clock.

From where several driven recordings of one slider are simulated: window after window, each on its own clock.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from harness.core.arrays import FloatArray
from harness.kernels.solve import By
from harness.model.elsewhere import named
from harness.model.model import Model, ModelTerm
from harness.model.term import History, States

_AT_REST = 3.0
"""Standard errors below which a speed is none."""


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
class Start:
    """A stretch of a recording and the model at its start.

    samples : of the stretch. slopes : for each parameter, the partials by it of starts that hang on it, by their names.
    clock : s, where the model's time is zero. own : what fitted numbers are called in this stretch's model where that
    is another name; None for those that are nothing to it.
    """

    samples: slice
    model: Model
    slopes: Mapping[By, Mapping[str, float]]
    clock: float = 0.0
    own: Mapping[By, str | None] = field(default_factory=dict)


class Starts(Protocol):
    """How a recording falls into stretches, and what each starts from."""

    @property
    def names(self) -> tuple[str, ...]:
        """The starts that are parameters of the model."""

    @property
    def taken(self) -> int:
        """Measured values that the starts take, and no parameter says so."""

    def of(self, model: Model) -> list[Start]:
        """The model at the start of every stretch, in order."""

    def part(self, keep: range) -> "Starts":
        """The stretches as they lie in these samples of the recording."""

    def moved(self, anew: Callable[[Window, Model], Window], model: Model) -> "Starts":
        """With what does not belong to the model started anew; ``anew`` gets a window and the model at its start."""


@dataclass(frozen=True, slots=True)
class OneStart:
    """The whole recording from one start, which is the model's own."""

    @property
    def names(self) -> tuple[str, ...]:
        """Position and speed."""
        return ("x0", "v0")

    @property
    def taken(self) -> int:
        """None: they are parameters."""
        return 0

    def of(self, model: Model) -> list[Start]:
        """The model itself."""
        return [Start(slice(None), model, {})]

    def part(self, keep: range) -> "OneStart":
        """The same."""
        return self

    def moved(self, anew: Callable[[Window, Model], Window], model: Model) -> "OneStart":
        """The same."""
        return self


@dataclass(frozen=True, slots=True)
class AtSpeed(OneStart):
    """The same of a motion whose place nothing shows: it begins at 0."""

    @property
    def names(self) -> tuple[str, ...]:
        """The speed."""
        return ("v0",)

    def part(self, keep: range) -> "AtSpeed":
        """The same."""
        return self


@dataclass(frozen=True, slots=True)
class InMotion(OneStart):
    """The whole from one start that lies within a motion: internal states are as the recorded motion has left them.

    t (k,), s, v (k,), m/s : speed up to the start, which is the last of them. before : speed of the last motion, m/s.
    """

    t: FloatArray
    v: FloatArray
    before: float

    def of(self, model: Model) -> list[Start]:
        """The model, its internal states as each term says that the motion before leaves them."""
        motion = History(self.t, self.v, self.t[-1:], np.array([self.before]), model.f_k)
        terms = list(model.terms)
        slopes: dict[By, dict[str, float]] = {}
        for i, entry in enumerate(terms):
            if entry.term.implied is not None:
                states = entry.term.implied(entry.values, motion)
                terms[i] = _left_by(model, i, states, 0, slopes)
        return [Start(slice(None), replace(model, terms=tuple(terms)), slopes)]

    def part(self, keep: range) -> OneStart:
        """The same from the first sample on; of what begins later no motion is kept."""
        return self if keep.start == 0 else OneStart()


def _left_by(model: Model, i: int, states: States, at: int, slopes: dict[By, dict[str, float]]) -> ModelTerm:
    """Term ``i`` with its internal states, and in ``slopes`` their partials by what they hang on."""
    for by, partials in states.by.items():
        names = zip(model.internal_names[i], partials[at].tolist(), strict=True)
        moved = slopes.setdefault((i, by) if isinstance(by, int) else by, {})
        moved |= {name: partial for name, partial in names if partial != 0.0}
    return replace(model.terms[i], internal0=tuple(states.values[at].tolist()))


@dataclass(frozen=True, slots=True)
class Windows:
    """Window after window, none longer than the horizon.

    t (k,), s, v (k,), m/s : smoothed speed of the whole recording, which says how a window's internal states start.
    """

    windows: tuple[Window, ...]
    t: FloatArray
    v: FloatArray

    @property
    def names(self) -> tuple[str, ...]:
        """None: every window has its own."""
        return ()

    @property
    def taken(self) -> int:
        """Two a window."""
        return 2 * len(self.windows)

    def of(self, model: Model) -> list[Start]:
        """The model at the start of every window.

        x0, v0 : as recorded, the sensor's offset taken off; a speed within its error of none is none. Internal states :
        as each term says that the recorded motion leaves them.
        """
        times = np.array([w.t0 for w in self.windows])
        speeds = np.array([0.0 if abs(w.v0) < _AT_REST * w.v_sd else w.v0 for w in self.windows])
        motion = History(self.t, self.v, times, speeds, model.f_k)
        implied = {i: e.term.implied(e.values, motion) for i, e in enumerate(model.terms) if e.term.implied is not None}
        found = []
        for at, (w, v0) in enumerate(zip(self.windows, speeds.tolist(), strict=True)):
            terms = list(model.terms)
            slopes: dict[By, dict[str, float]] = {"offset": {"x0": -1.0}}
            for i, states in implied.items():
                terms[i] = _left_by(model, i, states, at, slopes)
            started = replace(model, x0=w.x0 - model.offset, v0=v0, t0=w.t0, terms=tuple(terms))
            found.append(Start(slice(w.start, w.stop), started, slopes))
        return found

    def part(self, keep: range) -> "Windows":
        """The windows as they lie in these samples of the recording."""

        def place(sample: int) -> int:
            return min(max(-((keep.start - sample) // keep.step), 0), len(keep))

        windows = (replace(w, start=place(w.start), stop=place(w.stop)) for w in self.windows)
        return replace(self, windows=tuple(w for w in windows if w.stop > w.start))

    def moved(self, anew: Callable[[Window, Model], Window], model: Model) -> "Windows":
        """With each window started anew."""
        starts = zip(self.windows, self.of(model), strict=True)
        return replace(self, windows=tuple(anew(w, start.model) for w, start in starts))


@dataclass(frozen=True, slots=True)
class Stretch:
    """A recording on the axis on which all lie one behind the other.

    start, stop : its samples. clock : s, where its own time is zero. t0 : of its start, in its own time, s.
    starts : how its internal states begin.
    """

    start: int
    stop: int
    clock: float
    t0: float
    starts: OneStart


@dataclass(frozen=True, slots=True)
class Several:
    """A start for each recording; own : base parameters that each has of its own besides."""

    stretches: tuple[Stretch, ...]
    own: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Those of each."""
        return tuple(named(stem, r) for r, s in enumerate(self.stretches) for stem in s.starts.names)

    @property
    def taken(self) -> int:
        """None: they are parameters."""
        return 0

    def of(self, model: Model) -> list[Start]:
        """The model at the start of every recording, with what that has of its own."""
        theirs = sorted({name for one in model.elsewhere for name in one.names})
        found = []
        for r, s in enumerate(self.stretches):
            own: dict[By, str | None] = {}
            for stem in theirs:
                for other in range(len(self.stretches)):
                    own[named(stem, other)] = stem if other == r else None
            (start,) = s.starts.of(replace(model.of_recording(r), t0=s.t0))
            found.append(replace(start, samples=slice(s.start, s.stop), clock=s.clock, own=own))
        return found

    def part(self, keep: range) -> "Several":
        """The recordings as they lie in these samples; one that is not among them keeps its place."""

        def place(sample: int) -> int:
            return min(max(-((keep.start - sample) // keep.step), 0), len(keep))

        return replace(
            self, stretches=tuple(replace(s, start=place(s.start), stop=place(s.stop)) for s in self.stretches)
        )

    def moved(self, anew: Callable[[Window, Model], Window], model: Model) -> "Several":
        """The same: starts are parameters."""
        return self


@dataclass(frozen=True, slots=True)
class Driven:
    """A recording on the axis on which all lie one behind the other.

    start, stop : its samples. low, high : its samples of the speed that starts are taken from. clock : s, where its own
    time is zero.
    """

    start: int
    stop: int
    low: int
    high: int
    clock: float


@dataclass(frozen=True, slots=True)
class SeveralWindows(Windows):
    """Windows of all recordings on the common axis, none over a seam; own : base parameters that each has of its own.

    What was before a recording's first sample is not known: no motion of another one says how its states begin.
    """

    stretches: tuple[Driven, ...]
    own: tuple[str, ...] = ()

    def of(self, model: Model) -> list[Start]:
        """The model at the start of every window, with what its recording has of its own."""
        theirs = sorted({name for one in model.elsewhere for name in one.names})
        count = len(self.stretches)
        found = []
        for r, s in enumerate(self.stretches):
            own: dict[By, str | None] = {
                named(stem, other): stem if other == r else None for stem in theirs for other in range(count)
            }
            for start in self.alone(r).of(model.of_recording(r)):
                found.append(replace(start, clock=s.clock, own=own))
        return found

    def alone(self, recording: int) -> Windows:
        """The windows of one recording, on its own clock; samples are those of the common axis."""
        s = self.stretches[recording]
        mine = tuple(replace(w, t0=w.t0 - s.clock) for w in self.windows if s.start <= w.start < s.stop)
        return Windows(mine, self.t[s.low : s.high] - s.clock, self.v[s.low : s.high])

    def part(self, keep: range) -> "SeveralWindows":
        """The windows and the recordings as they lie in these samples."""

        def place(sample: int) -> int:
            return min(max(-((keep.start - sample) // keep.step), 0), len(keep))

        kept = Windows.part(self, keep)
        stretches = tuple(replace(s, start=place(s.start), stop=place(s.stop)) for s in self.stretches)
        return replace(self, windows=kept.windows, stretches=stretches)
