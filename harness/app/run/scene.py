"""A body of the user's own scene in MuJoCo: creep, lift, drift against dry friction, options that mend it, in words."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import unified_diff
from pathlib import Path
from typing import Any, cast

import numpy as np

from harness.app.shared.leaving import FILES, curves_of, leave, leaving
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.core.checks import positive
from harness.core.errors import InputError
from harness.core.trajectory import Source, Trajectory
from harness.results.scene import Part, SceneDrift, SceneExpected, SceneMotion, SceneResult, SceneTouch, SceneTried
from harness.robot.scene import Moved, Tried, Watched, watch_scene
from harness.show.numbers import number
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


_WHAT = {
    "slide": "slides",
    "spin": "spins about the contact's normal",
    "roll": "tilts or rolls",
    "lift": "lifts off",
}
_NOTHING = 1e-9
"""m/s, below which a speed is not written out."""
_STEADY = 1e-3
"""Of a speed, by which one that is kept may change in a run."""
_ALL = 0.95
"""Share of the friction cones from which on all of them is said to be in use."""
_POINT = 3
"""condim of a contact that has no torsional friction."""


def conclusions(result: SceneResult) -> list[str]:
    """What moved that dry friction would hold, what mends it, how the contacts get their friction."""
    said = [_answer(result), *_detail(result)]
    if result.moved:
        said += _mend(result)
    if result.moved and result.changed is None and result.moved != ["sparse"]:
        said.append("No option that was tried mends it; a smaller timestep or stiffer contacts (solref) may.")
    if "spin" in result.moved and any(one.condim <= _POINT for one in result.touches):
        said.append("Its contacts are points without torsional friction (condim 3): condim 4 holds a spin.")
    slippery = [one for one in result.touches if one.condim == 1]
    if slippery:
        pairs = ", ".join(dict.fromkeys(f"{one.own} on {one.other}" for one in slippery))
        said.append(f"Without friction, whatever its coefficient: {pairs} (condim 1).")
    rules = dict.fromkeys(
        f"{one.own} on {one.other}: friction {one.friction[0]:g}, condim {one.condim}, {one.rule}"
        for one in result.touches
    )
    return said + [f"Friction of {rule}." for rule in list(rules)[:4]]


def _answer(result: SceneResult) -> str:
    name, where = result.body, result.bearer
    if result.diverged_after is not None:
        return f"{name} diverges after {result.diverged_after} steps."
    if not result.touches and result.lost_s is None and result.expected.cone_use is None:
        return f"{name} touches nothing while it is watched: there is no friction to judge."
    if result.lost_s is not None or result.expected.lost_s is not None:
        return _let_go(result)
    if not result.expected.rests:
        does = "and so it would under dry friction"
        if "motion" in result.moved:
            does = f"where dry friction would have it at {_speed(result.expected.creep_m_s)}"
        return f"{name} moves along {where} at {_speed(result.creep_m_s)}, {does}."
    parts = [_WHAT[part] for part in result.moved if part in _WHAT]
    if not parts:
        return f"{name} rests on {where} as dry friction would have it (creep {_speed(result.creep_m_s)})."
    held = f"where dry friction would hold it{_use(result.expected)}"
    return f"{name} {_and(parts)} {held}: {_speed(result.creep_m_s)} along {where}."


def _let_go(result: SceneResult) -> str:
    """Of a body that leaves what holds it, under the file's options or under dry friction."""
    name, holders = result.body, _and(result.bearers or [result.bearer])
    own, exact = result.lost_s, result.expected.lost_s
    if own is not None and exact is None:
        held = f"where dry friction would hold it{_use(result.expected)}"
        return f"{name} is let go by {holders} {_after(own)}, {held}."
    asks = " It takes all the friction there is." if (result.expected.cone_use or 0.0) > _ALL else ""
    if own is None:
        return f"{name} stays with {holders}, where dry friction would let it go {_after(exact)}.{asks}"
    does = "and so it would" if "motion" not in result.moved else f"where it would {_after(exact)}"
    return f"{name} leaves {holders} {_after(own)}, {does} under dry friction.{asks}"


