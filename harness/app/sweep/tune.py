"""Search of an engine's settings for fidelity at a cost."""

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.app.shared.machine import this_machine
from harness.app.shared.parts import only_joint
from harness.app.shared.progress import SILENT, Progress
from harness.core.checks import positive
from harness.core.errors import InputError, SimulationError
from harness.core.scenario import Harmonic
from harness.core.slider import Slider
from harness.engines import registry
from harness.engines.base import ROUTES, TUNED_DT, Route, choice
from harness.fidelity.kind import Sliders, names
from harness.fidelity.meet import METRICS, Goal, Meeting, meet
from harness.fidelity.paste import paste
from harness.fidelity.scores import COLUMNS, distance
from harness.fidelity.tune import HELD_OUT, SEARCH, Choice, Subject, Trial, score_of, search, space, tunable
from harness.io.units import parse_unit
from harness.results.sweep import SweepRow, TunedFigure, TunedGoal, TunedJoint, TunedRival, TuneResult
from harness.robot.arm import Arm, load_arm
from harness.robot.own_model import loosened, looseness, words
from harness.robot.paste import JointPaste
from harness.robot.reduction import Reduced, reduced

MUJOCO, PYBULLET = "mujoco", "pybullet"
SCENARIOS = ("free-decay", "hold-50", "hold-97", "harmonic")
"""What a joint without a law of its own for break-away does; no belt carries it."""
_SPRING = 4.0
"""Times dry friction a rad or m: the least spring under which a release of 1 turns round."""
_DRIVE = 3.0
"""Times dry friction, the size of a harmonic torque, at this share of the natural frequency:"""
_BELOW = 0.7
_BREAK_AWAY = 1.2
_TURN = 1.0
"""rad: the poses of the others that are tried, about the model's reference."""


def tune_joint(
    name: str,
    file: Path,
    joint: str | None = None,
    gravity: tuple[float, float, float] | None = None,
    dt: float | None = None,
    most: float | None = None,
    progress: Progress = SILENT,
    goals: Sequence[Goal] = (),
) -> TuneResult:
    """Search on the joint with the others in some poses, score in others; what ships is the model's file as it is.

    file : of a robot's model. gravity : m/s^2, None for its own. dt : s, None for the model's own. most, goals : as in
    ``tune``. Raises InputError as ``tune`` does, for a joint that there is not, and for one whose model has no dry
    friction.
    """
    arm = load_arm(file, gravity)
    joint = joint or only_joint(arm)
    at = arm.index(joint)
    f_k, c = float(arm.frictionloss[at]), float(arm.damping[at])
    if f_k == 0.0:
        accepted = "a joint with frictionloss (MJCF) or friction (URDF); harness diagnose --robot finds it"
        raise InputError(f"{file}: joint {joint}", "no dry friction: there is nothing to tune", accepted)
    poses = {number: _posed(arm, joint, number) for number in (*SEARCH, *HELD_OUT)}
    subject = Subject(lambda number: _sliders(poses[number], f_k, c), SCENARIOS)
    if name == MUJOCO:
        soft = looseness(arm, joint, reduced(arm, joint).moved)
        own = {key: value for key, value in words(arm, joint).items() if key != "dt"}
        subject = replace(subject, own=own, given=lambda settings: loosened(settings, soft))
    dt = float(arm.model.opt.timestep) if dt is None else dt
    result = tune(name, "joint", dt, most, progress, subject, goals)
    paste = JointPaste(joint, f_k, c, float(arm.armature[at]), dt)
    robot = TunedJoint(
        file=str(file.absolute()),
        joint=joint,
        inertia=[one.moved for one in poses.values()],
        gravity=[one.gravity for one in poses.values()],
    )
    return result.model_copy(update={"paste": _text(name, result, paste), "robot": robot})


