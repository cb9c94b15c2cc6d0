"""What a kind of problem has to say: the steps of a diagnosis in which kinds differ."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Generic

import numpy as np

from harness.core.events import Mode
from harness.diagnosis.explain.force_map import ForceMap, force_map
from harness.diagnosis.explain.holdout import periods_held_out
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.fit.rmse import as_started
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.motion import Motion
from harness.diagnosis.outcome import Holdout
from harness.diagnosis.problem import P
from harness.diagnosis.stages import Based, Found, Judged
from harness.kernels.solve import Scales
from harness.model.model import Model, Restoring


class Kind(ABC, Generic[P]):
    """A kind of problem. of : its data."""

    of: type[P]

    @abstractmethod
    def fit_base(self, problem: P) -> Based[P]:
        """The fit of viscous and Coulomb friction, and the noise that it leaves.

        Raises InputError when nothing moves as it should, SimulationError when no start could be simulated.
        """

    @abstractmethod
    def search(self, based: Based[P], other: Judge | None) -> Found:
        """The smallest model that explains the recording, or what comes nearest.

        other : another recording that must confirm what is named. Raises SimulationError.
        """

    def hold_out(self, judged: Judged) -> Holdout:
        """What took no part in the fits, predicted by the base and the refined model: every second full period."""
        return periods_held_out(judged)

    def tried(self, problem: P, models: Sequence[Model], scales: Scales) -> list[Mapping[str, float]]:
        """Rmse by channel of models on a problem that they were not fitted to, nothing fitted but its start.

        Where the problem has starts of its own, from these. Raises InputError, SimulationError.
        """
        return [as_started(model, problem, scales) for model in models]

    def left_over(self, problem: P, base: Fit, scales: Scales, wander: float | None = None) -> ForceMap:
        """The force that a model leaves over, per unit mass: from what it leaves of the channels.

        wander : as in ``force_map``; a force that was measured is not smoothed.
        """
        model, shown = base.model, base.shown
        interval, omega = float(np.median(np.diff(problem.t))), scales.omega
        sigma = {c: noise.sigma * math.sqrt(noise.inflation(omega, interval)) for c, noise in problem.noise.items()}
        stiffness = np.full(problem.t.size, 0.0 if model.restoring is Restoring.NONE else model.k / model.m)
        if model.restoring is Restoring.PENDULUM:
            stiffness *= np.cos(shown.x)
        residual = {c: y - shown.y[c] for c, y in problem.channels.items()}
        motion = Motion(shown.x, shown.v, shown.mode == Mode.STICK, omega)
        return force_map(problem.t, residual, sigma, motion, model.c / model.m, stiffness, wander)
