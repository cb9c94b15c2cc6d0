"""A body of the user's own scene: whether it rests as dry friction would have it, and the least options that mend it.

MuJoCo steps the file itself, in a process apart. What dry friction would do is read from the same scene with an
elliptic cone, whose creep falls as 1/impratio, and a solver that has converged: where creep goes with it, friction
holds; what does not change is the motion.
"""

import math
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import mujoco
import numpy as np

from harness.core.apart import Found, read_apart
from harness.core.arrays import FloatArray
from harness.core.bounded import check_file
from harness.core.errors import InputError, did_you_mean
from harness.engines.mujoco.contacts import Touch
from harness.engines.mujoco.presets import INTEGRATORS, warned
from harness.engines.mujoco.watched import Seen, is_sparse, options_of, watch_of, watched, with_options
from harness.robot.apart import prepared
from harness.robot.bare import with_included
from harness.robot.paste import tags, with_attributes

Options = Mapping[str, Any]

ACCEPTED = "a scene that MuJoCo compiles (MJCF)"
CREEP = 1e-5
"""m/s: slower than this a body counts as resting; it takes a hundred seconds for a millimetre."""
TURN = 1e-3
"""rad/s, of spinning and rolling."""
LIFT = 1e-4
"""m."""
GIVE = 1e-3
"""m, by which a body may settle further than dry friction lets it."""
_SETTLED = 0.05
"""Of what it travels until it rests, which counts as settling too."""
_HELD = 0.2
"""Of the creep of the softest elliptic cone, to which a harder one has to bring it where friction holds."""
_ALIKE = 0.01
"""Of a motion, by which it may differ from that of dry friction."""
_LEAVES = 0.1
"""Of a run, by which a body may be let go earlier or later."""
_EFFORT = {"solver": "Newton", "iterations": 100, "ls_iterations": 50}
"""What MuJoCo ships with: enough for friction."""
_ELLIPTIC = {"cone": "elliptic", "noslip_iterations": 0, **_EFFORT}
_HARDER = (10.0, 100.0, 1000.0, 10000.0)
_NOSLIP = 10
_SPARSE = "4.0.0"
"""The version whose Hessian of sparse Jacobians is wrong."""
_NUMERIC = 1e-6
"""m, by which runs with dense and sparse Jacobians may differ."""
_SECONDS, _BUDGET = 300, 90.0
"""s of a processor: for all of it, and after which nothing further is tried."""


@dataclass(frozen=True, slots=True)
class Moved:
    """A run: what its later half shows.

    creep : m/s. spin, roll : rad/s. lift : m. slip : of the contacts, m/s. use : of the friction cones, of the whole
    run for a body that is let go. deceleration : of the motion, m/s^2. travel : across the contact over the whole run,
    m. lost : s. diverged : steps. See ``Seen``.
    """

    creep: float
    spin: float
    roll: float
    lift: float
    slip: float
    use: float | None
    deceleration: float | None
    travel: float
    touching: float
    lost: float | None
    diverged: int | None
    steps_per_s: float

    @classmethod
    def of(cls, seen: Seen) -> "Moved":
        return cls(
            seen.creep, seen.spin, seen.roll, seen.lift, seen.slip,
            seen.use if seen.lost is None else seen.strained, seen.deceleration,
            float(np.linalg.norm(seen.path[-1] - seen.path[0])), seen.touching, seen.lost, seen.diverged,
            seen.steps_per_s,
        )  # fmt: skip

    @property
    def failed(self) -> bool:
        """It diverged, or let go."""
        return self.diverged is not None or self.lost is not None


@dataclass(frozen=True, slots=True)
class Tried:
    """options : what was changed. mends : whether it brings the body to what dry friction would do."""

    options: dict[str, Any]
    moved: Moved
    mends: bool


@dataclass(frozen=True, slots=True)
class Watched:
    """A body of a scene.

    body, bearer : names; bearers : of all that hold it. start : keyframe, empty for the model's reference. step,
    duration : s. options : of the file. own : as the file has it. expected : as dry friction would do. rests : whether
    that is no motion. moved : which of slide, spin, roll, lift, let go, diverges are the engine's own. tried : in
    order, the least first. change : what mends it, or comes nearest. text : the file with that, and its name. proved :
    that text was run, and does. dense_differs : largest distance between dense and sparse Jacobians, m, where the
    version calls for it. curves : by name, t, slid (m), lifted (m), spun (rad), (n,) each.
    """

    version: str
    body: str
    bearer: str
    bearers: tuple[str, ...]
    start: str
    step: float
    integrator: str
    duration: float
    options: dict[str, Any]
    own: Moved
    expected: Moved
    rests: bool
    moved: tuple[str, ...]
    touches: tuple[Touch, ...]
    tried: tuple[Tried, ...]
    change: Tried | None
    text: tuple[str, str] | None
    proved: bool
    dense_differs: float | None
    curves: Mapping[str, tuple[FloatArray, FloatArray, FloatArray, FloatArray]]
    notes: tuple[str, ...]


