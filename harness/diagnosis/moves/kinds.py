"""The kinds of motion, and what each tells of friction."""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from harness.core.errors import InputError
from harness.core.recording import CHANNELS, Recording


class MotionKind(StrEnum):
    """What a recording shows."""

    FREE_DECAY = "free-decay"
    SEVERAL_DECAYS = "several-decays"
    RUN_DOWN = "run-down"
    DRIVEN = "driven"
    SLOW_AXIS = "slow-axis"
    HELD = "held"
    STEPS = "steps"
    SPIN_UP = "spin-up"
    AT_REST = "at-rest"
    NOT_MECHANICAL = "not-mechanical"
    FRICTION_CURVE = "friction-curve"


_FORCE = "record the force or current that drives it as a column u, or let it go and record until it rests"
_WANTED = {
    MotionKind.SLOW_AXIS: f"its drive hides friction: {_FORCE}",
    MotionKind.HELD: "what is held shows no friction: let it go and record until it rests",
    MotionKind.STEPS: f"its controller hides friction: {_FORCE}",
    MotionKind.SPIN_UP: f"its drive hides friction: switch it off and record until it rests, or {_FORCE}",
    MotionKind.AT_REST: f"nothing moves: {_FORCE}",
    MotionKind.NOT_MECHANICAL: f"no slider moves so: {_FORCE}",
    MotionKind.DRIVEN: f"something moves it whose force is not known: {_FORCE}",
}
Span = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Moves:
    """reason : what was seen, in a line. spans : of the decays, or of the run-down, s. forced : its force is known."""

    kind: MotionKind
    reason: str
    spans: tuple[Span, ...] = ()
    forced: bool = False

    @property
    def wanted(self) -> str:
        """What recording would tell friction, where this one does not; "" where it does."""
        return "" if self.forced else _WANTED.get(self.kind, "")

    def refuse(self, file: str) -> None:
        """Raise InputError for what tells nothing of friction; what is driven unseen is still followed as a swing."""
        if self.wanted and self.kind is not MotionKind.DRIVEN:
            found = f"no motion that shows friction ({self.kind}: {self.reason})"
            raise InputError(file, found, f"another recording, as {self.wanted}")

    def part(self, recording: Recording) -> tuple[Recording, tuple[str, ...]]:
        """The largest of several decays by itself, and a sentence on the others; else the recording."""
        if self.kind is not MotionKind.SEVERAL_DECAYS:
            return recording, ()
        each = decays_of(recording, self)
        name = next(c for c in CHANNELS if c in recording)
        largest = max(each, key=lambda one: float(np.ptp(one[name])))
        note = (
            f"{len(each)} decays were found, and that from {largest.t[0]:.4g} to {largest.t[-1]:.4g} s is looked at"
            " (--from and --to take another, --together all)"
        )
        return largest, (note,)


def decays_of(recording: Recording, moves: Moves) -> list[Recording]:
    """Each of several decays as a recording; the recording itself where there are not several."""
    if moves.kind is not MotionKind.SEVERAL_DECAYS:
        return [recording]
    parts = [recording.cut((recording.t >= low) & (recording.t <= high)) for low, high in moves.spans]
    return [replace(one, file=f"{one.file} decay {number}") for number, one in enumerate(parts, 1)]
