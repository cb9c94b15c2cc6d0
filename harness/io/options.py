"""How somebody wants a recording to be read, and other ways that are tried before a file is refused."""

import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from harness.core.checks import finite, positive
from harness.core.errors import InputError
from harness.core.recording import Recording

UNSAID = float("1")
"""Hz: stands for a rate that nobody has said, while a choice of columns is tried."""


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """How to read a recording.

    columns : the text of --columns. skip_rows : lines before the header. rate : Hz, where no column gives the time.
    start, stop : s, the part to keep (--from, --to). drop_nan : skip rows in which a channel has no value.
    covariates : further columns, by name (--covariate). run : which run of a file that holds several, from 1. angle :
    whether what moves turns, whatever the file says (--restoring pendulum). join : files of other signals of the same
    motion.
    """

    columns: str | None = None
    skip_rows: int = 0
    rate: float | None = None
    start: float | None = None
    stop: float | None = None
    drop_nan: bool = False
    covariates: tuple[str, ...] = ()
    run: int | None = None
    angle: bool = False
    join: tuple[Path, ...] = ()

    def __post_init__(self) -> None:
        if self.skip_rows < 0:
            raise InputError("--skip-rows", f"{self.skip_rows}", "0 or more")
        if self.run is not None and self.run < 1:
            raise InputError("--run", f"{self.run}", "1 or more")
        if self.rate is not None:
            positive("--rate", self.rate, "Hz")
        for name, value in (("--from", self.start), ("--to", self.stop)):
            if value is not None:
                finite(name, value)
        if self.start is not None and self.stop is not None and self.stop <= self.start:
            raise InputError("--to", f"{self.stop:g} s, not after --from {self.start:g} s", "a later time")

    @property
    def pasted(self) -> str:
        """The same as options of a command; HZ stands for a rate that is not known."""
        said = [
            "" if self.columns is None else f'--columns "{self.columns}"',
            f"--skip-rows {self.skip_rows}" if self.skip_rows else "",
            "" if self.rate is None else "--rate HZ" if self.rate is UNSAID else f"--rate {self.rate:.6g}",
            "" if self.start is None else f"--from {self.start:.9g}",
            "" if self.stop is None else f"--to {self.stop:.9g}",
            "--drop-nan" if self.drop_nan else "",
            "" if self.run is None else f"--run {self.run}",
            *(f"--covariate '{name}'" for name in self.covariates),
            *(f"--join {shlex.quote(str(name))}" for name in self.join),
        ]
        return " ".join(one for one in said if one)


_DEPTH, _TRIES = 4, 12
"""Options given together at most, and readings of one file."""


class RefusedError(InputError):
    """Bad input that may be read otherwise. others : options that replace those given, best first."""

    def __init__(self, where: str, found: str, accepted: str, others: Sequence[Mapping[str, Any]] = ()) -> None:
        super().__init__(where, found, accepted)
        self.others = tuple(others)


def tried(error: InputError, options: ReadOptions, read: Callable[[ReadOptions], Recording]) -> InputError:
    """The error, ended by options with which ``read`` succeeds and what it reads then; as it is where none of its ways
    leads there.
    """
    if not isinstance(error, RefusedError):
        return error
    found = _first(error, options, read, [_TRIES], _DEPTH)
    if found is None:
        return InputError(error.where, error.found, error.accepted)
    candidate, recording = found
    rows = begun(recording, timed=candidate.rate is not UNSAID)
    return InputError(error.where, error.found, f"try: {candidate.pasted}{READS}{rows}")


READS = ", which reads "
"""Between options to paste and what they read."""
_UNITS = {"x": "m", "v": "m/s", "a": "m/s^2", "u": "N"}


def unit_of_channel(recording: Recording, channel: str) -> str:
    """In which a channel of a recording is."""
    unit = "s" if channel == "t" else _UNITS[channel]
    turns = {"m": "rad", "m/s": "rad/s", "m/s^2": "rad/s^2", "N": "N m"}
    return turns.get(unit, unit) if recording.angular else unit


def begun(recording: Recording, rows: int = 3, timed: bool = True) -> str:
    """The first rows of a recording as they were read."""
    columns = {**({"t": recording.t} if timed and not recording.steady else {}), **recording.channels}
    return "; ".join(
        f"{name} {', '.join(f'{value:.5g}' for value in values[:rows])} {unit_of_channel(recording, name)}"
        for name, values in columns.items()
    )


def _first(
    error: RefusedError, options: ReadOptions, read: Callable[[ReadOptions], Recording], left: list[int], depth: int
) -> tuple[ReadOptions, Recording] | None:
    """The first options, of those that a refusal and what follows it propose, that read the file. left : readings."""
    for other in error.others:
        candidate = replace(options, **other)
        if candidate == options or not depth or not left[0]:
            continue
        left[0] -= 1
        try:
            recording = read(candidate)
        except RefusedError as further:
            found = _first(further, candidate, read, left, depth - 1)
            if found is not None:
                return found
        except InputError:
            continue
        else:
            return candidate, recording
    return None
