"""Does the refined model explain the recording in a physics engine too? The engine is passed in."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.trajectory import Trajectory
from harness.diagnosis.fit.rmse import rms, rmse
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.sensor_model import latest, sensed
from harness.kernels.solve import Drive, Scales
from harness.model.model import Model

_COARSEST = 1e-3
"""Step that an engine begins with at most, s: that of the tuned presets."""
_STEPS_A_CYCLE, _MOST_A_CYCLE = 400, 4000
"""Or so many a swing; of a slow one no more than so many."""
_SMALL = 0.3
"""Share of the noise that an engine's own error may reach."""
_HALVINGS = 4
"""Of the step: to a sixteenth."""
_WORTH = 0.9
"""Half a step that leaves more than this of the error is not worth its time."""
_MOST_STEPS = 2_000_000
"""Bounds the work of a run."""


class Simulator(Protocol):
    """An engine with its settings, ready to simulate models. harness.engines.simulator has one."""

    def __call__(self, model: Model, duration: float, dt: float | None, drive: Drive | None) -> Trajectory:
        """The motion from release on, in time since release, for ``duration`` s.

        dt : step in s, None for the settings' own. drive : in time since release. Raises SimulationError.
        """


@dataclass(frozen=True, slots=True)
class EngineFit:
    """Both models in one engine against the recording.

    settings : in force, "dt" (s) among them. ignored : what the engine does not honour, one sentence each.
    baseline_rmse, refined_rmse : by channel, in its unit. own_error : rms by channel of the engine against the exact
    motion of the refined model, in units of the noise.
    """

    settings: Mapping[str, Any]
    baseline_rmse: Mapping[str, float]
    refined_rmse: Mapping[str, float]
    own_error: Mapping[str, float]
    ignored: tuple[str, ...] = ()

    @property
    def improved(self) -> bool:
        """Whether the refined model is the better one in every channel."""
        return all(self.refined_rmse[c] < self.baseline_rmse[c] for c in self.baseline_rmse)


def engine_fit(
    simulate: Simulator, base: Model, refined: Model, problem: Problem, scales: Scales, dt: float | None = None
) -> EngineFit:
    """Simulate both models in an engine and compare what the sensors would have shown with the recording.

    dt : step in s; None halves a step that suits the recording, at most four times, until the engine's own error, which
    the exact motion shows, is far below the noise. Raises SimulationError for what the engine cannot do.
    """
    exact = observe(refined, problem, scales=scales).y
    step = suitable_step(problem, scales) if dt is None else dt

    def tried(step: float) -> tuple[dict[str, FloatArray], Trajectory, dict[str, float]]:
        """What the refined model shows, the engine's motion, and by how much that is off, in units of the noise."""
        shown, motion = shown_by(simulate, refined, problem, step)
        counts = {c: w > 0.0 for c, w in problem.weight.items()}
        return shown, motion, {c: rms(y - exact[c], counts[c]) / problem.noise[c].sigma for c, y in shown.items()}

    def steps(step: float) -> int:
        return math.ceil(float(problem.t[-1] - problem.t[0]) / step)

    found = tried(step)
    own, left, ahead = max(found[2].values()), 0, 1
    if dt is None:
        # within the work of a run
        left = min(_HALVINGS, max(int(math.log2(_MOST_STEPS / steps(step))), 0))
    while left > 0 and own > _SMALL:
        finer = tried(step / 2**ahead)
        share = max(finer[2].values()) / own
        if share > _WORTH:
            break
        step, found, own, left = step / 2**ahead, finer, max(finer[2].values()), left - ahead
        # how many more, by what each has taken off until now: those between need not be run
        rate = share ** (1.0 / ahead)
        ahead = min(max(round(math.log(_SMALL / own) / math.log(rate)), 1) if own > _SMALL else 0, left)
    before, _ = shown_by(simulate, base, problem, step)
    shown, motion, error = found
    settings = {**motion.source.settings, "dt": step, "steps": steps(step)}
    return EngineFit(settings, rmse(before, problem), rmse(shown, problem), error, motion.source.ignored)


def shown_by(
    simulate: Simulator, model: Model, problem: Problem, dt: float | None
) -> tuple[dict[str, FloatArray], Trajectory]:
    """Channels of ``problem`` as an engine and the model's sensors show them, and the engine's last motion.

    A driven recording is simulated window by window, each from its own start, as the fit does it.
    """
    parts: dict[str, list[FloatArray]] = {c: [] for c in problem.channels}
    for start in problem.starts.of(model):
        t = problem.t[start.samples] - start.clock
        duration = latest(start.model, t)
        if duration <= 0.0:
            raise SimulationError("the recording ends before the slider is released")
        begin = start.model.t0 + start.clock
        motion = simulate(start.model, duration, dt, problem.drive_over(begin, begin + duration))
        for c, y in sensed(start.model, t, motion, problem.channels).items():
            parts[c].append(y)
    return {c: np.concatenate(each) for c, each in parts.items()}, motion


def suitable_step(problem: Problem, scales: Scales) -> float:
    """A step (s) that divides the recording's interval, so that samples meet: 1 ms, or 1/400 to 1/4000 of a period."""
    interval = float(np.median(np.diff(problem.t)))
    period = 2.0 * math.pi / scales.omega
    longest = min(max(_COARSEST, period / _MOST_A_CYCLE), period / _STEPS_A_CYCLE)
    return interval / math.ceil(interval / longest)
