"""What of a simulation's mismatch is the engine's, the parameters', missing physics, noise, and nobody's."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.alignment.align import LEAST_SHARED, align
from harness.diagnosis.explain.engines import Simulator, shown_by
from harness.diagnosis.fit.model_fit import whitened
from harness.diagnosis.fit.observe import observe
from harness.diagnosis.problem import Problem
from harness.diagnosis.sensors.resample import channels_at
from harness.kernels.solve import Scales
from harness.model.model import Model


@dataclass(frozen=True, slots=True)
class MeanSquares:
    """Mean squares of recording minus simulation over the values that count, in channels whitened by their noise.

    simulated : S0, the engine or the user's trace. configured : S1, exact at the same parameters. baseline : S2, exact
    at the baseline fit. refined : S3, exact refined model. noise : N, which is 1 in these units.
    """

    simulated: float
    configured: float
    baseline: float
    refined: float
    noise: float = 1.0


@dataclass(frozen=True, slots=True)
class Attribution:
    """Shares of S0, which sum to 1; a share below 0 means that this step made the match worse.

    shift : s by which a user's trace was moved in time, None for an engine's.
    """

    engine: float
    parameters: float
    missing_physics: float
    unexplained: float
    noise: float
    squares: MeanSquares
    shift: float | None = None

    def with_steps(self, left: float) -> "Attribution":
        """The same where the recording is itself the trace of an engine, whose steps leave the mean square ``left``.

        What the exact refined model leaves above that is the integrator's, and so the engine's.
        """
        own = (self.squares.refined - left) / self.squares.simulated
        return replace(self, engine=self.engine + own, unexplained=self.unexplained - own)


def shares(squares: MeanSquares, shift: float | None = None) -> Attribution:
    """(S0 - S1, S1 - S2, S2 - S3, S3 - N, N) / S0, as they come out."""
    whole = squares.simulated
    return Attribution(
        engine=(whole - squares.configured) / whole,
        parameters=(squares.configured - squares.baseline) / whole,
        missing_physics=(squares.baseline - squares.refined) / whole,
        unexplained=(squares.refined - squares.noise) / whole,
        noise=squares.noise / whole,
        squares=squares,
        shift=shift,
    )


def attribute_engine(
    simulate: Simulator,
    configured: Model,
    base: Model,
    refined: Model,
    problem: Problem,
    scales: Scales,
    dt: float | None = None,
) -> Attribution:
    """Attribution for an engine as it is configured: its settings, its step (s, None for the settings' own).

    configured : the user's model, or ``base`` when there is none. Raises SimulationError.
    """
    shown, _ = shown_by(simulate, configured, problem, dt)
    exact = [mean_square(observe(model, problem, scales=scales).y, problem) for model in (configured, base, refined)]
    return shares(MeanSquares(mean_square(shown, problem), *exact))


def attribute_trace(
    trace: Recording, configured: Model, base: Model, refined: Model, problem: Problem, scales: Scales
) -> Attribution:
    """Attribution for a trace of the user's own simulation, aligned in time.

    Counted is what the trace covers, in the channels it has. configured : the model the trace was made with, or
    ``base`` when it is not known; then what its parameters do wrong counts as the engine's.
    Raises InputError for a trace that does not overlap, SimulationError.
    """
    common = {c: y for c, y in problem.channels.items() if c in trace}
    if not common:
        found = f"channels {', '.join(trace.channels)}"
        raise InputError(trace.file, found, f"one or more of {', '.join(problem.channels)} is accepted")
    span = float(problem.t[-1] - problem.t[0])
    if trace.duration < LEAST_SHARED * span:
        found = f"{trace.duration:.4g} s long"
        raise InputError(trace.file, found, f"a trace of at least half of the recording's {span:.4g} s is accepted")
    seen = replace(problem, channels=common, weight={c: problem.weight[c] for c in common})
    aligned = align(trace, seen, {c: problem.noise[c] for c in common}, 2.0 * np.pi / scales.omega)
    shift = aligned.shift.value or 0.0
    shown = channels_at(trace, np.clip(seen.t - shift, trace.t[0], trace.t[-1]), common)
    seen = seen.weighted(aligned.covered)
    exact = [mean_square(observe(model, seen, scales=scales).y, seen) for model in (configured, base, refined)]
    return shares(MeanSquares(mean_square(shown, seen), *exact), shift)


def mean_square(shown: Mapping[str, FloatArray], problem: Problem) -> float:
    """Mean square of recording minus ``shown`` over the values that count, whitened by the noise."""
    left = whitened(problem, {c: y - shown[c] for c, y in problem.channels.items()})
    total = float(left @ left)
    return total / problem.points
