"""The main job: one scenario in the exact reference and in every engine, measured and estimated."""

import logging
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from os import PathLike
from pathlib import Path

import numpy as np

from harness.app.run.case import Case, Given, ModelScenario, case_of, model_of
from harness.app.shared.estimates import estimates_of
from harness.app.shared.leaving import FILES, curves_of, leave, leaving
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.core import __version__
from harness.core.errors import InputError, SimulationError
from harness.core.scenario import FREE_DECAY, Scenario
from harness.core.trajectory import Source, Trajectory
from harness.engines import registry
from harness.engines.base import PRESETS, TUNED_DT, Preset, choice
from harness.exact.decay import rounded_up
from harness.fidelity import kind as suite
from harness.model.model import Model, Restoring
from harness.results.common import P
from harness.results.run import Metrics, RunResult, TraceResult
from harness.robot.own_model import OwnModel, is_own, own_model
from harness.show.numbers import heading, units_of
from harness.show.report.motion import run_scene
from harness.show.report.run import headline as said_of
from harness.show.report.run import metrics_shown, run_page
from harness.show.scene import notes_of

LOGGER = logging.getLogger(__name__)
MOST_SAMPLES, MOST_CYCLES = 20_000_000, 1_000_000


@dataclass(frozen=True, slots=True)
class RunOptions:
    """What to run.

    scenario : of the fidelity suite, or a model. engines : names. presets : as-shipped, tuned or both. dt : step of
    the tuned preset, interval of the reference, s.

    Raises InputError for an engine or preset that does not exist, dt not above 0, or a dt that nothing would use.
    """

    scenario: Scenario | ModelScenario = FREE_DECAY
    engines: tuple[str, ...] = field(default_factory=registry.usual)
    presets: tuple[str, ...] = PRESETS
    dt: float | None = None

    def __post_init__(self) -> None:
        registry.check_asked(self.engines, self.presets, self.dt)
        if self.dt is not None and "tuned" not in self.presets:
            accepted = "it goes with tuned: as shipped has its own"
            raise InputError("--dt", "given with --preset as-shipped", accepted)
        if self.scenario.duration / self.interval > MOST_SAMPLES:
            found = f"{self.scenario.duration / self.interval:.3g} samples"
            raise InputError("--duration", found, f"at most {MOST_SAMPLES} steps of --dt")
        cycles = max(self.scenario.duration, self.interval) * self.scenario.omega / math.pi
        if cycles > MOST_CYCLES:
            found = f"{cycles:.3g} half-cycles in {max(self.scenario.duration, self.interval):.3g} s"
            raise InputError("scenario", found, f"at most {MOST_CYCLES}")

    @classmethod
    def asked(
        cls,
        scenario: str | None = None,
        model: Given | None = None,
        restoring: str | None = None,
        given: Mapping[str, float | None] | None = None,
        engines: Sequence[str] | None = None,
        preset: str | None = None,
        dt: float | None = None,
    ) -> "RunOptions":
        """A scenario of the suite by name, a model in its place, or a free decay under a restoring force.

        scenario : None for the paper's case. given : m, c, k, f_k, f_s, x0, v0, duration in place of its own, None is
        not given. engines : None for the usual ones, MuJoCo and PyBullet. preset : None for both.
        Raises InputError for two of the three, for an unknown name (it lists those there are), and for values that are
        not taken or not physical.
        """
        given = given or {}
        what: Scenario | ModelScenario
        if restoring is not None:
            what = _held(restoring, model, scenario, given)
        elif model is not None:
            what = _of_model(model, scenario, given)
        else:
            what = suite.chosen(scenario or FREE_DECAY.name, given)
        presets: tuple[str, ...] = PRESETS if preset is None else (preset,)
        return cls(what, registry.usual() if engines is None else tuple(engines), presets, dt)

    @property
    def interval(self) -> float:
        """Interval of the reference's samples, s."""
        return TUNED_DT if self.dt is None else self.dt

    @property
    def plan(self) -> list[tuple[str, Preset]]:
        return registry.runs(self.engines, self.presets)


