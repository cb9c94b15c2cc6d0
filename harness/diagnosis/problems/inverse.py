"""A driven recording whose force is fitted: no force that is known says its motion well enough to follow it.

What a real drive leaves over is a force that no law of the model says (ripple, bending, heat), far above what its
encoder's noise makes of it; so the force that a model asks for to move as recorded is what is fitted. What is left is
coloured and of no known level: neighbouring values say the same thing, so that a sum of squares counts as that of fewer
values, and standard errors come from the residual's own covariance with the partials.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Self, TypeVar

import numpy as np
from scipy.special import ndtri

from harness.core.arrays import BoolArray, FloatArray, ModeArray
from harness.core.events import Events
from harness.diagnosis.problem import Observation
from harness.diagnosis.problems.driven import Driven, Forced
from harness.diagnosis.problems.force_covariance import ForceCovariance, white, white_backwards
from harness.diagnosis.problems.measured import Measured, least
from harness.diagnosis.rules import STRUCTURE
from harness.diagnosis.starts import Windows
from harness.estimate.noise import Noise, channel_noise
from harness.fit.series import memory
from harness.kernels.solve import By, Effort, Scales
from harness.model.model import Model

R = TypeVar("R")
_SETTLED = 1e-9
"""Share of the sum of squares below which a step is the last."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InverseDynamics(Forced):
    """The force is what is fitted, by samples or as means over blocks; the motion over the windows is only shown.

    fixed : motion and force, where they are not as the channels and the drive have them; see ``measured``.
    independent : values that the force left over counts as; None as long as its level, the noise of "u", is not known.
    covariance : of its values, where the noise of its sensors is known to take part. each_sample : whether that is the
    noise of every sample, and not of what is smoothed.
    """

    starts: Windows = field()
    fixed: Measured | None = None
    independent: float | None = None
    covariance: ForceCovariance | None = None
    each_sample: bool = True
    _made: dict[Callable[..., Any], Any] = field(init=False, default_factory=dict, repr=False, compare=False)

    @classmethod
    def of(cls, driven: Driven, windows: Windows) -> "InverseDynamics":
        """The same recording, with its force fitted."""
        return _as(cls, driven, windows)

    @property
    def measured(self) -> Measured:
        """Motion and force, smoothed alike. Raises SimulationError when little moves."""
        return self.once(_measured) if self.fixed is None else self.fixed

    def once(self, work: Callable[[Self], R]) -> R:
        """What work makes of this problem, which does not change: whoever asks again is given the same."""
        if work not in self._made:
            self._made[work] = work(self)
        made: R = self._made[work]
        return made

    @property
    def rows(self) -> Mapping[str, FloatArray]:
        """The force, N, at the values that count."""
        return self.once(_rows)

    def shows(self, model: Model, by: tuple[By, ...], scales: Scales | None, effort: Effort) -> Observation:
        """The force that a model asks for, and the motion as it was measured."""
        seen = self.measured
        force, partials = seen.asked(model, by)
        return Observation({"u": force}, {"u": partials}, seen.x, seen.v, seen.a, self.once(_mode), _NO_EVENTS)

    def whitened(self, values: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Over the level of its recording, in ``unit``s: what is left stays coloured.

        A force acts, or was measured, up to a sample before or after its stamp: what that makes of it is noise of one
        shape.
        """
        return {"u": self.weighed(values["u"]) * self.unit}

    def weighed(self, force: FloatArray) -> FloatArray:
        """The same of a force (m,) or (m, q), in newtons."""
        even = self._white(self.measured.even(force))
        if not self.by_noise:
            return even
        late = self._later
        size = float(late @ late)
        if size > 0.0:
            share = 1.0 - 1.0 / math.sqrt(1.0 + size * self.precision**2)
            even = even - np.multiply.outer(late, share / size * (late @ even))
        return even

    def counted(self, residual: FloatArray) -> FloatArray:
        """What a force at each sample (n,) counts in a whitened residual (m,): through noise and filter backwards."""
        values = white_backwards(self.once(_factor), residual) if self.by_noise else residual
        return self.measured.counted(self.measured.even(values))

    @property
    def by_noise(self) -> bool:
        """Whether what its sensors' noise makes of a force weighs it.

        Where reversals count, what smoothing rounds off of them looks like noise, and is none; of several recordings,
        each has a level of its own.
        """
        return self.guarded and not self.alone

    @property
    def sample_by_sample(self) -> bool:
        """Whether the noise of every sample weighs it, and not that of what is smoothed."""
        return self.by_noise and self.each_sample

    def later(self, left: FloatArray, beside: FloatArray | None = None) -> tuple[float, float]:
        """By how many samples a force acts later, one at most, as what a model leaves of it (m,), N, says.

        And the share of its squares that is left then. beside (m, q) : partials of what is free in the model besides.
        """
        late, left = self._later, self._white(self.measured.even(left))
        if beside is not None:
            columns = self._white(self.measured.even(beside))
            late = late - columns @ np.linalg.lstsq(columns, late, rcond=None)[0]
        size, squares = float(late @ late), float(left @ left)
        if size <= 0.0 or squares <= 0.0:
            return 0.0, 1.0
        after = min(max(float(late @ left) / size, -1.0), 1.0)
        return after, float(np.sum((left - after * late) ** 2)) / squares

    @property
    def _later(self) -> FloatArray:
        return self.once(_late)

    def _white(self, values: FloatArray) -> FloatArray:
        return white(self.once(_factor), values) if self.by_noise else values

    @property
    def precision(self) -> float:
        """Over the deviation, N, of an independent value.

        As long as the level is not known, of what the first model leaves.
        """
        return self.once(_rough) if self.independent is None else self.unit

    @property
    def unit(self) -> float:
        """Of one over a newton: the squares left by what gave the level count as its independent values."""
        if self.independent is None:
            return 1.0
        return math.sqrt(self.independent / np.count_nonzero(self.measured.moving)) / self.noise["u"].sigma

    @property
    def points(self) -> int:
        """Independent values; all of them as long as the level is not known."""
        size = float(np.count_nonzero(self.measured.moving)) if self.independent is None else self.independent
        return max(round(size), 1)

    def by_sample(self, residual: FloatArray) -> dict[str, FloatArray]:
        """The force left over, zero where it is not fitted."""
        seen, out = self.measured, np.zeros(self.t.size)
        blocks = np.zeros(seen.moving.size)
        blocks[seen.moving] = residual * math.sqrt(residual.size / self.points)
        out[: seen.t.size] = np.repeat(blocks, seen.t.size // blocks.size)
        return {"u": out}

    def holds(self, model: Model) -> float | None:
        """See Problem. What is fitted is the sliding alone, which says nothing of where it stands."""
        if self.guarded:
            return None
        held = np.abs(self.measured.held(model))
        friction = model.f_k if model.f_s is None else model.f_s
        # beyond what the most of so many blocks may be by what the model leaves of the force
        chance = ndtri(1.0 - STRUCTURE.value / max(held.size, 1)) * self.noise["u"].sigma
        most = float(np.max(held, initial=0.0))
        return most if most > friction + chance else None

    @property
    def simulated(self) -> bool:
        """Never."""
        return False

    @property
    def looked_at(self) -> tuple[float, float] | None:
        """See Problem."""
        if not self.guarded:
            return None
        seen = self.measured
        return float(np.min(np.abs(seen.blocks(seen.v)))), float(np.mean(seen.moving))

    @property
    def settled(self) -> tuple[float, float]:
        """By the share alone: there is no level that is known."""
        return 0.0, _SETTLED

    @property
    def seams(self) -> tuple[int, ...]:
        """Where each further recording begins."""
        return self.measured.begins

    @property
    def alone(self) -> tuple["InverseDynamics", ...]:
        """Each recording by itself, where there are several."""
        return ()

    @property
    def followed(self) -> Driven:
        """The same recording with its motion followed, over the windows."""
        return _as(Driven, self, self.starts)

    def giving(self, covariate: str, values: FloatArray) -> Self:
        """See Problem."""
        seen = self.measured
        return replace(self, fixed=replace(seen, covariates={**seen.covariates, covariate: values[: seen.t.size]}))

    def kept(self, keep: BoolArray) -> Self:
        """The same with only these (m,) of the values counting."""
        moving = self.measured.moving.copy()
        moving[moving] = keep
        return replace(self, fixed=self.measured.part(moving))

    def levelled(self, residual: FloatArray, independent: float) -> Self:
        """With what a model leaves, (m,), N, as the level of noise, which counts as so many independent values."""
        level = math.sqrt(float(residual @ residual) / residual.size)
        noise = {**self.noise, "u": Noise(level, True, 0.0, 0.0)}
        return replace(self, noise=noise, independent=independent, fixed=self.measured)


_NO_EVENTS = Events()


def _measured(problem: InverseDynamics) -> Measured:
    """See InverseDynamics.measured."""
    return Measured.of(problem, each_sample=problem.sample_by_sample)


def _rows(problem: InverseDynamics) -> Mapping[str, FloatArray]:
    """See InverseDynamics.rows."""
    seen = problem.measured
    force = seen.force
    if problem.by_noise:
        base = problem.once(_covariance).base
        force = force - seen.filters[0].shaken @ [base.m, base.c]
    return {"u": force[seen.moving]}


def _mode(problem: InverseDynamics) -> ModeArray:
    """The side to which it slides at every sample of the motion as it was measured, (n,)."""
    seen = problem.measured
    return np.where(seen.slides, np.sign(seen.v), 0.0).astype(np.int8)


def _late(problem: InverseDynamics) -> FloatArray:
    """What a force that acts a sample later would be less, white, (m,)."""
    return problem._white(problem.measured.even(problem.measured.late))


def _factor(problem: InverseDynamics) -> FloatArray:
    """See ForceCovariance.factor."""
    return problem.once(_covariance).factor(problem.measured)


def _covariance(problem: InverseDynamics) -> ForceCovariance:
    """As it was found, or as the sensors' noise lets expect it."""
    if problem.covariance is not None:
        return problem.covariance
    seen = problem.measured
    scatter = channel_noise(problem.t, problem.drive.at(problem.t), rests=True)
    return ForceCovariance.expected(seen, problem.first, least(problem, seen.by), scatter.sigma)


def _rough(problem: InverseDynamics) -> float:
    """The precision by what the first model leaves."""
    seen = problem.measured
    left = problem._white(seen.even(problem.rows["u"] - seen.asked(problem.first)[0]))
    squares = max(float(left @ left), 1e-300)
    return math.sqrt(memory(left).independent / squares)


F = TypeVar("F", Driven, InverseDynamics)
Q = TypeVar("Q", bound=InverseDynamics)


def _as(kind: type[F], other: Driven | InverseDynamics, windows: Windows) -> F:
    """The same recording over windows, read as another kind of a driven one."""
    return kind(
        other.t,
        other.channels,
        other.noise,
        weight=other.weight,
        mass=other.mass,
        restoring=other.restoring,
        zero_free=other.zero_free,
        angular=other.angular,
        starts=windows,
        drive=other.drive,
        first=other.first,
        covariates=other.covariates,
        guarded=other.guarded,
    )
