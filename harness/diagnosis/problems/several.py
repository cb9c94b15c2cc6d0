"""From where several recordings of one slider are simulated: each from its own start, on its own clock."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from harness.diagnosis.problems.starts import OneStart, Start, Window
from harness.kernels.solve import By
from harness.model.elsewhere import named, parted
from harness.model.model import Model


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
        """Position and speed of each."""
        return tuple(named(stem, r) for r in range(len(self.stretches)) for stem in ("x0", "v0"))

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


def stem_of(name: str) -> str:
    """A base parameter whichever recording it is of."""
    return parted(name)[0]
