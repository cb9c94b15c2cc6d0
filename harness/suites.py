"""What the commands of the engines' side do, for programs: run, sweep, regress, diff, tune, words, prove."""

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal, TypeAlias, TypeVar

from harness.core.errors import InputError
from harness.model.model import Model
from harness.results.common import ModelDocument, Paged
from harness.results.prove import ProofCheck, ProofResult
from harness.results.run import JointRunResult, RunResult
from harness.results.scene import SceneResult
from harness.results.sweep import DiffResult, RegressResult, SweepResult, TuneResult
from harness.results.words import WordsResult

File: TypeAlias = str | PathLike[str]
Route: TypeAlias = Literal["joint", "contact", "law"]
R = TypeVar("R", bound=Paged)


def kept(out: File | None, name: str, computed: Callable[[Path], R]) -> R:
    """What is computed into a folder: ``out``, or one called ``name`` that goes away, while the page is kept."""
    if out is not None:
        return computed(Path(out))
    with TemporaryDirectory(prefix="friction-harness-") as place:
        return computed(Path(place) / name).model_copy(update={"files": {}})


Patterns: TypeAlias = Sequence[str] | None


def _patterns(only: Patterns, skip: Patterns, xfail: Patterns = None) -> dict[str, Any]:
    """Patterns of rows, as options take them."""
    return {name: tuple(given or ()) for name, given in (("only", only), ("skip", skip), ("xfail", xfail))}


def run(
    scenario: str | None = None,
    *,
    model: Model | ModelDocument | Mapping[str, Any] | File | None = None,
    m: float | None = None,
    c: float | None = None,
    k: float | None = None,
    f_k: float | None = None,
    f_s: float | None = None,
    x0: float | None = None,
    v0: float | None = None,
    duration: float | None = None,
    engines: Sequence[str] | None = None,
    preset: str | None = None,
    dt: float | None = None,
    restoring: str | None = None,
    out: File | None = None,
) -> RunResult:
    """One scenario, or one model, in the exact reference and in engines, each as shipped and tuned, with estimators.

    scenario : of the fidelity suite, None for "free-decay"; m (kg), c (N s/m), k (N/m), f_k, f_s (N), x0 (m), v0 (m/s)
    and duration (s) take the place of its own. model : in place of a scenario, with ``duration`` alone. engines : ()
    for the reference alone, None for MuJoCo and PyBullet. preset : "as-shipped" or "tuned", None for both. dt : step of
    the tuned preset, s. restoring : "spring" or "pendulum", of a free decay. out : folder for result, report, trace and
    models, as the command leaves them.

    Raises InputError for values that are not accepted, StoreError when ``out`` cannot be written. An engine that cannot
    complete its run has the reason in its trace's ``error``.
    """
    from harness.app.run.run import RunOptions, computed
    from harness.app.run.run import run as deliver

    given = {"m": m, "c": c, "k": k, "f_k": f_k, "f_s": f_s, "x0": x0, "v0": v0, "duration": duration}
    options = RunOptions.asked(scenario, model, restoring, given, engines, preset, dt)
    return computed(options)[0] if out is None else deliver(options, Path(out))


def run_joint(
    robot: File,
    joint: str | None = None,
    *,
    gravity: tuple[float, float, float] | None = None,
    engines: Sequence[str] | None = None,
    preset: str | None = None,
    dt: float | None = None,
    out: File | None = None,
) -> JointRunResult:
    """What engines make of a joint of a robot's model as it is: creep, lead, the false damping of its servo.

    robot, joint, gravity, out : as in ``diagnose_joint``. engines, preset, dt : as in ``run``. Raises InputError,
    StoreError.
    """
    from harness.app.run.joint import JointRun
    from harness.app.run.joint import run_joint as computed

    asked = JointRun(Path(robot), joint, gravity, tuple(engines or ()), () if preset is None else (preset,), dt)
    return kept(out, "joint", lambda folder: computed(asked, folder))


