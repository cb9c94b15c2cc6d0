"""Files that a diagnosis leaves beside its result: the refined model, and its trace at the recording's own times."""

import json
from pathlib import Path

import numpy as np

from harness.core.recording import Recording
from harness.core.trajectory import Source, Trajectory
from harness.diagnosis.fit.observe import observe
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.problem import Problem
from harness.engines import model_files
from harness.io.store import write_text
from harness.model.document import to_document
from harness.model.model import Model


def simulated(recording: Recording, outcome: Outcome) -> tuple[Trajectory, Trajectory]:
    """Motion of both models at every time of the recording; extra "shown x" and the like: what their sensors show."""
    whole = outcome.problem.at_every_sample(recording.t, recording.channels)
    return _motion("baseline", outcome.base.model, whole, outcome), _motion(
        "refined", outcome.refined.model, whole, outcome
    )


def _motion(name: str, model: Model, whole: Problem, outcome: Outcome) -> Trajectory:
    seen = observe(model, whole, (), outcome.scales)
    extra = {f"shown {channel}": values for channel, values in seen.y.items()}
    return Trajectory(
        whole.t, seen.x, seen.v, seen.a, Source("reference", name), mode=seen.mode, extra=extra, events=seen.events
    )


def write_trace_csv(path: Path, motion: Trajectory, release: float) -> None:
    """Columns t and what the sensors show, in SI units; t reads back as the very numbers of the recording.

    release : s; what the recording shows before it, a hand or a hold, the model says nothing of, and no row stands for.
    """
    moves = motion.t >= release
    t = motion.t[moves]
    channels = {name.removeprefix("shown "): values[moves] for name, values in motion.extra.items()}
    columns = [t, *channels.values()]
    lines = [",".join(["t", *channels])]
    lines += [
        ",".join([repr(row[0]), *(f"{value:.9g}" for value in row[1:])]) for row in np.column_stack(columns).tolist()
    ]
    write_text(path, "\n".join(lines) + "\n")


def write_model(folder: Path, model: Model, angular: bool) -> list[str]:
    """model.json, MJCF, URDF and not_said.txt: what the latter two leave out, returned as sentences.

    angular : x is an angle, and the files are of a hinge.
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_text(folder / "model.json", json.dumps(to_document(model), indent=2) + "\n")
    model_files.export(model, folder, angular)
    return [line for suffix in ("xml", "urdf") for line in model_files.cannot_say(model, suffix, angular)]