def watch_scene(path: Path, body: str | None, duration: float) -> Watched:
    """Step a scene for ``duration`` s in a process apart, then what could mend it; body : None for the only free one.

    Raises InputError for a file that is no scene, and for a body that is not there or cannot move.
    """
    check_file(path, accepted=ACCEPTED, suffixes=(".xml", ".mjcf"))
    columns, about = read_apart(
        f"{__name__}:columns_of", path, ACCEPTED, seconds=_SECONDS, kept=True, body=body, duration=duration
    )
    names = dict.fromkeys(name.partition("/")[0] for name in columns)
    curves = {
        one: (columns[f"{one}/t"], columns[f"{one}/slid"], columns[f"{one}/lifted"], columns[f"{one}/spun"])
        for one in names
    }

    def tried(data: Any) -> Tried:
        return Tried(data["options"], Moved(**data["moved"]), data["mends"])

    change = None if about["change"] is None else tried(about["change"])
    made = {
        "own": Moved(**about["own"]),
        "expected": Moved(**about["expected"]),
        "moved": tuple(about["moved"]),
        "bearers": tuple(about["bearers"]),
        "touches": tuple(Touch(**{**one, "friction": tuple(one["friction"])}) for one in about["touches"]),
        "tried": tuple(map(tried, about["tried"])),
        "change": change,
        "text": None if about["text"] is None else tuple(about["text"]),
        "notes": tuple(about["notes"]),
    }
    return Watched(**{**about, **made}, curves=curves)


def columns_of(path: Path, body: str | None, duration: float) -> Found:
    """The reader."""
    with warned():
        return _Scene(path, body, duration).found()


def _compiled(path: Path, edited: Mapping[Path, str] = MappingProxyType({})) -> tuple[Any, list[str]]:
    if with_included(path)[0].root.tag == "robot":
        found = "a URDF, which is one robot: it has neither options nor what it touches"
        raise InputError(str(path), found, f"try: harness run --robot {path}")
    return prepared(path, edited, fixed=False, touching=True)


