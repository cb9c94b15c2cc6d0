"""One row of the matrix: engine, route, settings, step and scenario in; metrics, or the reason why not, out.

A row also says whether the engine repeats itself: from run to run, from world to world of a batch, device to device.
"""

import hashlib
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from harness.core.errors import HarnessError, InputError, NoDeviceError
from harness.core.scenario import Belt, Body, CurveBelt, Harmonic, Hold, Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Trajectory
from harness.engines.base import PRESETS, Engine, Preset, Route, Task
from harness.fidelity.kind import Metrics, kind_of
from harness.fidelity.metrics import measure_contact, recovered
from harness.results.sweep import SweepRow

SCENARIO = "free-decay"
"""Whose rows, as shipped and tuned, are run again."""
WORLDS = 16
DEVICES = ("cpu", "gpu")


@dataclass(frozen=True, slots=True)
class Repeated:
    """apart_m : largest difference of position, 0 the same to the last bit. failed : why it did not run again.

    Both by runs (another run), worlds (between as many of one batch, where the engine has batches), devices (the other
    device, where the engine has a choice and the machine has both).
    """

    apart_m: dict[str, float]
    failed: dict[str, str]


def repeats(engine: Engine, task: Task, first: Trajectory) -> Repeated:
    """The task of ``first`` once more."""
    device = first.source.settings.get("device")
    ways: dict[str, Callable[[], Sequence[Trajectory | HarnessError]]] = {"runs": lambda: [engine.simulate(task)]}
    if engine.batches:
        ways["worlds"] = lambda: engine.simulate_all([task] * WORLDS)
    if device is not None:
        other = next(one for one in DEVICES if one != device)
        ways["devices"] = lambda: [engine.simulate(replace(task, settings={**task.settings, "device": other}))]
    found = Repeated({}, {})
    for way, run in ways.items():
        try:
            again = [_run(one) for one in run()]
            found.apart_m[way] = _far(again[0] if way == "worlds" else first, again)
        except NoDeviceError:
            pass
        except HarnessError as error:
            found.failed[way] = str(error)
    return found


def _run(one: Trajectory | HarnessError) -> Trajectory:
    if isinstance(one, HarnessError):
        raise one
    return one


def _far(one: Trajectory, others: Sequence[Trajectory]) -> float:
    return max(float(np.max(np.abs(one.x - other.x))) for other in others)


def describe(scenario: Scenario) -> dict[str, Any]:
    """A scenario as plain data; ``scenario_of`` turns it back."""
    slider, action = scenario.slider, scenario.action
    return {
        "name": scenario.name,
        "slider": {"m": slider.m, "c": slider.c, "k": slider.k, "f_k": slider.f_k, "f_s": slider.break_away},
        "release": {"x0": scenario.x0, "v0": scenario.v0},
        "duration_s": scenario.duration,
        "action": None if action is None else {"kind": type(action).__name__, **asdict(action)},
    }


_ACTIONS: dict[str, type[Harmonic | Hold | Belt | Body]] = {
    kind.__name__: kind for kind in (Harmonic, Hold, Belt, CurveBelt, Body)
}


def scenario_of(data: Mapping[str, Any]) -> Scenario:
    """The scenario that ``describe`` made this from; raises InputError when something is missing."""
    try:
        release, acting = data["release"], data.get("action")
        action = (
            None if acting is None else _ACTIONS[acting["kind"]](**{k: v for k, v in acting.items() if k != "kind"})
        )
        slider = Slider(**data["slider"])
        return Scenario(str(data["name"]), slider, release["x0"], release["v0"], data["duration_s"], action)
    except (KeyError, TypeError) as error:
        raise InputError("scenario", f"incomplete ({error})", "a trace or row written by harness sweep") from None


@dataclass(frozen=True, slots=True)
class Spec:
    """What one row runs.

    engine : as registry.load takes it, NAME or NAME@PYTHON. version, place : of the engine. preset : name of the
    settings in tables ("as-shipped", "tuned", "stiff", ...). base : the engine's preset that ``changed`` overrides,
    name by name. dt : s, None for the preset's own step. draw : 0 for the sliders of the suite itself, else the number
    of the random ones.
    """

    engine: str
    version: str
    route: Route
    preset: str
    base: Preset
    changed: tuple[tuple[str, Any], ...]
    dt: float | None
    scenario: Scenario
    draw: int = 0
    place: str = ""

    @property
    def name(self) -> str:
        """The row for people and for baselines."""
        changed = ",".join(f"{name}={_short(value)}" for name, value in self.changed)
        step = "own" if self.dt is None else f"{self.dt:g}"
        slider = f"slider-{self.draw}" if self.draw else ""
        parts = (self.label, self.route, self.preset, changed, f"dt={step}", self.scenario.name, slider)
        return "/".join(filter(None, parts))

    @property
    def label(self) -> str:
        """Engine, version and place, which a name begins with; as Engine.label."""
        return f"{self.engine.partition('@')[0]}@{self.version}" + (f"({self.place})" if self.place else "")

    @property
    def repeats(self) -> bool:
        """Whether it is run again: one scenario as each engine ships and tuned is enough, since a run costs as much."""
        return self.scenario.name == SCENARIO and self.preset in PRESETS and not (self.changed or self.draw)

    @property
    def key(self) -> str:
        """The same for the same inputs and versions, whatever the process: 16 hex digits."""
        about = [
            self.name,
            self.version,
            self.base,
            [[n, v] for n, v in self.changed],
            self.dt,
            describe(self.scenario),
        ]
        return hashlib.sha256(json.dumps(about, sort_keys=True).encode()).hexdigest()[:16]