def run_scene(
    scene: File, body: str | None = None, *, duration: float | None = None, out: File | None = None
) -> SceneResult:
    """A body of a scene under its own options in MuJoCo: creep, lift and drift against dry friction, and what mends it.

    scene : MJCF. body : None for the only free one. duration : s, of which the later half is measured; None for two.
    out : as in ``run``. Raises InputError, StoreError.
    """
    from harness.app.run.scene import SceneRun
    from harness.app.run.scene import run_scene as computed

    asked = SceneRun(Path(scene), body, duration)
    return kept(out, "scene", lambda folder: computed(asked, folder))


def sweep(
    *,
    engines: Sequence[str] | None = None,
    routes: Sequence[Route] | None = None,
    presets: Sequence[str] | None = None,
    steps: Sequence[float] | None = None,
    only: Sequence[str] | None = None,
    skip: Sequence[str] | None = None,
    sliders: int = 0,
    short: bool = False,
    keep: int | None = None,
    jobs: int | None = None,
    out: File | None = None,
) -> SweepResult:
    """The friction-fidelity matrix: every engine, route, setting, step and scenario against exact answers.

    engines, routes, presets, steps (s) : None for all there are. only, skip : patterns of rows' names. sliders : random
    ones besides. short : what ships and what is tuned, at one step each. keep : how many of the worst rows are kept
    as traces, with ``out``. jobs : processes, None for one a core. out : folder for rows, result, page and traces.
    Raises InputError, StoreError.
    """
    from harness.app.sweep.report import finish
    from harness.app.sweep.sweep import SweepOptions
    from harness.app.sweep.sweep import sweep as computed

    options = SweepOptions(
        tuple(engines or ()),
        tuple(routes or ()),
        tuple(presets or ()),
        tuple(steps or ()),
        short,
        sliders,
        jobs,
        keep=keep or 0,
        **_patterns(only, skip),
    )

    def all_of_it(folder: Path) -> SweepResult:
        found = computed(options, folder)
        page = finish(found, options)
        return SweepResult.model_validate_json("".join(found.json())).drawn(page)

    return kept(out, "sweep", all_of_it)


def regress(
    baseline: File | None = None,
    *,
    traces: File | None = None,
    update: bool = False,
    engines: Sequence[str] | None = None,
    routes: Sequence[Route] | None = None,
    only: Sequence[str] | None = None,
    skip: Sequence[str] | None = None,
    xfail: Sequence[str] | None = None,
    short: bool = False,
    jobs: int | None = None,
) -> RegressResult:
    """A sweep against a baseline: what moved, and whether that is a regression (``result.regressions``).

    baseline : file of rows. traces : folder of a sweep's .rrd files, from which rows are computed again without any
    engine; without a baseline they must be the stored ones to the last bit. update : write the rows to the baseline
    first. xfail : patterns of rows that are known to fail, "PATTERN: why". The rest as in ``sweep``. Raises
    InputError, StoreError.
    """
    from harness.app.sweep import regress as room
    from harness.app.sweep.sweep import SweepOptions

    patterns = _patterns(only, skip, xfail)
    options = SweepOptions(tuple(engines or ()), tuple(routes or ()), short=short, jobs=jobs, **patterns)
    if traces is not None and not update:
        return room.compared_traces(Path(traces), None if baseline is None else Path(baseline), options.rows)
    if baseline is None or traces is not None:
        raise InputError("regress", "no baseline to compare with", "a baseline, or traces without update")
    rows = room.fresh_rows(options)
    if update:
        room.update(Path(baseline), rows, options)
    return room.compared(Path(baseline), rows, options)


def diff(
    a: File,
    b: File,
    *,
    baseline: File | None = None,
    routes: Sequence[Route] | None = None,
    only: Sequence[str] | None = None,
    skip: Sequence[str] | None = None,
    xfail: Sequence[str] | None = None,
    short: bool = False,
    jobs: int | None = None,
    out: File | None = None,
) -> DiffResult:
    """What moved from one engine, version, interpreter or sweep to another, beyond the tolerance of its metric.

    a, b : "NAME", "NAME@VERSION", "NAME@PYTHON", or the folder or result.json of a sweep. baseline : has the rows of
    NAME@VERSION. out : folder for result and page. The rest as in ``regress``. Raises InputError for what is none of
    these, StoreError.
    """
    from harness.app.sweep.diff import diff as computed
    from harness.app.sweep.sweep import SweepOptions

    options = SweepOptions((), tuple(routes or ()), short=short, jobs=jobs, **_patterns(only, skip, xfail))
    held = None if baseline is None else Path(baseline)
    return kept(out, "diff", lambda folder: computed(str(a), str(b), options, held, folder))


