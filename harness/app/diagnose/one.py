"""What a simulation with viscous and Coulomb friction leaves out of a recording, and the model that has it."""

import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from harness.app.diagnose.attribution import Configured
from harness.app.diagnose.files import of_first_alone, simulated, write_model, write_trace_csv
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.problem import errors_of, prepared, validation
from harness.app.diagnose.result import STEPS, Diagnosed, result_of, with_laws
from harness.app.diagnose.together import investigate_together
from harness.app.shared.leaving import FILES as ALWAYS
from harness.app.shared.leaving import leave, leaving
from harness.app.shared.over_amplitude import damping_of, write_damping
from harness.app.shared.progress import NAME as LOG
from harness.app.shared.progress import SILENT, Progress, journal
from harness.app.shared.reading import thinned
from harness.core.recording import Recording
from harness.core.telling import listening
from harness.diagnosis.explain.force_map import write_history, write_map
from harness.diagnosis.pipeline import diagnose as conclude
from harness.engines import model_files
from harness.io.store import OutputFolder
from harness.results.diagnosis import DiagnosisResult
from harness.show.report.diagnosis import diagnosis_page
from harness.show.report.diagnosis_figures import model_names
from harness.show.report.scenes import diagnosis_scene

FILES = {
    "result": ALWAYS["result"],
    "report": ALWAYS["report"],
    "rrd": ALWAYS["rrd"],
    "model": "model/model.json",
    "mjcf": "model/slider.xml",
    "urdf": "model/slider.urdf",
    "residual_map": "residual_map.csv",
    "residual_force": "residual_force.csv",
    "refined_trace": "refined_trace.csv",
    "log": LOG,
}
DAMPING = "damping.csv"
"""Of a free decay, besides."""


Finish = Callable[[Diagnosed, Path], tuple[Diagnosed, Mapping[str, str]]]
"""What is said of a diagnosis besides, and the names of files that it writes into the folder beside the models."""


def as_it_is(found: Diagnosed, folder: Path) -> tuple[Diagnosed, Mapping[str, str]]:
    """Nothing besides."""
    return found, {}


def investigate(
    given: Recording | Sequence[Recording], options: DiagnoseOptions, progress: Progress = SILENT, command: str = ""
) -> Diagnosed:
    """Diagnose a recording, or several of one machine together.

    Raises InputError when it cannot be diagnosed, with the reason; SimulationError when no model could be simulated.
    """
    if not isinstance(given, Recording):
        return investigate_together(given, options, progress, command)
    progress("base fit and search", 1, STEPS)
    recording = thinned(given)
    # a fit tries values far out, sees that they overflow, and turns back: nothing to tell anybody
    with np.errstate(over="ignore", invalid="ignore"), listening(progress), errors_of(recording):
        ready = prepared(recording, options)
        recording = ready.recording
        other, user = validation(recording, options), Configured.of(options, recording)
        outcome = conclude(ready.problem, None if other is None else other.judge, options.seconds)
    progress("engines and attribution", 2, STEPS)
    result = result_of(recording, ready, outcome, options, user, other, command)
    recording = outcome.problem.shown_beside(recording)
    own = user.motion(outcome, outcome.problem.at_every_sample(recording.t, recording.channels))
    models = simulated(recording, outcome)
    named = dict(zip(model_names(result), models, strict=False))
    result = result.model_copy(update={"damping": damping_of(outcome.problem, named)})
    motions = (*models, *(() if own is None else (own,)))
    result, left = with_laws(result, outcome)
    return Diagnosed(recording, outcome, motions, result, left)


def deliver(
    given: Recording | Sequence[Recording],
    options: DiagnoseOptions,
    out: Path | None = None,
    name: str = "recording",
    progress: Progress = SILENT,
    command: str = "",
    finish: Finish = as_it_is,
) -> DiagnosisResult:
    """Diagnose as ``investigate`` does, and leave result, report, trace, models and the log in a folder.

    out : new or empty folder, None for reports/NAME-TIME here. name : of that folder. Raises InputError,
    SimulationError, StoreError.
    """
    with leaving(f"diagnose-{name}", out) as output:
        return _write(output, investigate(given, options, progress, command), progress, finish)


def answer(given: Recording | Sequence[Recording], options: DiagnoseOptions) -> DiagnosisResult:
    """Diagnose as ``investigate`` does and leave nothing, the log too; raises InputError, SimulationError."""
    with tempfile.TemporaryDirectory(prefix="friction-harness-") as folder, journal(Path(folder) / LOG):
        found = investigate(given, options)
        page = partial(diagnosis_page, recording=found.recording, simulated=found.simulated)
        return found.result.drawn(page, found.curves)


def _write(output: OutputFolder, found: Diagnosed, progress: Progress, finish: Finish) -> DiagnosisResult:
    progress("writing trace and report", 3, STEPS)
    outcome = found.outcome
    model, problem = outcome.refined.model, outcome.problem
    left_out = write_model(output.work / "model", model, problem.angular)
    found, more_files = finish(found, output.work)
    name = model_files.file_name(model, problem.angular)
    if found.result.damping is not None:
        write_damping(output / DAMPING, found.result.damping)
        more_files = {**more_files, "damping": DAMPING}
    named = {**FILES, "mjcf": f"model/{name}.xml", "urdf": f"model/{name}.urdf", **more_files}
    named |= {"friction": f"model/{model_files.FRICTION}"}
    write_trace_csv(output / FILES["refined_trace"], found.simulated[1], found.recording, outcome)
    write_map(output / FILES["residual_map"], found.left)
    write_history(output / FILES["residual_force"], found.left)
    files = {name: output.at(file) for name, file in named.items()}
    more = {
        "files": files,
        "model_left_out": [*found.result.model_left_out, *left_out, *of_first_alone(outcome)],
        "residual_map": files["residual_map"],
    }
    result = found.result.model_copy(update=more)
    seen = (result, found.recording, found.simulated, found.shown)
    leave(output, result, diagnosis_page(*seen), diagnosis_scene(*seen), found.curves)
    return result
