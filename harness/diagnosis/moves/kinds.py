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
    MotionKind.SLOW_AXIS: "its drive hides friction: {force}",
    MotionKind.HELD: "what is held shows no friction: let it go and record until it rests",
    MotionKind.STEPS: "its controller hides friction: {force}",
    MotionKind.SPIN_UP: "its drive hides friction (switch it off and record until it rests): {force}",
    MotionKind.AT_REST: "nothing moves: {force}",
    MotionKind.NOT_MECHANICAL: "no slider moves so: {force}",
    MotionKind.DRIVEN: "something moves it whose force is not known, or it is hardly damped: {force}",
}
Span = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Moves:
    """reason : what was seen, in a line. spans : of the decays, or of the run-downs, s. forced : its force is known.

    current : how a column that is there may be that force, "" where there is none.
    """

    kind: MotionKind
    reason: str
    spans: tuple[Span, ...] = ()
    forced: bool = False
    current: str = ""

    @property
    def wanted(self) -> str:
        """What recording would tell friction, where this one does not; "" where it does."""
        return "" if self.forced else _WANTED.get(self.kind, "").format(force=self.current or _FORCE)

    def refuse(self, file: str) -> None:
        """Raise InputError for what tells nothing of friction; what is driven unseen is still followed as a swing."""
        if self.wanted and self.kind is not MotionKind.DRIVEN:
            found = f"no motion that shows friction ({self.kind}: {self.reason})"
            raise InputError(file, found, f"another recording, as {self.wanted}")

    @property
    def several(self) -> bool:
        """Whether it holds several decays or run-downs, each of which is a recording."""
        return len(self.spans) > 1 and self.kind in (MotionKind.SEVERAL_DECAYS, MotionKind.RUN_DOWN)

    def part(self, recording: Recording) -> tuple[Recording, tuple[str, ...]]:
        """The largest of several decays, or the longest of several run-downs, by itself, and a sentence on the others;
        else the recording.
        """
        if not self.several:
            return recording, ()
        each = decays_of(recording, self)
        name, runs = next(c for c in CHANNELS if c in recording), self.kind is MotionKind.RUN_DOWN
        most = max(each, key=lambda one: float(one.t[-1] - one.t[0] if runs else np.ptp(one[name])))
        note = (
            f"{len(each)} {'run-downs' if runs else 'decays'} were found, and that from {most.t[0]:.4g} to"
            f" {most.t[-1]:.4g} s is looked at (--from and --to take another, --together all)"
        )
        return most, (note,)


def decays_of(recording: Recording, moves: Moves) -> list[Recording]:
    """Each of several decays or run-downs as a recording; the recording itself where there are not several."""
    if not moves.several:
        return [recording]
    parts = [recording.cut((recording.t >= low) & (recording.t <= high)) for low, high in moves.spans]
    word = "run-down" if moves.kind is MotionKind.RUN_DOWN else "decay"
    return [replace(one, file=f"{one.file} {word} {number}") for number, one in enumerate(parts, 1)]