def _after(t: float | None) -> str:
    return "at once" if not t else f"after {t:.2g} s"


def _detail(result: SceneResult) -> list[str]:
    said = []
    if result.dense_differs_m is not None:
        off = f"{number(result.dense_differs_m * 1e3, 3)} mm"
        what = f"a dense Jacobian moves it by up to {off} elsewhere" if "sparse" in result.moved else (
            f"a dense Jacobian gives the same motion, to {off}"
        )  # fmt: skip
        said.append(f"MuJoCo {result.version} has a wrong Hessian for sparse Jacobians, which this scene uses: {what}.")
    own, exact = result.deceleration_m_s2, result.expected.deceleration_m_s2
    falls = result.lost_s is not None or result.expected.lost_s is not None
    if result.touches and not (result.expected.rests or falls) and own is not None and exact is not None:
        kind = "rolls" if result.slip_m_s < 0.1 * max(result.creep_m_s, 1e-9) else "slides"
        how = "slows down" if exact > 0.0 else "gains speed"
        if max(abs(own), abs(exact)) * result.duration_s < _STEADY * result.creep_m_s:
            said.append(f"It {kind} and keeps its speed.")
        else:
            said.append(f"It {kind} and {how} by {abs(own):.4g} m/s^2; under dry friction by {abs(exact):.4g} m/s^2.")
    if result.expected.rests and not falls and "slide" not in result.moved and result.travel_m > 1e-2:
        said.append(f"Before it rested it went {number(result.travel_m * 1e3, 3)} mm.")
    turns = [
        f"{'spins at' if part == 'spin' else 'tilts or rolls at'} {number(rate, 3)} rad/s"
        for part, rate in (("spin", result.spin_rad_s), ("roll", result.roll_rad_s))
        if part in result.moved
    ]
    if "lift" in result.moved:
        turns.append(f"lifts by {number(result.lift_m * 1e3, 3)} mm")
    if turns:
        said.append(f"It {_and(turns)}.")
    return said


def _mend(result: SceneResult) -> list[str]:
    said = []
    changed = result.changed
    if changed is not None:
        words = " ".join(f'{name}="{_value(value)}"' for name, value in changed.options.items())
        cost = result.steps_per_s / changed.steps_per_s
        does = "mends it" if changed.mends else "comes nearest"
        what = (
            f"creep {_speed(changed.creep_m_s)}"
            if result.expected.rests
            else f"lift {number(changed.lift_m * 1e3, 3)} mm"
            if result.moved == ["lift"]
            else f"{_speed(changed.creep_m_s)} against {_speed(result.expected.creep_m_s)}"
        )
        proof = " (the changed file was run)" if result.proved else ""
        said += [f"{words} {does}: {what}{proof}.", f"For that it costs {cost:.2g} times as much a step."]
    noslip = [one for one in result.tried if one.options.get("noslip_iterations", 0) and result.expected.rests]
    worse = [one for one in noslip if one.creep_m_s > result.creep_m_s or one.lost_s or one.diverged_after]
    if worse:
        cone = worse[0].options.get("cone", result.settings["cone"])
        said.append(f"noslip makes it worse with the {cone} cone: {_speed(worse[0].creep_m_s)}.")
    return said


def _use(motion: SceneMotion) -> str:
    return "" if motion.cone_use is None else f" ({100.0 * motion.cone_use:.2g} % of the friction available)"


def _speed(value: float) -> str:
    if abs(value) < _NOTHING:
        return "less than 0.001 µm/s"
    if abs(value) < 1e-3:
        return f"{number(value * 1e6, 3)} µm/s"
    return f"{number(value * 1e3, 3)} mm/s" if abs(value) < 1.0 else f"{number(value, 3)} m/s"


def _value(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _and(parts: list[str]) -> str:
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"
