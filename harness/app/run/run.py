"""The main job: one scenario in the exact reference and in every engine, measured and estimated."""

import logging
import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path

import numpy as np

from harness.app.run.case import Case, ModelScenario, case_of
from harness.app.run.simulate import Given, model_of
from harness.app.shared.deliver import to_json
from harness.app.shared.estimates import estimates_of
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import NAME as LOG
from harness.app.shared.progress import SILENT, Progress, journal
from harness.app.shared.showing import write_run_page, write_run_trace
from harness.core import __version__
from harness.core.checks import positive
from harness.core.errors import InputError, SimulationError
from harness.core.scenario import FREE_DECAY, Scenario
from harness.core.trajectory import Source, Trajectory
from harness.engines import registry
from harness.engines.base import PRESETS, TUNED_DT, Preset, choice
from harness.fidelity import kind as suite
from harness.io.store import OutputFolder, output_folder
from harness.model.model import Model, Restoring
from harness.results.run import Metrics, RunResult, TraceResult
from harness.robot.own_model import is_own, own_model

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
        if self.dt is not None:
            positive("--dt", self.dt, "s")
            if "tuned" not in self.presets:
                raise InputError(
                    "--dt", "given with --preset as-shipped", "it is accepted with tuned: as shipped has its own"
                )
        for preset in self.presets:
            choice("--preset", preset, PRESETS)
        for name in self.engines:
            registry.check(name, "--engine")
        if self.scenario.duration / self.interval > MOST_SAMPLES:
            found = f"{self.scenario.duration / self.interval:.3g} samples"
            raise InputError("--duration", found, f"at most {MOST_SAMPLES} steps of --dt are accepted")
        cycles = max(self.scenario.duration, self.interval) * self.scenario.omega / math.pi
        if cycles > MOST_CYCLES:
            found = f"{cycles:.3g} half-cycles in {max(self.scenario.duration, self.interval):.3g} s"
            raise InputError("scenario", found, f"at most {MOST_CYCLES} are accepted")

    @classmethod
    def chosen(
        cls, scenario: Scenario | ModelScenario, engines: Sequence[str] | None, preset: str | None, dt: float | None
    ) -> "RunOptions":
        """As somebody chose: engines None means the usual ones, MuJoCo and PyBullet, preset None means both."""
        presets: tuple[str, ...] = PRESETS if preset is None else (preset,)
        return cls(scenario, registry.usual() if engines is None else tuple(engines), presets, dt)

    @classmethod
    def named(
        cls,
        name: str | None,
        given: Mapping[str, float | None],
        engines: Sequence[str] | None = None,
        preset: str | None = None,
        dt: float | None = None,
    ) -> "RunOptions":
        """A scenario of the suite by name, None for the paper's case, with the values given in place of its own.

        given : m, c, k, f_k, f_s, x0, v0, duration; None is not given. Raises InputError for an unknown name (it lists
        those there are), and for values that the scenario does not take or that are not physical.
        """
        return cls.chosen(suite.chosen(name or FREE_DECAY.name, given), engines, preset, dt)

    @classmethod
    def of_model(
        cls,
        model: Given,
        scenario: str | None,
        given: Mapping[str, float | None],
        engines: Sequence[str] | None = None,
        preset: str | None = None,
        dt: float | None = None,
    ) -> "RunOptions":
        """A model in place of a scenario; raises InputError for anything given beside it that the model says itself.

        An MJCF or a URDF does not say where its joint is let go: x0, v0 of ``given``.
        """
        if scenario is not None:
            raise InputError("--model", f"given with the scenario {scenario}", "one of the two is accepted")
        own = own_model(Path(model)) if isinstance(model, str | PathLike) and is_own(Path(model)) else None
        free = ("duration",) if own is None else ("duration", "x0", "v0")
        for name, value in given.items():
            if name not in free and value is not None:
                option = f"--{name.replace('_', '-')}"
                raise InputError("--model", f"given with {option} {value:g}", f"the model's own {name} is accepted")
        label = str(model) if isinstance(model, str | PathLike) else "model"
        if own is None:
            return cls.chosen(ModelScenario.of(model_of(model), given.get("duration"), label), engines, preset, dt)
        x0, v0 = given.get("x0"), given.get("v0")
        if not x0 and not v0:
            raise InputError(label, "it does not say where its joint is let go", "--x0 or --v0 is needed with it")
        released = replace(own.slider, x0=x0 or 0.0, v0=v0 or 0.0)
        return cls.chosen(ModelScenario.of(released, given.get("duration"), label, own), engines, preset, dt)

    @classmethod
    def held(
        cls,
        restoring: str,
        model: Given | None,
        scenario: str | None,
        given: Mapping[str, float | None],
        engines: Sequence[str] | None = None,
        preset: str | None = None,
        dt: float | None = None,
    ) -> "RunOptions":
        """A free decay under the restoring force that was named: a spring's is the suite's, a pendulum's a model.

        A pendulum has inertia, damping and friction about its hinge, k sin x, and exact events by the integrator.
        Raises InputError for another word, and for a model or a scenario beside it that says this itself.
        """
        choice("--restoring", restoring, ("spring", "pendulum"))
        if model is not None:
            label = model if isinstance(model, str | PathLike) else "model"
            raise InputError("--restoring", f"given with --model {label}", "the model's own is accepted")
        if scenario not in (None, FREE_DECAY.name):
            raise InputError("--restoring", f"given with the scenario {scenario}", f"{FREE_DECAY.name} is accepted")
        if restoring == "spring":
            return cls.named(scenario, given, engines, preset, dt)
        own = suite.chosen(FREE_DECAY.name, {name: value for name, value in given.items() if name != "duration"})
        pendulum = replace(Model.of_slider(own.slider, own.x0, own.v0), restoring=Restoring.PENDULUM)
        return cls.chosen(
            replace(ModelScenario.of(pendulum, given.get("duration")), name="pendulum"), engines, preset, dt
        )

    @classmethod
    def asked(
        cls,
        scenario: str | None,
        model: Given | None,
        restoring: str | None,
        given: Mapping[str, float | None],
        engines: Sequence[str] | None = None,
        preset: str | None = None,
        dt: float | None = None,
    ) -> "RunOptions":
        """A scenario by name, a model, or a free decay under a restoring force; raises InputError for two of them."""
        if restoring is not None:
            return cls.held(restoring, model, scenario, given, engines, preset, dt)
        if model is None:
            return cls.named(scenario, given, engines, preset, dt)
        return cls.of_model(model, scenario, given, engines, preset, dt)

    @property
    def interval(self) -> float:
        """Interval of the reference's samples, s."""
        return TUNED_DT if self.dt is None else self.dt

    @property
    def plan(self) -> list[tuple[str, Preset]]:
        """Engine and preset of every run; an engine that is asked for twice is run once."""
        return [(name, preset) for name in dict.fromkeys(self.engines) for preset in PRESETS if preset in self.presets]


