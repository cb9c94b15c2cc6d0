"""A fitted force where nothing is left out: the model's own motion, seen as it was measured.

Smoothing rounds off what friction does at reversals, noise is amplified by two differences, and some law of a whole
catalogue always fits what comes of both. How well, and how much stays, is simulated: the fitted model moves under the
recorded force, its motion and the force get the noise that was found and pass the same smoothing, the same fit and the
same search (a parametric bootstrap; Davison and Hinkley 1997, ch. 4).
"""

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.fit.observe import COARSE, observe
from harness.diagnosis.inverse_dynamics.force_fit import ForceFit, fit_force
from harness.diagnosis.inverse_dynamics.measured import Measured
from harness.diagnosis.problems.inverse_dynamics import InverseDynamics
from harness.diagnosis.rules import NULL_DRAWS
from harness.diagnosis.smoothed_state.state import Course
from harness.estimate.noise import Noise, channel_noise
from harness.kernels.solve import Scales
from harness.model.model import Model


def draws(
    current: ForceFit, problem: InverseDynamics, scales: Scales, count: int
) -> Iterator[tuple[ForceFit, Measured]]:
    """A fitted model as the truth, recorded and fitted again, so many times. Raises SimulationError."""
    parts = problem.alone or (problem,)
    each = [_Moved.by(current.model.of_recording(r), one, scales) for r, one in enumerate(parts)]
    random = np.random.default_rng(0)
    for _ in range(count):
        measured = Measured.of_several([Measured.of(one.drawn(random)) for one in each], problem)
        yield fit_force(current.model, measured, current.free), measured


@dataclass(frozen=True, slots=True)
class _Moved:
    """A recording as a model moves under its force. shown (n,) : by channel, without noise.

    noise : of its force.
    """

    problem: InverseDynamics
    shown: Mapping[str, FloatArray]
    noise: Noise

    @classmethod
    def by(cls, model: Model, problem: InverseDynamics, scales: Scales) -> "_Moved":
        """Raises SimulationError."""
        # over each stretch without a gap from one start: no window's edge is in the motion
        course = Course.of(problem.t, problem.channels, problem.noise)
        whole = replace(problem, starts=course.anew(math.inf))
        noise = channel_noise(problem.t, problem.drive.at(problem.t), rests=True)
        return cls(problem, observe(model, whole, (), scales, COARSE).y, noise)

    def drawn(self, random: np.random.Generator) -> InverseDynamics:
        """The recording with noise anew."""
        problem, drive = self.problem, self.problem.drive
        channels = {c: problem.noise[c].over(self.shown[c], random) for c in problem.channels}
        force = drive.u
        if self.noise.found:
            force = force + np.interp(drive.t, problem.t, self.noise.drawn(problem.t.size, random))
        return replace(problem, channels=channels, drive=replace(drive, u=force))


def taken_by_chance(
    current: ForceFit, problem: InverseDynamics, scales: Scales, further: Callable[[ForceFit, Measured], list[ForceFit]]
) -> float:
    """Squares of force, N^2 a value, that the best of ``further`` takes off a true model: the most of some draws.

    0 where the model cannot be simulated: then it says nothing of what chance does.
    """
    most = 0.0
    with suppress(SimulationError):
        for before, measured in draws(current, problem, scales, NULL_DRAWS.count):
            after = further(before, measured)
            if after:
                squares = min(f.squares for f in after)
                most = max(most, (before.squares - squares) / before.residual.size)
    return most