class _Scene:
    """The runs of one body."""

    def __init__(self, path: Path, body: str | None, duration: float) -> None:
        self.path, self.began = path, time.process_time()
        self.model, self.notes = _compiled(path)
        self.body = _body(path, self.model, body)
        self.options = options_of(self.model)
        self.base: Options = {}
        self.runs: dict[tuple[tuple[str, Any], ...], Seen] = {}
        self.keyframe = 0 if self.model.nkey else -1
        if self.model.nkey > 1:
            others = ", ".join(repr(self.model.key(i).name) for i in range(1, self.model.nkey))
            self.notes.append(f"it begins at the first keyframe, not at {others}")
        # what holds it is what would under dry friction
        hardest = with_options(self.model, {**_ELLIPTIC, "impratio": _HARDER[2]})
        self.watch = watch_of(hardest, self.body, self.keyframe, duration)

    def _changed(self, changed: Options) -> Any:
        return with_options(self.model, {**self.base, **changed})

    def _key(self, changed: Options) -> tuple[tuple[str, Any], ...]:
        return tuple(options_of(self._changed(changed)).items())

    def run(self, changed: Options) -> Seen:
        """With these options changed; what dry friction is read from is not run again as a change to try."""
        key = self._key(changed)
        if key not in self.runs:
            self.runs[key] = watched(self._changed(changed), self.watch)
        return self.runs[key]

    def found(self) -> Found:
        seen = self.run({})
        own, differs = Moved.of(seen), None
        if mujoco.__version__ == _SPARSE and is_sparse(self.model):
            dense = self.run({"jacobian": "dense"})
            differs = float(np.max(np.linalg.norm(dense.path - seen.path, axis=1)))
            if differs > _NUMERIC or dense.diverged != seen.diverged:
                self.base = {"jacobian": "dense"}
        exact, rests, lift = self._dry()
        expected = replace(Moved.of(exact), lift=lift)
        moved = _moved(own, expected, rests, self.watch.duration)
        if self.base and differs is not None:
            moved = tuple(dict.fromkeys((*moved, "sparse")))
        tried, change = self._mended(own, expected, rests) if moved else ([], None)
        text, proved = (None, False) if change is None else self._written(change)
        curves = {"own": seen, "dry friction": exact}
        if change is not None:
            curves["changed"] = self.run(change.options)
        columns = {}
        for name, one in curves.items():
            spun = np.cumsum(one.turning @ self.watch.normal) * float(self.model.opt.timestep)
            for what, values in (
                ("t", one.t),
                ("slid", one.slid),
                ("lifted", one.lifted),
                ("spun", spun - spun[one.half]),
            ):
                columns[f"{name}/{what}"] = values
        model = self.model
        return columns, {
            "version": mujoco.__version__,
            "body": model.body(self.body).name,
            "bearer": model.body(self.watch.bearer).name or "world",
            "bearers": [model.body(one).name or "world" for one in sorted(self.watch.bearers)],
            "start": (model.key(self.keyframe).name or "the first keyframe") if self.keyframe >= 0 else "",
            "step": float(model.opt.timestep),
            "integrator": INTEGRATORS[int(model.opt.integrator)],
            "duration": self.watch.duration,
            "options": self.options,
            "own": asdict(own),
            "expected": asdict(expected),
            "rests": rests,
            "moved": moved,
            "touches": [asdict(one) for one in seen.touches],
            "tried": [asdict(one) for one in tried],
            "change": None if change is None else asdict(change),
            "text": text,
            "proved": proved,
            "dense_differs": differs,
            "notes": self.notes,
        }

    def _dry(self) -> tuple[Seen, bool, float]:
        """The run that is nearest to dry friction, whether a body rests in it, and how far it may lift, m: one that
        slides jumps about, with each ratio otherwise.
        """
        soft = self.run({**_ELLIPTIC, "impratio": 1.0})
        runs = [self.run({**_ELLIPTIC, "impratio": ratio}) for ratio in _HARDER[:3]]
        sound = [one for one in (soft, *runs) if not Moved.of(one).failed and one.touching > 0.0]
        if sound:
            least, loose = (end(sound, key=lambda one: one.creep) for end in (min, max))
            if least.creep <= max(_HELD * loose.creep, CREEP):
                return least, True, least.lift
        # a motion: what a contact ten times as hard as what ships makes of it
        lift = max(one.lift for one in (soft, *runs))
        return next((one for one in runs if one.diverged is None), soft), False, lift

    def _mended(self, own: Moved, expected: Moved, rests: bool) -> tuple[list[Tried], Tried | None]:
        """What was tried, and the least change that mends it; else that which comes nearest, where it helps."""
        tried: list[Tried] = []
        duration, late = self.watch.duration, False
        first: list[dict[str, Any]] = [{}] if self.base else []
        for changed in first + _changes({**self.options, **self.base}):
            if time.process_time() - self.began > _BUDGET and self._key(changed) not in self.runs:
                late = True
                continue
            moved = Moved.of(self.run(changed))
            tried.append(Tried({**self.base, **changed}, moved, not _moved(moved, expected, rests, duration)))
            if tried[-1].mends:
                return tried, tried[-1]
        if late:
            self.notes.append(f"after {_BUDGET:.0f} s of a processor no further options were tried")
        sound = [one for one in tried if not one.moved.failed]
        off = [_distance(one, expected, rests, duration) for one in (own, *(one.moved for one in sound))]
        helps = len(off) > 1 and min(off[1:]) < 0.5 * off[0]
        return tried, sound[int(np.argmin(off[1:]))] if helps else None

    def _written(self, change: Tried) -> tuple[tuple[str, str] | None, bool]:
        """The file with a change, by its name, and whether that text does what was tried."""
        file, text = _with_option(self.path, {n: _said(v) for n, v in change.options.items()})
        model, _ = _compiled(self.path, {file.resolve(): text})
        again = Moved.of(watched(model, self.watch))
        same = math.isclose(again.creep, change.moved.creep, rel_tol=1e-6, abs_tol=1e-12)
        return (str(file), text), same and again.failed == change.moved.failed


