"""The estimators on a recording of a free decay."""

from collections.abc import Mapping
from pathlib import Path

from harness.app.identify.base import Base, base_of
from harness.app.shared.deliver import to_json
from harness.app.shared.estimates import estimate, estimates_of
from harness.app.shared.journal import NAME as LOG
from harness.app.shared.journal import journal
from harness.app.shared.machine import this_machine
from harness.app.shared.pendulum import NOTE
from harness.app.shared.progress import SILENT, Progress
from harness.app.shared.reading import read, recording_info
from harness.app.shared.showing import write_recording_page, write_recording_trace
from harness.core.recording import Recording
from harness.estimate.believed import without_limited
from harness.io.options import ReadOptions
from harness.io.store import output_folder
from harness.results.common import P
from harness.results.identify import IdentifyResult, Swing

FILES = {"result": "result.json", "report": "report.html", "rrd": "trace.rrd", "log": LOG}


def identify(
    path: Path,
    options: ReadOptions,
    trace: str | None = None,
    out: Path | None = None,
    progress: Progress = SILENT,
    command: str = "",
    restoring: Swing = "spring",
) -> IdentifyResult:
    """Read a recording, estimate, and leave result.json, trace.rrd, report.html and the log in a folder.

    trace : which of the traces of a .rrd. out : new or empty folder, None for reports/NAME-TIME here. command : the
    line that makes it again. restoring : what pulls back.

    Raises InputError with the reason when the recording cannot be read, is driven, or shows no free decay, StoreError
    when the folder cannot be written.
    """
    progress("reading", 0, 3)
    return deliver(read(path, options, trace), out, path.name.split(".")[0], progress, command, restoring)


def deliver(
    recording: Recording,
    out: Path | None = None,
    name: str = "recording",
    progress: Progress = SILENT,
    command: str = "",
    restoring: Swing = "spring",
) -> IdentifyResult:
    """Estimate, and leave everything in a folder, as ``identify`` does. name : of the default folder."""
    with output_folder(f"identify-{name}", out) as output, journal(output / LOG):
        progress("estimating", 1, 3)
        files = {name: output.at(file) for name, file in FILES.items()}
        result, base = result_of(recording, command, files, restoring)
        progress("writing trace and report", 2, 3)
        (output / FILES["result"]).write_text(to_json(result), encoding="utf-8")
        write_recording_trace(output / FILES["rrd"], result, recording)
        write_recording_page(output / FILES["report"], result, recording, base.motion)
        output.commit()
    return result


def result_of(
    recording: Recording, command: str = "", files: Mapping[str, str] | None = None, restoring: Swing = "spring"
) -> tuple[IdentifyResult, Base]:
    """The estimates from a recording as a result, with the base fit that checks them.

    Raises InputError as ``estimate`` does, and where nothing swings or channels are not of one motion.
    """
    estimation = estimate(recording, restoring)
    base = base_of(without_limited(recording)[0], restoring, estimation, command)
    noted = [NOTE] if restoring == "pendulum" else []
    result = IdentifyResult(
        recording=recording_info(recording, estimation.noise),
        estimates=estimates_of(estimation),
        sensor_phase_rad=P.of(estimation.sensor_phase),
        restoring=restoring,
        baseline=base.fit,
        warnings=[*noted, *base.warnings, *estimation.warnings],
        command=command,
        machine=this_machine(),
        files=dict(files or {}),
    )
    return result, base
