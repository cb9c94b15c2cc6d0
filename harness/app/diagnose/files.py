"""Files that a diagnosis leaves beside its result: the refined model, and its trace at the recording's own times."""

import json
from pathlib import Path

import numpy as np

from harness.core.recording import Recording
from harness.core.trajectory import Source, Trajectory
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.pooling.own import SAID
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.simulated import FINE
from harness.engines import model_files
from harness.io.store import write_text
from harness.kernels.solve import Scales
from harness.model.document import to_document
from harness.model.model import Model


def simulated(recording: Recording, outcome: Outcome) -> tuple[Trajectory, Trajectory]:
    """Motion of both models at every time of the recording; extra "shown x" and the like: what their sensors show."""
    whole = outcome.problem.at_every_sample(recording.t, recording.channels)
    scales = outcome.scales
    return (
        motion_of("baseline", outcome.base.model, whole, scales),
        motion_of("refined", outcome.refined.model, whole, scales),
    )


def motion_of(name: str, model: Model, whole: Problem, scales: Scales) -> Trajectory:
    """A model's motion at every time of a problem, with what its sensors show as extra "shown x" and the like."""
    seen = whole.followed.shows(model, (), scales, FINE)
    extra = {f"shown {channel}": values for channel, values in seen.y.items()}
    return Trajectory(
        whole.t, seen.x, seen.v, seen.a, Source("reference", name), mode=seen.mode, extra=extra, events=seen.events
    )


def of_first_alone(outcome: Outcome) -> list[str]:
    """What the model files of several recordings hold of the first alone."""
    own = [SAID[stem] for stem in outcome.pooled.own] if outcome.pooled is not None else []
    said = " and ".join(["release", "zero", *own])
    return [f"{said} of the recordings after the first: the files are of the first"] if outcome.problem.alone else []


def write_trace_csv(path: Path, motion: Trajectory, recording: Recording, outcome: Outcome) -> None:
    """Columns t and what the refined model's sensors show, in SI units; t reads back as the recording's very numbers.

    Of several recordings each has its number (from 1) in a first column and its own time. What a recording shows
    before its release, a hand or a hold, the model says nothing of, and no row stands for.
    """
    model = outcome.refined.model
    runs = [(slice(None), 0.0, model.t0)]
    if outcome.problem.alone:
        whole = outcome.problem.at_every_sample(recording.t, recording.channels)
        runs = [(one.samples, one.clock, one.model.t0) for one in whole.runs(model)]
    numbered = len(runs) > 1
    names = [name.removeprefix("shown ") for name in motion.extra]
    lines = [",".join([*(["recording"] if numbered else []), "t", *names])]
    for number, (samples, clock, release) in enumerate(runs, 1):
        t = motion.t[samples] - clock
        moves = t >= release
        columns = [t[moves], *(values[samples][moves] for values in motion.extra.values())]
        mark = [str(number)] if numbered else []
        lines += [
            ",".join([*mark, repr(row[0]), *(f"{value:.9g}" for value in row[1:])])
            for row in np.column_stack(columns).tolist()
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