def _posed(arm: Arm, joint: str, number: int) -> Reduced:
    """The joint with the others in a random pose, always the same for the same number."""
    random = np.random.default_rng([31, number])
    others = [other for other in arm.joints if other != joint]
    reference = dict(zip(arm.joints, arm.model.qpos0, strict=True))
    held = {other: float(reference[other] + random.uniform(-_TURN, _TURN)) for other in others if not arm.slides(other)}
    return reduced(arm, joint, held)


def _sliders(own: Reduced, f_k: float, c: float) -> Sliders:
    """The joint as the suite has sliders: gravity's torque, or what turns it round, is the spring."""
    decay = Slider(own.moved, c, max(own.gravity, _SPRING * f_k), f_k)
    driven = replace(decay, c=0.0)
    sticky = replace(driven, f_s=_BREAK_AWAY * f_k)
    drive = Harmonic(_DRIVE * f_k, _BELOW * driven.omega_n)
    return Sliders(decay, 1.0, sticky, (sticky.x_s - sticky.x_k) * sticky.omega_n, driven, drive, drive)


def _text(name: str, result: TuneResult, paste: JointPaste) -> str:
    """What to paste, the joint named."""
    text = result.paste.replace("<joint ", f'<joint name="{paste.joint}" ').replace(
        "on the joint that has frictionloss", "into the joint"
    )
    if name == PYBULLET:
        return "\n".join((text, *paste.calls))
    return text


EXPECTED = 150
"""Sets of settings a search usually scores: only progress depends on it."""


def tune(
    name: str,
    route: Route = "joint",
    dt: float | None = None,
    most: float | None = None,
    progress: Progress = SILENT,
    subject: Subject | None = None,
    goals: Sequence[Goal] = (),
) -> TuneResult:
    """Search on some random sliders, score on others.

    goals : the cheapest settings that meet them are searched in place of the best. subject : what to search on in place
    of sliders. dt : s, None for 1 ms. most : allowed cost, as wall time over that of
    what ships at the same step; None for any. Raises InputError for an engine, route or number that is not accepted.
    """
    registry.check(name)
    choice("--route", route, ROUTES)
    dt = TUNED_DT if dt is None else positive("--dt", dt, "s")
    if most is not None:
        positive("--max-cost", most)
    found = space(name.partition("@")[0], route)
    if found is None:
        raise InputError(f"engine {name}", f"no table of settings for the {route} route", f"{'; '.join(tunable())}")
    try:
        engine = registry.load(name)
    except SimulationError as error:
        reason = str(error).removeprefix(f"engine {name}: ")
        raise InputError(f"engine {name}", reason, "try: harness doctor") from None
    subject, defaults = subject or Subject(), engine.presets(route, "as-shipped", dt)
    found = found.of_file(subject.own, defaults)
    trial = Trial(engine, route, dt, subject)
    shipped = trial.rows({}, HELD_OUT)
    if math.isinf(score_of(shipped)):
        why = next(row.error for row in shipped if row.error is not None)
        raise InputError(f"--dt {dt:g}", f"what ships cannot run at this step ({why})", "a smaller step")

    def tell(done: int) -> None:
        progress("settings scored", done, max(done, EXPECTED))

    met = list[TunedGoal]()
    if goals:
        found = found.with_effort(defaults)
        effort = names(route, "trained") if "ls_iterations" in defaults else ()
        aside = Trial(engine, route, dt, replace(subject, scenarios=(*subject.scenarios, *effort)))
        meeting = Meeting(aside, found, goals)
        chosen = meet(meeting, tell=tell)
        met = _met(meeting, chosen)
        trial.count = aside.count
    else:
        chosen = search(trial, found, most, tell=tell)
    changed = trial.changed(found, chosen)
    tuned = trial.rows(changed, HELD_OUT)
    settings = defaults | dict(subject.own) | changed
    return TuneResult(
        engine=name,
        version=engine.version(),
        route=route,
        dt_s=dt,
        max_cost=most,
        changed=changed,
        settings=settings,
        paste=paste(engine.name, route, settings, changed),
        score_before=score_of(shipped),
        score_after=score_of(tuned),
        score_preset=trial.score({}, HELD_OUT, "tuned"),
        cost=trial.cost(changed),
        figures=_figures(shipped, tuned),
        searched=trial.count,
        sliders={"searched_on": list(SEARCH), "scored_on": list(HELD_OUT)},
        goals=met,
        seconds=trial.seconds(changed) if goals else None,
        machine=this_machine({"search": 0}),
    )