def run(options: RunOptions, out: Path | None = None, progress: Progress = SILENT, command: str = "") -> RunResult:
    """Run, measure, estimate, and leave result.json, trace.rrd, report.html, the models and the log in a folder.

    out : new or empty folder, None for reports/NAME-TIME here. command : the line that makes it again. An engine that
    cannot complete its run has the reason in its trace's ``error``, and the others go on. Raises StoreError when the
    folder cannot be written.
    """
    with output_folder(options.scenario.name, out) as output, journal(output / LOG):
        case = case_of(options.scenario)
        result, trajectories = computed(options, progress, command, _files(output, case.file_name))
        progress("writing model, trace and report", len(options.plan) + 1, len(options.plan) + 2)
        case.export(output.work / "model")
        (output / "result.json").write_text(to_json(result), encoding="utf-8")
        write_run_trace(output / "trace.rrd", result, trajectories, output / "model" / f"{case.file_name}.urdf")
        write_run_page(output / "report.html", result, trajectories)
        output.commit()
    return result


def computed(
    options: RunOptions, progress: Progress = SILENT, command: str = "", files: Mapping[str, str] | None = None
) -> tuple[RunResult, list[Trajectory]]:
    """Run, measure and estimate, and leave nothing; with the motions of what could be run, the reference first."""
    case = case_of(options.scenario)
    trajectories, traces = _all_traces(options, case, progress)
    result = RunResult(
        scenario=case.describe(),
        traces=traces,
        conclusions=case.conclusions(traces),
        command=command,
        machine=this_machine(),
        files=dict(files or {}),
    )
    return result, trajectories


def _files(output: OutputFolder, model: str) -> dict[str, str]:
    named = {"result": "result.json", "report": "report.html", "rrd": "trace.rrd", "log": LOG}
    named |= {"mjcf": f"model/{model}.xml", "urdf": f"model/{model}.urdf"}
    return {name: output.at(file) for name, file in named.items()}


def _all_traces(options: RunOptions, case: Case, progress: Progress) -> tuple[list[Trajectory], list[TraceResult]]:
    """The reference first, then the engines; those that could not be run have a result but no trajectory."""
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
            traces.append(_failed(name, preset, dt, str(error)))
            continue
        trajectories.append(trajectory)
        traces.append(measured(trajectory, case))
    return trajectories, traces


def _reference(options: RunOptions, case: Case) -> Trajectory:
    started = time.perf_counter()
    steps = round(options.scenario.duration / options.interval)
    exact = case.exact(np.arange(max(steps, 1) + 1, dtype=np.float64) * options.interval)
    source = Source(
        "reference",
        "exact",
        __version__,
        settings={"sample_interval_s": options.interval},
        wall_s=time.perf_counter() - started,
    )
    return replace(exact, source=source)


def measured(trajectory: Trajectory, case: Case) -> TraceResult:
    """Metrics of a trajectory against the exact motion of ``case``, and every estimator's figures."""
    source = trajectory.source
    return TraceResult(
        source=source.name,
        preset=source.preset,
        version=source.version,
        settings={name: list(v) if isinstance(v, tuple) else v for name, v in source.settings.items()},
        ignored=list(source.ignored),
        dt_s=source.dt,
        wall_s=source.wall_s,
        samples=len(trajectory),
        metrics=case.metrics(trajectory),
        # the estimators know free decays alone
        estimates=estimates_of(case.estimated(trajectory)) if case.decays else {},
    )


def _failed(name: str, preset: Preset, dt: float | None, error: str) -> TraceResult:
    return TraceResult(
        source=name,
        preset=preset,
        version="",
        settings={},
        ignored=[],
        dt_s=dt,
        wall_s=None,
        samples=0,
        metrics=Metrics.of({}),
        estimates={},
        error=error,
    )