def _of_model(model: Given, scenario: str | None, given: Mapping[str, float | None]) -> ModelScenario:
    """A model in place of a scenario; an MJCF or a URDF does not say where its joint is let go: x0, v0 of ``given``."""
    if scenario is not None:
        raise InputError("--model", f"given with the scenario {scenario}", "one of the two")
    own = own_model(Path(model)) if isinstance(model, str | PathLike) and is_own(Path(model)) else None
    free = ("duration",) if own is None else ("duration", "x0", "v0")
    for name, value in given.items():
        if name not in free and value is not None:
            option = f"--{name.replace('_', '-')}"
            raise InputError("--model", f"given with {option} {value:g}", f"the model's own {name}")
    label = str(model) if isinstance(model, str | PathLike) else "model"
    if own is None:
        return ModelScenario.of(model_of(model), given.get("duration"), label)
    x0, v0 = given.get("x0"), given.get("v0")
    if not x0 and not v0:
        raise InputError(label, "it does not say where its joint is let go", f"try: {_release(own)}")
    released = replace(own.slider, x0=x0 or 0.0, v0=v0 or 0.0)
    return ModelScenario.of(released, given.get("duration"), label, own)


_SWINGS = 10.0
"""Friction's shift of the resting place, x_k, that a proposed release is away: five half-swings."""
_FREE = 0.1
"""The same without friction, m or rad."""


def _release(own: OwnModel) -> str:
    """Options that let a joint go from where it moves on."""
    slider = own.slider
    if slider.restoring is Restoring.NONE:
        return "--v0 1 --duration 3"
    x0 = rounded_up(own.slack + _SWINGS * slider.f_k / slider.k or _FREE)
    return f"--x0 {min(x0, 1.0) if slider.restoring is Restoring.PENDULUM else x0:g}"


def _held(
    restoring: str, model: Given | None, scenario: str | None, given: Mapping[str, float | None]
) -> Scenario | ModelScenario:
    """A free decay under a force: a spring's is the suite's; a pendulum is a model about a hinge, of k sin x."""
    choice("--restoring", restoring, ("spring", "pendulum"))
    if model is not None:
        label = model if isinstance(model, str | PathLike) else "model"
        raise InputError("--restoring", f"given with --model {label}", "the model's own")
    if scenario not in (None, FREE_DECAY.name):
        raise InputError("--restoring", f"given with the scenario {scenario}", f"{FREE_DECAY.name}")
    if restoring == "spring":
        return suite.chosen(FREE_DECAY.name, given)
    own = suite.chosen(FREE_DECAY.name, {name: value for name, value in given.items() if name != "duration"})
    pendulum = replace(Model.of_slider(own.slider, own.x0, own.v0), restoring=Restoring.PENDULUM)
    return replace(ModelScenario.of(pendulum, given.get("duration")), name="pendulum")


def run(options: RunOptions, out: Path | None = None, progress: Progress = SILENT, command: str = "") -> RunResult:
    """Run, measure, estimate, and leave result.json, trace.rrd, report.html, the models and the log in a folder.

    out : new or empty folder, None for reports/NAME-TIME here. command : the line that makes it again. An engine that
    cannot complete its run has the reason in its trace's ``error``, and the others go on. Raises StoreError when the
    folder cannot be written.
    """
    with leaving(options.scenario.name, out) as output:
        case = case_of(options.scenario)
        named = FILES | {"mjcf": f"model/{case.file_name}.xml", "urdf": f"model/{case.file_name}.urdf"}
        files = {name: output.at(file) for name, file in named.items()}
        result, trajectories = computed(options, progress, command, files)
        progress("writing model, trace and report", len(options.plan) + 1, len(options.plan) + 2)
        case.export(output.work / "model")
        said = notes_of("What differs, and why", result.conclusions)
        scene = run_scene(trajectories, result.scenario, result, said, output / named["urdf"])
        leave(output, result, run_page(result, trajectories), scene)
    return result


