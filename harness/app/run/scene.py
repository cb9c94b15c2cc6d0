"""A body of the user's own scene in MuJoCo: creep, lift and drift against dry friction, and options that mend it."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import unified_diff
from pathlib import Path
from typing import Any, cast

import numpy as np

from harness.app.run.scene_words import conclusions
from harness.app.shared.leaving import FILES, curves_of, leave, leaving
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.core.checks import positive
from harness.core.errors import InputError
from harness.core.trajectory import Source, Trajectory
from harness.results.scene import Part, SceneDrift, SceneExpected, SceneResult, SceneTouch, SceneTried
from harness.robot.scene import Moved, Tried, Watched, watch_scene
from harness.show.report.own_scene import own_scene_page, own_scene_scene
from harness.show.stored import LIFTED, SPUN

LENGTH = 2.0
"""s, of which the later half is measured."""
_SHORTEST, _LONGEST = 0.05, 60.0


@dataclass(frozen=True, slots=True)
class SceneRun:
    """What to watch. file : MJCF. body : name, None for the only free one. duration : s, None for two.

    Raises InputError for a duration that is too short to measure or too long to wait for.
    """

    file: Path
    body: str | None = None
    duration: float | None = None

    def __post_init__(self) -> None:
        if self.duration is not None:
            length = positive("--duration", self.duration, "s")
            if not _SHORTEST <= length <= _LONGEST:
                found = f"{length:g} s, of which the later half is measured"
                raise InputError("--duration", found, f"try: --duration {min(max(length, LENGTH), _LONGEST):g}")


def run_scene(asked: SceneRun, out: Path | None = None, progress: Progress = SILENT, command: str = "") -> SceneResult:
    """Watch, and leave result.json, trace.rrd, report.html, the changed file and the log in a folder.

    Raises InputError for a file that is no scene and for a body that is not in it, StoreError.
    """
    progress("stepping the scene, and what could mend it", 0, 1)
    found = watch_scene(asked.file, asked.body, asked.duration or LENGTH)
    with leaving(f"run-{found.body}", out) as output:
        named = dict(FILES)
        if found.text is not None:
            file = Path("model") / Path(found.text[0]).name
            (output / "model").mkdir()
            (output / str(file)).write_text(found.text[1], encoding="utf-8")
            named["mjcf"] = str(file)
        files = {name: output.at(file) for name, file in named.items()}
        result = _result(asked, found, command, files)
        motions = _motions(found)
        curves = curves_of({one.source.name: one for one in motions})
        leave(output, result, own_scene_page(result, motions), own_scene_scene(result, motions), curves)
    return result


def _measured(moved: Moved) -> dict[str, Any]:
    """The fields of a SceneMotion."""
    return {
        "creep_m_s": moved.creep,
        "lift_m": moved.lift,
        "spin_rad_s": moved.spin,
        "roll_rad_s": moved.roll,
        "slip_m_s": moved.slip,
        "travel_m": moved.travel,
        "deceleration_m_s2": moved.deceleration,
        "cone_use": moved.use,
        "lost_s": moved.lost,
        "diverged_after": moved.diverged,
        "steps_per_s": moved.steps_per_s,
    }


def _tried(one: Tried) -> SceneTried:
    return SceneTried(**_measured(one.moved), options=one.options, mends=one.mends)


def _result(asked: SceneRun, found: Watched, command: str, files: Mapping[str, str]) -> SceneResult:
    half = 0.5 * found.duration
    own = found.own
    result = SceneResult(
        **_measured(own),
        file=str(asked.file.absolute()),
        version=found.version,
        body=found.body,
        bearer=found.bearer,
        bearers=list(found.bearers),
        start=found.start,
        duration_s=found.duration,
        step_s=found.step,
        settings={"timestep": found.step, "integrator": found.integrator, **found.options},
        drift=SceneDrift(slide_m=own.creep * half, spin_rad=own.spin * half, roll_rad=own.roll * half, lift_m=own.lift),
        expected=SceneExpected(**_measured(found.expected), rests=found.rests),
        moved=cast(list[Part], list(found.moved)),
        touches=[SceneTouch.taken_from(one) for one in found.touches],
        tried=[_tried(one) for one in found.tried],
        changed=None if found.change is None else _tried(found.change),
        change=_diff(found, asked.file),
        proved=found.proved,
        dense_differs_m=found.dense_differs,
        conclusions=[],
        command=command,
        machine=this_machine(),
        files=dict(files),
    )
    notes = [f"In your file {note}." for note in found.notes]
    return result.model_copy(update={"conclusions": [*conclusions(result), *notes]})


def _diff(found: Watched, main: Path) -> str:
    """The change of the file as a diff that ``patch -p0`` takes in the folder of the main one; "" for none."""
    if found.text is None:
        return ""
    file, after = found.text
    name = os.path.relpath(file, main.absolute().parent)
    old, new = (text.splitlines(keepends=True) for text in (Path(file).read_bytes().decode(), after))
    lines = unified_diff(old, new, name, name, n=1)
    return "".join(line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines)


def _motions(found: Watched) -> list[Trajectory]:
    """Slide as a trajectory, lift and spin beside it, one a run: the file's, dry friction's, the changed one's."""
    motions = []
    for name, (t, slid, lifted, spun) in found.curves.items():
        v = np.gradient(slid, t)
        source = Source(name, dt=found.step, settings=found.options if name == "own" else {})
        motions.append(Trajectory(t, slid, v, np.gradient(v, t), source, extra={LIFTED: lifted, SPUN: spun}))
    return motions