def tune(
    engine: str | Sequence[str],
    *,
    route: Route | None = None,
    dt: float | None = None,
    max_cost: float | None = None,
    meet: Sequence[str] | None = None,
    robot: File | None = None,
    joint: str | None = None,
    gravity: tuple[float, float, float] | None = None,
) -> TuneResult:
    """Search an engine's settings for fidelity at a cost; ``result.paste`` is what to paste.

    route : None for "joint". dt : step, s, None for 1 ms or the robot's own. max_cost : wall time over that of what
    ships. meet : goals such as "creep<0.01mm/s", for the cheapest settings that meet them (``result.goals``), and of
    several engines the one that takes the least time (``result.rivals``). robot, joint, gravity : on a joint of a
    robot's model; the route is then joint. Raises InputError.
    """
    from harness.app.sweep.tune import cheapest, goal, tune_joint
    from harness.app.sweep.tune import tune as of_sliders

    if robot is not None and route not in (None, "joint"):
        raise InputError("route", f"{route}, given with robot", "joint")
    goals = [goal(text) for text in meet or ()]
    if not isinstance(engine, str):
        if robot is not None or max_cost is not None or not goals:
            raise InputError("engine", "several", "one engine, or several with meet alone")
        return cheapest(engine, goals, route or "joint", dt)
    if robot is None:
        return of_sliders(engine, route or "joint", dt, max_cost, goals=goals)
    return tune_joint(engine, Path(robot), joint, gravity, dt, max_cost, goals=goals)


def words(file: File, *, engines: Sequence[str] | None = None, out: File | None = None) -> WordsResult:
    """Which words of friction, damping, armature and servos a model's file has, and what readers make of them.

    file : MJCF, URDF, SDF or USD as text. engines : readers to look at, None for all. out : folder for result and
    page. Raises InputError, StoreError.
    """
    from harness.app.words import words as computed

    return computed(Path(file), engines or (), None if out is None else Path(out))


def prove(
    *,
    singles: int | None = None,
    controls: int | None = None,
    pairs: int | None = None,
    outside: int | None = None,
    machines: bool = False,
    paths: int | None = None,
    real: int | None = None,
    folder: File | None = None,
    short: bool = False,
    resume: bool = False,
    jobs: int | None = None,
    out: File | None = None,
) -> ProofResult:
    """The sealed blind proof of the diagnosis.

    out : folder, which anybody can verify; None for none. singles, controls, pairs, outside : recordings of each group,
    None for the full number. machines : recordings of machines instead. paths : so many on every way that gives a
    verdict instead. real : so many exact effects on the recordings of real machines in ``folder`` instead.
    short : few in all, no evidence. resume : go on with what the folder holds. jobs : processes, None for one a core.
    Raises InputError, StoreError.
    """
    from harness.app.prove.prove import ProveOptions
    from harness.app.prove.prove import prove as computed

    sizes = {"singles": singles, "controls": controls, "pairs": pairs, "outside": outside}
    given = {name: value for name, value in sizes.items() if value is not None}
    options = ProveOptions.chosen(
        given,
        short,
        machines,
        paths or 0,
        real or 0,
        jobs=jobs,
        resume=resume,
        folder=None if folder is None else Path(folder),
    )
    return kept(out, "proof", lambda place: computed(options, place))


def verify_proof(
    folder: File, *, short: bool = False, jobs: int | None = None, source: File | None = None
) -> ProofCheck:
    """A published proof computed again; ``result.accepted``, and ``result.wrong`` names what was changed.

    short : draw a sample of the recordings again and not all. source : folder of the recordings of real machines,
    without which what was made from them is not drawn again. Raises InputError for a folder that holds none.
    """
    from harness.app.prove.verify import verify_proof as computed

    return computed(Path(folder), short, jobs, source=None if source is None else Path(source))
