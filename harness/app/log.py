"""What a log of a robot's joints, or a recording, holds: harness log."""

from dataclasses import fields
from pathlib import Path

import numpy as np

from harness.app.shared.deliver import write_text
from harness.app.shared.leaving import curves_of
from harness.core.errors import TRY, InputError
from harness.core.recording import Recording
from harness.diagnosis.moves.classify import classify, without_idle_force
from harness.io.logs.finish import Gain
from harness.io.logs.raw import LogOptions
from harness.io.logs.read import describe_log, source_of
from harness.io.logs.read import read_joint_log as read
from harness.io.logs.tables import NO_POSITION
from harness.io.options import ReadOptions, unit_of_channel
from harness.io.recording import read_recording
from harness.model.model import Restoring
from harness.results.common import MotionResult
from harness.results.robot import LogResult, PreviewResult, Topic
from harness.show.report.identify import recording_page
from harness.show.report.page import render

__all__ = ["LogOptions", "log", "read"]

_SPANS, _ROWS = 144, 3


def log(path: Path, options: LogOptions | None = None, gain: Gain | None = None, page: Path | None = None) -> LogResult:
    """Every topic of a log, with its joints, fields, rate and gaps; of a table that is a recording, that as it is read.

    options : how it is read. gain : N m per A, one or by joint. page : where to write a page that plots a recording.
    Raises InputError for a file that holds neither, and for a page of what is none.
    """
    options = options or LogOptions()
    plain = ReadOptions(**{one.name: getattr(options, one.name) for one in fields(ReadOptions)})
    recording: Recording | InputError = InputError(str(path), "no recording", "a table of one motion")
    if source_of(path).kind == "table" and not options.join:
        try:
            recording = read_recording(path, plain)
            recording = without_idle_force(recording) if plain.columns is None else recording
        except InputError as error:
            recording = error
    topics: list[Topic] = []
    try:
        for one in describe_log(path, options, gain):
            units = {str(kind): unit for kind, unit in one.units.items()}
            topics.append(Topic.taken_from(one, type=one.kind, units_guessed=units))
    except InputError as error:
        # a line to paste that was tried, and what a motion lacks, go before what joints a table lacks
        if not isinstance(recording, Recording):
            of_motion = recording.accepted.startswith(TRY) or error.found.startswith(NO_POSITION)
            raise (recording if of_motion else error) from None
    alone = all(len(topic.joints) <= 1 for topic in topics)
    if not isinstance(recording, Recording) and (page is not None or (alone and recording.accepted.startswith(TRY))):
        raise recording
    if page is not None:
        assert isinstance(recording, Recording)
        write_text(page, render(recording_page(recording)))
    shown = preview(recording) if isinstance(recording, Recording) else None
    result = LogResult(file=str(path.absolute()), topics=topics, recording=shown)
    if isinstance(recording, Recording):
        return result.drawn(recording_page(recording), curves_of({"recording": recording}))
    return result


def motion(recording: Recording, restoring: str | None = None) -> MotionResult:
    """What kind of motion a recording holds. restoring : what pulls it back, where that is known."""
    moves = classify(recording, None if restoring is None else Restoring(restoring))
    return MotionResult.taken_from(moves, spans_s=moves.spans)


def preview(recording: Recording) -> PreviewResult:
    """A recording as it was read."""
    # a table of held speeds is drawn over them
    order = np.argsort(recording["v"], kind="stable") if recording.steady else slice(None)
    spans = {name: np.array_split(y[order], min(_SPANS, y.size)) for name, y in recording.channels.items()}
    columns = {"t": recording.t, **recording.channels}
    return PreviewResult(
        columns=dict(recording.columns),
        samples=len(recording),
        rate_hz=recording.rate,
        duration_s=recording.duration,
        units={name: unit_of_channel(recording, name) for name in columns},
        first={name: values[:_ROWS].tolist() for name, values in columns.items()},
        ranges={name: [float(y.min()), float(y.max())] for name, y in recording.channels.items()},
        envelope={name: [[float(p.min()), float(p.max())] for p in parts] for name, parts in spans.items()},
        motion=motion(recording),
        notes=list(recording.notes),
    )