def computed(
    options: RunOptions, progress: Progress = SILENT, command: str = "", files: Mapping[str, str] | None = None
) -> tuple[RunResult, list[Trajectory]]:
    """Run, measure and estimate, and leave nothing; with the motions of what could be run, the reference first."""
    case = case_of(options.scenario)
    total = len(options.plan) + 2
    progress("exact reference", 0, total)
    reference = _reference(options, case)
    trajectories, traces = [reference], [measured(reference, case)]
    for done, (name, preset) in enumerate(options.plan, 1):
        progress(f"{name} {preset}", done, total)
        dt = options.dt if preset == "tuned" else None
        try:
            trajectory = case.simulated(registry.load(name), preset, dt)
        except SimulationError as error:
            LOGGER.warning("%s %s: %s", name, preset, error)
            nothing = {"samples": 0, "metrics": Metrics.of({}), "estimates": {}}
            source = Source(name, preset, dt=dt)
            traces.append(TraceResult.taken_from(source, source=name, dt_s=dt, error=str(error), **nothing))
            continue
        trajectories.append(trajectory)
        traces.append(measured(trajectory, case))
    result = RunResult(
        scenario=case.describe(),
        traces=traces,
        conclusions=case.conclusions(traces),
        command=command,
        machine=this_machine(),
        files=dict(files or {}),
    )
    curves = curves_of({one.source.label: one for one in trajectories})
    return result.drawn(partial(run_page, trajectories=trajectories), curves), trajectories


def _reference(options: RunOptions, case: Case) -> Trajectory:
    started = time.perf_counter()
    steps = round(options.scenario.duration / options.interval)
    exact = case.exact(np.arange(max(steps, 1) + 1, dtype=np.float64) * options.interval)
    own = {"sample_interval_s": options.interval}
    source = Source("reference", "exact", __version__, settings=own, wall_s=time.perf_counter() - started)
    return replace(exact, source=source)


def measured(trajectory: Trajectory, case: Case) -> TraceResult:
    """Metrics of a trajectory against the exact motion of ``case``, and every estimator's figures."""
    source = trajectory.source
    return TraceResult.taken_from(
        source,
        source=source.name,
        dt_s=source.dt,
        samples=len(trajectory),
        metrics=case.metrics(trajectory),
        # the estimators know free decays alone
        estimates=estimates_of(case.estimated(trajectory)) if case.decays else {},
    )


Lines = list[list[str]]


def headline(result: RunResult) -> str:
    """The answer in a sentence a preset."""
    return said_of([one for one in result.traces if not one.error], units_of(result.scenario))


def summary(result: RunResult) -> tuple[str, tuple[str, ...], Lines]:
    """What it shows, headings, and a line for every source."""
    if result.scenario.get("action") is None:
        turns = (result.scenario.get("model") or {}).get("restoring") == "pendulum"
        unit = "mrad" if turns else "mm"
        heads: tuple[str, ...] = (
            f"x_k {unit}", f"x_k at reversal {unit}", "zeta", f"error {unit}", f"creep {unit}/s", "stick s", "lead ms"
        )  # fmt: skip
        about = "x_k and zeta as the estimators read them; error, creep, rest and lead against the exact motion"
        return about, ("source", "step ms", *heads), [_line(trace, _decay) for trace in result.traces]
    shown = metrics_shown(result.traces, result.scenario)
    headings = [heading(metric) for metric in shown]

    def figures(trace: TraceResult) -> list[str]:
        found = trace.metrics.model_dump()
        return [_number(found.get(metric), one.factor) for metric, one in zip(shown, headings, strict=True)]

    heads = tuple(f"{one.head} {one.unit}".strip() for one in headings)
    about = "each figure beside that of the exact motion, which comes first"
    return about, ("source", "step ms", *heads), [_line(trace, figures) for trace in result.traces]


def _line(trace: TraceResult, figures: Callable[[TraceResult], list[str]]) -> list[str]:
    return (
        [trace.label, "failed"] if trace.error is not None else [trace.label, _number(trace.dt_s, 1e3), *figures(trace)]
    )


def _decay(trace: TraceResult) -> list[str]:
    guarded, local = trace.estimates.get("acceleration"), trace.estimates.get("acceleration-local")
    metrics = trace.metrics
    return [
        _estimate(guarded.x_k if guarded else None, 1e3),
        _estimate(local.x_k if local else None, 1e3),
        _estimate(guarded.zeta if guarded else None, 1.0),
        _number(metrics.max_error_m, 1e3),
        _number(metrics.creep_m_s, 1e3),
        _number(metrics.stick_time_s, 1.0),
        _number(metrics.reversal_lead_s, 1e3),
    ]


def _number(value: float | None, scale: float) -> str:
    return "-" if value is None else f"{value * scale:.4g}"


def _estimate(number: P | None, scale: float) -> str:
    return "-" if number is None else _number(number.value, scale)
