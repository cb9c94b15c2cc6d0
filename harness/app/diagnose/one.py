"""What a simulation with viscous and Coulomb friction leaves out of a recording, and the model that has it."""

import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.app.diagnose.attribution import Configured
from harness.app.diagnose.files import of_first_alone, runs_of, simulated, write_model, write_trace_csv
from harness.app.diagnose.mismatch import left_over
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.problem import errors_of, prepared
from harness.app.diagnose.result import result_of
from harness.app.diagnose.show import write_diagnosis_page, write_diagnosis_trace
from harness.app.diagnose.validation import validated, validation
from harness.app.shared.deliver import to_json
from harness.app.shared.progress import NAME as LOG
from harness.app.shared.progress import SILENT, Progress, journal
from harness.app.shared.reading import thinned
from harness.core.recording import Recording
from harness.core.telling import listening
from harness.core.trajectory import Trajectory
from harness.diagnosis.explain.force_map import write_history, write_map
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.pipeline import diagnose as conclude
from harness.engines import model_files
from harness.io.store import OutputFolder, output_folder
from harness.results.diagnosis import DiagnosisResult
from harness.show.shown import Shown

STEPS = 4
FILES = {
    "result": "result.json",
    "report": "report.html",
    "rrd": "trace.rrd",
    "model": "model/model.json",
    "mjcf": "model/slider.xml",
    "urdf": "model/slider.urdf",
    "residual_map": "residual_map.csv",
    "residual_force": "residual_force.csv",
    "refined_trace": "refined_trace.csv",
    "log": LOG,
}


@dataclass(frozen=True, slots=True)
class Diagnosed:
    """A diagnosis with what it rests on.

    simulated : base model and refined model at every time of the recording, behind them the user's own simulation
    where there is one. result : without files. shown : of a robot.
    """

    recording: Recording
    outcome: Outcome
    simulated: tuple[Trajectory, ...]
    result: DiagnosisResult
    shown: Shown | None = None


Finish = Callable[[Diagnosed, Path], tuple[Diagnosed, Mapping[str, str]]]
"""What is said of a diagnosis besides, and the names of files that it writes into the folder beside the models."""


def as_it_is(found: Diagnosed, folder: Path) -> tuple[Diagnosed, Mapping[str, str]]:
    """Nothing besides."""
    return found, {}


def investigate(
    recording: Recording, options: DiagnoseOptions, progress: Progress = SILENT, command: str = ""
) -> Diagnosed:
    """Diagnose a recording.

    Raises InputError when it cannot be diagnosed, with the reason; SimulationError when no model could be simulated.
    """
    progress("base fit and search", 1, STEPS)
    recording = thinned(recording)
    # a fit tries values far out, sees that they overflow, and turns back: nothing to tell anybody
    with np.errstate(over="ignore", invalid="ignore"), listening(progress), errors_of(recording):
        ready = prepared(recording, options)
        other, user = validation(recording, options), Configured.of(options, recording)
        outcome = conclude(ready.problem, None if other is None else other.judge, options.seconds)
    progress("engines and attribution", 2, STEPS)
    result = result_of(recording, ready, outcome, options, user, command)
    if other is not None:
        result = result.model_copy(update={"validation": validated(other, outcome, options)})
    recording = outcome.problem.shown_beside(recording)
    own = user.motion(outcome, outcome.problem.at_every_sample(recording.t, recording.channels))
    motions = (*simulated(recording, outcome), *(() if own is None else (own,)))
    return Diagnosed(recording, outcome, motions, result)


def deliver(
    recording: Recording,
    options: DiagnoseOptions,
    out: Path | None = None,
    name: str = "recording",
    progress: Progress = SILENT,
    command: str = "",
    finish: Finish = as_it_is,
) -> DiagnosisResult:
    """Diagnose a recording, and leave result, report, trace, models and the log in a folder.

    out : new or empty folder, None for reports/NAME-TIME here. name : of that folder. Raises InputError,
    SimulationError, StoreError.
    """
    with output_folder(f"diagnose-{name}", out) as output, journal(output / LOG):
        found = investigate(recording, options, progress, command)
        return leave(output, found, progress, finish)


def answer(recording: Recording, options: DiagnoseOptions) -> DiagnosisResult:
    """Diagnose a recording and leave nothing; raises InputError, SimulationError."""
    with unkept():
        return investigate(recording, options).result


@contextmanager
def unkept() -> Iterator[None]:
    """A log of which nothing is left."""
    with tempfile.TemporaryDirectory(prefix="friction-harness-") as folder, journal(Path(folder) / LOG):
        yield


def leave(output: OutputFolder, found: Diagnosed, progress: Progress, finish: Finish = as_it_is) -> DiagnosisResult:
    """Leave a diagnosis in its folder, whole; ``finish`` as in ``deliver``."""
    progress("writing trace and report", 3, STEPS)
    result = _write(output, found, finish)
    output.commit()
    return result


def _write(output: OutputFolder, found: Diagnosed, finish: Finish) -> DiagnosisResult:
    model, angular = found.outcome.refined.model, found.outcome.problem.angular
    left_out = write_model(output.work / "model", model, angular)
    found, more_files = finish(found, output.work)
    name = model_files.file_name(model, angular)
    named = {**FILES, "mjcf": f"model/{name}.xml", "urdf": f"model/{name}.urdf", **more_files}
    write_trace_csv(output / FILES["refined_trace"], found.simulated[1], runs_of(found.recording, found.outcome))
    force = left_over(found.outcome)
    write_map(output / FILES["residual_map"], force)
    write_history(output / FILES["residual_force"], force)
    files = {name: output.at(file) for name, file in named.items()}
    more = {
        "files": files,
        "model_left_out": [*found.result.model_left_out, *left_out, *of_first_alone(found.outcome)],
        "residual_map": files["residual_map"],
    }
    result = found.result.model_copy(update=more)
    (output / FILES["result"]).write_text(to_json(result), encoding="utf-8")
    write_diagnosis_trace(output / FILES["rrd"], result, found.recording, found.simulated, found.shown)
    write_diagnosis_page(output / FILES["report"], result, found.recording, found.simulated, found.shown)
    return result