def _said(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _body(path: Path, model: Any, name: str | None) -> int:
    """Number of a body. Raises InputError, with a line to try, for one that is not there or that cannot move."""
    held = {i for i in range(1, model.nbody) if model.body_weldid[i] == 0 or model.body_mocapid[i] >= 0}
    moving = [i for i in range(1, model.nbody) if i not in held and model.body(i).name]
    names = [str(model.body(i).name) for i in moving]
    free = [i for i in moving if model.body_dofnum[i] == 6]
    if not names:
        raise InputError(str(path), "no body with a name that moves", "a scene with one")
    if name is None and len(free) == 1:
        return free[0]
    if name in names:
        return moving[names.index(name)]
    likely = str(model.body(free[0]).name) if free else names[0]
    near = did_you_mean(name or "", names).removeprefix("; did you mean ").removesuffix("?") or likely
    what = "not given, and several move" if name is None else f"no body {name!r} that moves"
    raise InputError("--body", f"{what}; {path} has {', '.join(names)}", f"try: --body {near}")


def _with_option(path: Path, words: Mapping[str, str]) -> tuple[Path, str]:
    """The file of a model that has its <option>, the first where none has, and its text with these attributes.

    Of several the last that has one of the attributes, which the others would not change; else the first.
    """
    sources = with_included(path)
    found = [(one, tag) for one in sources for tag in tags(one.text) if tag.way in _OPTION]
    if found:
        source, tag = next((one for one in reversed(found) if words.keys() & one[1].attributes.keys()), found[0])
        return source.path, with_attributes(source.text, tag, words)
    text = sources[0].text
    first = next(tags(text))
    own = " ".join(f'{name}="{value}"' for name, value in words.items())
    return path, f"{text[: first.end]}\n  <option {own}/>{text[first.end :]}"


_OPTION = (("mujoco", "option"), ("mujocoinclude", "option"))


def _changes(options: Options) -> list[dict[str, Any]]:
    """Changes to try, the least first: a cone, a ratio of impedances, a solver that converges; noslip after those.

    impratio is no cure for a pyramid, whose friction is mixed with its normal force (MuJoCo's manual advises against).
    """
    effort = {n: v for n, v in _EFFORT.items() if options[n] != v and not (n != "solver" and options[n] > v)}
    solver: list[dict[str, Any]] = [{}, *({n: v} for n, v in effort.items()), *([effort] if len(effort) > 1 else [])]
    cone = {} if options["cone"] == "elliptic" else {"cone": "elliptic"}
    friction: list[dict[str, Any]] = [{}, cone] if cone else [{}]
    friction += [{**cone, "impratio": ratio} for ratio in _HARDER if ratio > options["impratio"]]
    if options["noslip_iterations"]:
        friction += [{**one, "noslip_iterations": 0} for one in friction]
    else:
        friction += [{**one, "noslip_iterations": _NOSLIP} for one in ({}, cone) if one is not cone or cone]
    every = [{**one, **other} for one in friction for other in solver if one or other]
    return sorted(every, key=lambda one: ("noslip_iterations" in one, len(one), one.get("impratio", 0.0)))


def _moved(own: Moved, expected: Moved, rests: bool, duration: float) -> tuple[str, ...]:
    """What of a motion dry friction would not do."""
    if own.diverged is not None:
        return ("diverges",)
    if own.lost is not None and expected.lost is None:
        return ("lets go",)
    found = []
    if rests:
        found += ["slide"] * (own.creep > CREEP or _further(own, expected, duration) > 1.0)
        found += ["spin"] * (abs(own.spin) - abs(expected.spin) > TURN)
        found += ["roll"] * (own.roll - expected.roll > TURN)
    else:
        found += ["motion"] * (_motion(own, expected, duration) > 1.0)
    found += ["lift"] * (own.lost is None and _lifted(own, expected) > 1.0)
    return tuple(found)


def _distance(own: Moved, expected: Moved, rests: bool, duration: float) -> float:
    """From what dry friction would do: above 1 it is told."""
    if own.failed and not expected.failed:
        return math.inf
    if rests:
        turned = max(abs(own.spin) - abs(expected.spin), own.roll - expected.roll)
        return max(own.creep / CREEP, turned / TURN, _further(own, expected, duration), _lifted(own, expected))
    return max(_motion(own, expected, duration), _lifted(own, expected) if own.lost is None else 0.0)


def _lifted(own: Moved, expected: Moved) -> float:
    return (own.lift - 1.5 * max(expected.lift, 0.0)) / LIFT


def _motion(own: Moved, expected: Moved, duration: float) -> float:
    """How far from a motion, over how far it may be; of a body that is let go, by when."""
    if expected.lost is not None or own.lost is not None:
        times = [duration if one.lost is None else one.lost for one in (own, expected)]
        return abs(times[0] - times[1]) / (_LEAVES * duration)
    off = abs(own.travel - expected.travel) / max(expected.travel, LIFT)
    if own.deceleration is not None and expected.deceleration is not None:
        braked = abs(own.deceleration - expected.deceleration) * duration
        off = max(off, braked * duration / max(expected.travel, LIFT))
    return off / _ALIKE


def _further(own: Moved, expected: Moved, duration: float) -> float:
    """How much further it came than dry friction lets it, over what counts as settling."""
    return (own.travel - expected.travel) / (GIVE + CREEP * duration + _SETTLED * expected.travel)