@dataclass(frozen=True, slots=True)
class Bundle:
    """Rows of one engine that are run at once."""

    specs: tuple[Spec, ...]

    @property
    def key(self) -> str:
        return self.specs[0].key


def run_rows(engine: Engine, specs: Sequence[Spec]) -> list[SweepRow]:
    """Simulate at once and measure; whatever goes wrong becomes the ``error`` of a row."""
    tasks = [task(engine, spec) for spec in specs]
    try:
        traces = engine.simulate_all(tasks)
    except Exception as error:  # one bundle never stops the others
        return [failed(spec, _reason(error)) for spec in specs]
    return [_measured(engine, *each) for each in zip(specs, tasks, traces, strict=True)]


def run_row(engine: Engine, spec: Spec) -> SweepRow:
    """The same for one."""
    return run_rows(engine, [spec])[0]


def _measured(engine: Engine, spec: Spec, asked: Task, trace: Trajectory | HarnessError) -> SweepRow:
    if isinstance(trace, HarnessError):
        return failed(spec, _reason(trace))
    try:
        again = repeats(engine, asked, trace) if spec.repeats else None
        return succeeded(spec, trace, measure_row(trace, spec.scenario), again)
    except Exception as error:  # one row never stops the others
        return failed(spec, _reason(error))


def _reason(error: Exception) -> str:
    return str(error) if isinstance(error, HarnessError) else f"internal error, {type(error).__name__}: {error}"


def task(engine: Engine, spec: Spec) -> Task:
    return engine.task(spec.scenario, spec.route, spec.base, spec.dt, dict(spec.changed))


def measure_row(trace: Trajectory, scenario: Scenario) -> Metrics:
    """Every metric that the scenario and the trace have, what the estimators read from a free decay among them."""
    found = kind_of(scenario).measure(trace, scenario)
    if scenario.action is None:
        found |= recovered(trace, scenario)
    found |= measure_contact(trace, scenario.slider)
    return {name: value if value is None or math.isfinite(value) else None for name, value in found.items()}


def succeeded(spec: Spec, trace: Trajectory, metrics: Metrics, again: Repeated | None = None) -> SweepRow:
    source = trace.source
    wall = source.wall_s
    return SweepRow(
        **_identity(spec),
        settings={name: _plain(value) for name, value in source.settings.items()},
        ignored=list(source.ignored),
        integrator=integrator(source.settings),
        effort=effort(source.settings) if spec.route != "law" else None,
        apart_m=(again and again.apart_m) or None,
        not_again=(again and again.failed) or None,
        dt_s=source.dt,
        metrics=metrics,
        exact=kind_of(spec.scenario).answers(spec.scenario),
        samples=len(trace),
        wall_s=wall,
        steps_per_s=(len(trace) - 1) / wall if wall else None,
        error=None,
    )


def failed(spec: Spec, reason: str) -> SweepRow:
    changed = dict(spec.changed)
    return SweepRow(
        **_identity(spec),
        settings={name: _plain(value) for name, value in changed.items()},
        ignored=[],
        integrator=integrator(changed) if changed else "",
        dt_s=spec.dt,
        metrics={},
        exact={},
        samples=0,
        wall_s=None,
        steps_per_s=None,
        error=" ".join(reason.split()),
    )


def _identity(spec: Spec) -> dict[str, Any]:
    slider = spec.scenario.slider
    return {
        "key": spec.key,
        "name": spec.name,
        "engine": spec.engine.partition("@")[0],
        "version": spec.version,
        "environment": spec.place,
        "route": spec.route,
        "preset": spec.preset,
        "changed": {name: _plain(value) for name, value in spec.changed},
        "scenario": spec.scenario.name,
        "slider": {"m": slider.m, "c": slider.c, "k": slider.k, "f_k": slider.f_k, "f_s": slider.break_away},
        "setup": describe(spec.scenario),
        "draw": spec.draw,
    }


def integrator(settings: Mapping[str, Any]) -> str:
    """Name of the scheme that moves the slider; engines that have one only are read by how their step is taken."""
    if "integrator" in settings:
        return str(settings["integrator"])
    if settings.get("own_spring"):
        return "implicit Euler"
    return "leapfrog" if settings.get("leapfrog") else "semi-implicit Euler"


def effort(settings: Mapping[str, Any]) -> dict[str, int] | None:
    """Iterations of the solver and of its line search; None for an engine that has not both."""
    names = ("iterations", "ls_iterations")
    return {name: int(settings[name]) for name in names} if all(name in settings for name in names) else None


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def _short(value: Any) -> str:
    if isinstance(value, tuple):
        return " ".join(_short(inner) for inner in value)
    return f"{value:g}" if isinstance(value, float) else str(value)
