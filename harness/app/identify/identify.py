"""The estimators on a recording of a free decay."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.app.shared.deliver import to_json
from harness.app.shared.estimates import estimates_of, why_no_decay
from harness.app.shared.journal import NAME as LOG
from harness.app.shared.journal import journal
from harness.app.shared.machine import this_machine
from harness.app.shared.pendulum import NOTE, as_spring
from harness.app.shared.progress import SILENT, Progress
from harness.app.shared.reading import read, recording_info
from harness.app.shared.showing import write_recording_page, write_recording_trace
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.estimate.believed import believed
from harness.estimate.every import estimate_all
from harness.estimate.result import Estimation
from harness.io.options import ReadOptions
from harness.io.store import output_folder
from harness.results.common import P
from harness.results.identify import IdentifyResult, Swing

FILES = {"result": "result.json", "report": "report.html", "rrd": "trace.rrd", "log": LOG}
FREE = "a free decay of at least three half-cycles is accepted"


def estimate(recording: Recording, restoring: Swing = "spring") -> Estimation:
    """The estimates from a recording; a pendulum is read as the spring that it would be.

    Samples at which a sensor stood at the end of its range, or that stray, are left out, and a warning says so.

    Raises InputError with the reason when it is driven, or shows no free decay.
    """
    refuse_driven(recording)
    recording, beyond = believed(recording, ("x", "v"))
    if restoring == "pendulum":
        recording = as_spring(recording)
    x, v, a = (recording.channels.get(name) for name in ("x", "v", "a"))
    estimation = estimate_all(recording.t, x, v, a, unit="rad" if recording.angular else "m")
    why = why_no_decay(estimation.methods, recording.channels)
    if why is not None:
        raise InputError(recording.file, f"no estimate is possible: {why}", FREE)
    return replace(estimation, warnings=(*beyond, *estimation.warnings)) if beyond else estimation


def refuse_driven(recording: Recording) -> None:
    """Raise InputError when a measured force acts: that is no free decay."""
    if "u" in recording and np.any(recording["u"] != 0.0):
        largest = float(np.max(np.abs(recording["u"])))
        found = f"a driven recording (a force of up to {largest:.3g} N acts), which is no free decay"
        raise InputError(f"{recording.file}: channel u", found, FREE)


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
        result = result_of(recording, command, files, restoring)
        progress("writing trace and report", 2, 3)
        (output / FILES["result"]).write_text(to_json(result), encoding="utf-8")
        write_recording_trace(output / FILES["rrd"], result, recording)
        write_recording_page(output / FILES["report"], result, recording)
        output.commit()
    return result


def result_of(
    recording: Recording, command: str = "", files: Mapping[str, str] | None = None, restoring: Swing = "spring"
) -> IdentifyResult:
    """The estimates from a recording as a result; raises InputError as ``estimate`` does."""
    estimation = estimate(recording, restoring)
    noted = [NOTE] if restoring == "pendulum" else []
    return IdentifyResult(
        recording=recording_info(recording, estimation.noise),
        estimates=estimates_of(estimation),
        sensor_phase_rad=P.of(estimation.sensor_phase),
        restoring=restoring,
        warnings=[*noted, *estimation.warnings],
        command=command,
        machine=this_machine(),
        files=dict(files or {}),
    )
