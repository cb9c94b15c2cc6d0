"""What a kind of problem has to say: the steps of a diagnosis in which kinds differ."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Generic

import numpy as np

from harness.core.events import Mode
from harness.core.recording import Recording
from harness.diagnosis.explain.force_map import ForceMap, force_map
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.motion import Motion
from harness.diagnosis.outcome import Holdout
from harness.diagnosis.problem import P, Problem
from harness.diagnosis.request import Asked
from harness.diagnosis.stages import Based, Found, Judged
from harness.kernels.solve import Scales
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.term import Place


class Kind(ABC, Generic[P]):
    """A kind of problem. of : its data."""

    of: type[P]

    @abstractmethod
    def suits(self, recording: Recording) -> bool:
        """Whether a recording is to be made ready as this kind."""

    @abstractmethod
    def prepare(self, recording: Recording, asked: Asked) -> tuple[Problem, tuple[str, ...]]:
        """A recording as a problem, and what was done to it, one sentence each.

        Raises InputError for options that contradict the recording and for what cannot be diagnosed, SimulationError.
        """

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

    @abstractmethod
    def hold_out(self, problem: P, judged: Judged, acting: Sequence[tuple[ModelTerm, Place]]) -> Holdout:
        """What took no part in the fits, predicted by the base and the refined model.

        problem : that of the coarse search. acting : the refined model's terms and where they act.
        """

    @abstractmethod
    def tried(self, problem: P, models: Sequence[Model], scales: Scales) -> list[Mapping[str, float]]:
        """Rmse by channel of models on a problem that they were not fitted to, nothing fitted but its start.

        Raises InputError, SimulationError.
        """

    def left_over(self, problem: P, base: Fit, scales: Scales) -> ForceMap:
        """The force that the base model leaves over, per unit mass: from what it leaves of the channels."""
        model, shown = base.model, base.shown
        interval, omega = float(np.median(np.diff(problem.t))), scales.omega
        sigma = {c: noise.sigma * math.sqrt(noise.inflation(omega, interval)) for c, noise in problem.noise.items()}
        stiffness = np.full(problem.t.size, 0.0 if model.restoring is Restoring.NONE else model.k / model.m)
        if model.restoring is Restoring.PENDULUM:
            stiffness *= np.cos(shown.x)
        residual = {c: y - shown.y[c] for c, y in problem.channels.items()}
        motion = Motion(shown.x, shown.v, shown.mode == Mode.STICK, omega)
        return force_map(problem.t, residual, sigma, motion, model.c / model.m, stiffness)
