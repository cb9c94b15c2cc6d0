"""Recordings of any format, our own .rrd among them, and what a result says about them."""

import os
import re
import shlex
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.bounded import MEBIBYTE, MOST_BYTES
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.diagnosis.moves.classify import without_idle_force
from harness.estimate.means import ENOUGH, FINISHED, is_dense, means
from harness.estimate.noise import Noise
from harness.io.options import ReadOptions
from harness.io.recording import read_recording
from harness.results.common import RecordingInfo

__all__ = ["ReadOptions", "read", "read_as", "read_runs", "read_sim", "recording_info", "refuse_twice", "spooled"]


def read(path: Path, options: ReadOptions, trace: str | None = None) -> Recording:
    """Read a recording; ``trace`` names the one to take of a .rrd that holds several ("mujoco tuned").

    Raises InputError naming what is wrong, and where.
    """
    if trace is not None and path.suffix.lower() != ".rrd":
        raise InputError("--trace", f"given for {path}", "it goes with a .rrd of ours alone")
    found = read_recording(path, options, lambda file: _from_rrd(file, trace))
    return without_idle_force(found) if options.columns is None else found


def read_sim(
    path: Path, options: ReadOptions, trace: str | None = None, own: tuple[str, ...] = ("columns", "skip-rows", "rate")
) -> Recording:
    """As ``read``, a trace of the user's own simulation. own : options that begin with --sim- where they are its."""

    def named(text: str) -> str:
        return re.sub(rf"--({'|'.join(own)})\b", r"--sim-\1", text)

    try:
        found = read(path, options, trace)
    except InputError as error:
        raise InputError(named(error.where), named(error.found), named(error.accepted)) from None
    return replace(found, notes=tuple(map(named, found.notes)))


def read_as(label: str, path: Path, options: ReadOptions, trace: str | None = None) -> Recording:
    """As ``read``, under another name where the file stands in for something else (standard input)."""
    if label == str(path):
        return read(path, options, trace)
    try:
        return replace(read(path, options, trace), file=label)
    except InputError as error:
        raise InputError(
            error.where.replace(str(path), label), error.found.replace(str(path), label), error.accepted
        ) from None


def read_runs(label: str, path: Path, options: ReadOptions, trace: str | None = None) -> list[Recording]:
    """As ``read_as``, each of the runs that a file holds; the one that is asked for alone."""
    first = read_as(label, path, options, trace)
    count = 1 if options.run is not None else int(first.extra.get("runs", 1))
    rest = [read_as(label, path, replace(options, run=number), trace) for number in range(2, count + 1)]
    if not rest:
        return [first]
    return [replace(one, file=f"{one.file} run {number}") for number, one in enumerate((first, *rest), 1)]


_OF_SEVERAL = {"--together", "--conditions"}
"""Options that do not go with one recording."""


def refuse_twice(recordings: Sequence[Recording], command: str = "") -> None:
    """Raise InputError where two recordings are the same samples: what one of them says would count twice.

    command : the line that gave them, "" where none did.
    """
    firsts, again = list[Recording](), list[tuple[Recording, Recording]]()
    for one in recordings:
        known = next((first for first in firsts if _same(one, first)), None)
        if known is None:
            firsts.append(one)
        else:
            again.append((one, known))
    for one, first in again[:1]:
        said = "given twice" if one.file == first.file else f"the same samples as {first.file}"
        line = _without(command, [copy.file for copy, _ in again], alone=len(firsts) == 1)
        raise InputError(one.file, f"{said}: it would count twice", line)


def _same(one: Recording, other: Recording) -> bool:
    return one.channels.keys() == other.channels.keys() and all(
        np.array_equal(y, its) for y, its in zip(_columns(one), _columns(other), strict=True)
    )


def _without(command: str, files: Sequence[str], alone: bool) -> str:
    """The end of an error: the line without the last time that it names each file. alone : whether one is left."""
    words = shlex.split(command)
    if not set(files) <= set(words):
        return "each recording once"
    for file in files:
        del words[len(words) - 1 - words[::-1].index(file)]
    kept = [
        word
        for before, word in zip(["", *words], words, strict=False)
        if not (alone and (word in _OF_SEVERAL or before == "--conditions"))
    ]
    return f"try: {shlex.join(kept)}"


def _columns(recording: Recording) -> list[FloatArray]:
    return [recording.t, *(recording.channels[name] for name in sorted(recording.channels))]