def cheapest(
    engines: Sequence[str],
    goals: Sequence[Goal],
    route: Route = "joint",
    dt: float | None = None,
    progress: Progress = SILENT,
) -> TuneResult:
    """Of the cheapest settings of each engine that meet the goals those that take the least wall time.

    ``rivals`` has all of them; where none meets the goals, the first that could be searched. Raises InputError where
    none could be.
    """
    rivals, found = list[TunedRival](), list[TuneResult]()
    for name in engines:
        registry.check(name)
        try:
            one = tune(name, route, dt, None, progress, goals=goals)
        except InputError as error:
            rivals.append(TunedRival(engine=name, version="", met=False, seconds=None, why=str(error)))
            continue
        found.append(one)
        met = all(each.met for each in one.goals)
        rivals.append(TunedRival(engine=name, version=one.version, met=met, seconds=one.seconds))
    if not found:
        raise InputError("engines", "; ".join(str(one.why) for one in rivals), f"{'; '.join(tunable())}")
    meets = [one for one in found if all(each.met for each in one.goals)]
    best = min(meets, key=lambda one: one.seconds or math.inf) if meets else found[0]
    return best.model_copy(update={"rivals": rivals})


_GOAL = re.compile(r"\s*(?P<name>\w+)\s*<\s*(?P<limit>[0-9.]+(?:[eE][-+]?[0-9]+)?)\s*(?P<unit>\S*)\s*")
_CHANNELS = {"m/s": "v", "m": "x", "s": "t"}


def goal(text: str) -> Goal:
    """From "creep<.01mm/s" or "zeta < 1%". SI where no unit stands.

    Raises InputError, about --meet, for what says no figure or limit, or has a unit of another kind.
    """
    found = _GOAL.fullmatch(text)
    accepted = "try: --meet 'creep<0.01mm/s'"
    if found is None:
        raise InputError("--meet", repr(text), accepted)
    if found["name"] not in METRICS:
        raise InputError("--meet", f"{found['name']!r} is none of the figures {', '.join(METRICS)}", accepted)
    unit = METRICS[found["name"]][1]
    if unit != "1":
        factor = parse_unit("--meet", _CHANNELS[unit], found["unit"] or None).factor
    elif found["unit"] in ("%", ""):
        factor = 0.01 if found["unit"] else 1.0
    else:
        raise InputError("--meet", f"{text!r} has the unit {found['unit']}", "a share, or %")
    return Goal(found["name"], positive("--meet", factor * float(found["limit"]), unit))


def _met(meeting: Meeting, chosen: Choice) -> list[TunedGoal]:
    """The goals on sliders that were not searched on."""
    before, after = (meeting.worst(choice, HELD_OUT) for choice in (meeting.space.shipped(), chosen))
    return [
        TunedGoal(
            name=goal.name,
            metric=goal.metric,
            limit=goal.limit,
            before=old if math.isfinite(old) else None,
            after=new if math.isfinite(new) else None,
            unit=goal.unit,
            met=new <= goal.limit,
        )
        for goal, old, new in zip(meeting.goals, before, after, strict=True)
    ]


def _figures(before: list[SweepRow], after: list[SweepRow]) -> list[TunedFigure]:
    found = []
    for scenario, figure in COLUMNS:
        means = []
        for rows in (before, after):
            values = [distance(row.model_dump(), figure) for row in rows if row.scenario == scenario]
            known = [value for value in values if value is not None]
            means.append(sum(known) / len(known) if known else None)
        if means != [None, None]:
            found.append(TunedFigure(name=figure.label, before=means[0], after=means[1]))
    return found
