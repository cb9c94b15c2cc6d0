"""From where several driven recordings of one slider are simulated: window after window, each on its own clock."""

from dataclasses import dataclass, replace

from harness.diagnosis.problems.starts import Start, Windows
from harness.kernels.solve import By
from harness.model.elsewhere import named
from harness.model.model import Model


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