@contextmanager
def spooled(stream: BinaryIO) -> Iterator[Path]:
    """A CSV stream as a file that is there for the while; reading goes by files."""
    handle, name = tempfile.mkstemp(prefix="friction-harness-", suffix=".csv")
    try:
        with os.fdopen(handle, "wb") as file:
            left = MOST_BYTES + 1
            while piece := stream.read(min(left, MEBIBYTE)):
                file.write(piece)
                left -= len(piece)
        if not left:
            raise InputError("-", f"more than {MOST_BYTES} bytes", "at most as many")
        yield Path(name)
    finally:
        with suppress(OSError):
            os.unlink(name)


def _from_rrd(path: Path, trace: str | None) -> Recording:
    from harness.show.stored import read_trace

    stored = read_trace(path)
    found = {recording.file: recording for recording in stored.recordings}
    found |= {trajectory.source.label: _recording(trajectory) for trajectory in stored.trajectories}
    if trace is None and len(found) == 1:
        return next(iter(found.values()))
    if trace not in found:
        text = "no --trace" if trace is None else f"no trace '{trace}'"
        raise InputError(f"{path}", f"{text} among {len(found)}", f"--trace with one of {', '.join(found)}")
    return found[trace]


def _recording(trajectory: Trajectory) -> Recording:
    """A simulated trace as if somebody had measured x and a."""
    return Recording(trajectory.t, {"x": trajectory.x, "a": trajectory.a}, trajectory.source.label)


def recording_info(recording: Recording, noise: Mapping[str, Noise]) -> RecordingInfo:
    return RecordingInfo(
        file=recording.file,
        sha256=recording.sha256,
        samples=len(recording),
        channels=list(recording.channels),
        rate_hz=recording.rate,
        duration_s=recording.duration,
        noise={channel: noise[channel].said if channel in noise else None for channel in recording.channels},
        notes=list(recording.notes),
        speeds=speeds_of(recording) if recording.steady else None,
    )


def speeds_of(recording: Recording) -> str:
    """From which to which speed a table of them goes."""
    v = recording["v"]
    return f"{float(v.min()):.4g} to {float(v.max()):.4g} {'rad/s' if recording.angular else 'm/s'}"


MOST = 1_000_000
"""Samples that are looked at. A diagnosis takes 1.6 kB for each, a comparison 0.9 kB: docs/scale.md."""


def thinned(recording: Recording) -> Recording:
    """Every k-th sample of a recording of more than ``MOST``, with a note; the same where it is shorter.

    The same too where the motion is too fast for its sampling to be thinned, and where a force was measured: what that
    does between samples is part of what moved the machine.
    """
    step = -(-len(recording) // MOST)
    if step < 2 or "u" in recording:
        return recording
    if not all(is_dense(values, step) for values in recording.channels.values()):
        return recording
    note = f"Of {len(recording)} samples each {step}th is looked at: those between lie on the line but for the noise."
    return replace(recording.cut(slice(None, None, step)), notes=(*recording.notes, note))


_BEGINNING = 9
"""Means whose samples a parabola takes to tell the first of all as well as a mean is known."""


def averaged(recording: Recording, edges: FloatArray) -> Recording:
    """A recording of very many samples in means of neighbours, but for those over a reversal, which are of two motions.

    edges (k,) : its reversals, s. Where there are fewer, as ``thinned``.
    """
    half, interval = np.median(np.diff(edges)), np.median(np.diff(recording.t))
    size = min(int(half / interval / FINISHED), len(recording) // ENOUGH)
    if size < 2:
        return thinned(recording)
    kept: BoolArray = np.ones(len(recording) // size, dtype=np.bool_)
    over = np.searchsorted(recording.t, edges) // size
    kept[over[over < kept.size]] = False
    kept[0] = False

    start = recording.t[: _BEGINNING * size] - recording.t[0]

    def few(y: FloatArray) -> FloatArray:
        # where a motion is let go it begins at rest, which no mean shows
        return np.concatenate(([np.polynomial.Polynomial.fit(start, y[: start.size], 2)(0.0)], means(y, size)[kept]))

    channels = {c: few(y) for c, y in recording.channels.items()}
    return replace(
        recording, t=np.concatenate((recording.t[:1], means(recording.t, size)[kept])), channels=channels, covariates={}
    )
