"""Prediction of a force: of windows that took no part in the fit, and of another recording by the published protocol.

Every second window is held out, the force fitted to the others alone: what models miss of strokes that they were not
fitted to.
"""

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import SimulationError
from harness.core.recording import Recording
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.rmse import rmse
from harness.diagnosis.grading.prediction import Predicted
from harness.diagnosis.inverse_dynamics.protocol import PUBLISHED, Filtered
from harness.diagnosis.outcome import Holdout
from harness.diagnosis.problems.asked import inverse_force
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.simulated import COARSE, observe
from harness.diagnosis.rules import CONFIRMED
from harness.kernels.solve import Scales
from harness.model.model import Model, ModelTerm
from harness.model.term import Slot

_BLOCK = 1.0
"""Length (s) of stretches whose errors count as independent."""


@dataclass(frozen=True, slots=True)
class ForceErrors:
    """Relative force errors, %: of both models on the recording fitted, and on the other, without a ripple.

    refitted : on the other with the ripple, its amplitude and phase refitted there; None without a ripple.
    """

    fit_baseline: float
    fit_refined: float
    baseline: float
    refined: float
    refitted: float | None = None


@dataclass(frozen=True, slots=True)
class Judge:
    """Force errors of models on the recording they were fitted to and on the one that judges them."""

    fitted: Filtered
    other: Filtered

    @classmethod
    def of(cls, fitted: Recording, other: Recording) -> "Judge | None":
        """From two driven recordings of x; None where the protocol's constants do not suit them."""
        if not all("x" in r and "u" in r and PUBLISHED.applies(r.t) for r in (fitted, other)):
            return None
        return cls(*(PUBLISHED.filtered(r.t, r["x"], r["u"]) for r in (fitted, other)))

    def errors(self, model: Model) -> tuple[float, float]:
        """On the recording fitted and on the other, %, without a ripple: its phase belongs to one recording."""
        fit, cross = PUBLISHED.model_errors(without_ripple(model), self.fitted, self.other)
        return fit, cross

    def compared(self, baseline: Model, refined: Model) -> ForceErrors:
        """Both models by the protocol."""
        before, after = self.errors(baseline), self.errors(refined)
        return ForceErrors(before[0], after[0], before[1], after[1], self._refitted(refined))

    def confirms(self, before: Model, after: Model) -> bool:
        """Whether the force error on the other recording falls, by more than chance explains.

        The fall of the squares is compared with its scatter over blocks of a second. A ripple is judged with its
        amplitude and phase refitted, as its phase is each recording's own.
        """
        errors = [self._left(model) for model in (before, after)]
        interval = float(np.median(np.diff(self.other.t))) * PUBLISHED.decimation
        width = max(1, round(_BLOCK / interval))
        fall = errors[0] ** 2 - errors[1] ** 2
        count = max(fall.size // width, 2)
        each = np.array([np.mean(part) for part in np.array_split(fall, count)])
        return float(np.mean(each)) > CONFIRMED.value * float(np.std(each, ddof=1)) / math.sqrt(count)

    def _left(self, model: Model) -> FloatArray:
        """Force (m,), N, left over on the other recording."""
        plain, f, r = without_ripple(model), self.fitted, self.other
        offset = float(np.mean(f.u - PUBLISHED.decimated(inverse_force(plain, f.t, f.x, f.v, f.a))))
        left = r.u - offset - PUBLISHED.decimated(inverse_force(plain, r.t, r.x, r.v, r.a))
        for period in _periods(model):
            angle = 2.0 * np.pi * r.x / period
            waves = PUBLISHED.decimated(np.column_stack((np.cos(angle), np.sin(angle))))
            left = left - waves @ np.linalg.lstsq(waves, left, rcond=None)[0]
        return np.asarray(left, dtype=np.float64)

    def _refitted(self, model: Model) -> float | None:
        """The error on the other recording, %, with the ripple's amplitude and phase refitted to it."""
        if not _periods(model):
            return None
        return 100.0 * float(np.linalg.norm(self._left(model)) / np.linalg.norm(self.other.u))


def _is_ripple(entry: ModelTerm) -> bool:
    """Whether a term is a force that is harmonic along the travel."""
    return entry.term.slot is Slot.SMOOTH and entry.term.phase is not None and entry.repeats("travel") is not None


def _periods(model: Model) -> list[float]:
    """The periods (m) of a model's ripples."""
    return [period for entry in model.terms if _is_ripple(entry) and (period := entry.repeats("travel")) is not None]


def without_ripple(model: Model) -> Model:
    """The model without force ripples."""
    return replace(model, terms=tuple(entry for entry in model.terms if not _is_ripple(entry)))


FOLDS = 4
"""Refits, each without every fourth block of strokes."""


def left_out(
    problem: InverseDynamics, block: FloatArray, refitted: Callable[[InverseDynamics], Model]
) -> Predicted | None:
    """The force error over blocks of strokes left out of a fit; None where the others cannot be fitted.

    block (m,) : number of each value's block, -1 for what is in every fit. refitted : a model fitted to the values
    that count; it may raise SimulationError.
    """
    count = int(block.max()) + 1
    if count < 2:
        return None
    measured, force, squares = problem.measured, problem.rows["u"], np.zeros(count)
    t = measured.blocks(measured.t)
    for fold in range(min(FOLDS, count)):
        out = (block >= 0) & (block % FOLDS == fold)
        try:
            model = refitted(problem.kept(~out))
        except SimulationError:
            return None
        left = problem.weighed(force - measured.asked(model)[0]) ** 2
        squares += np.bincount(block[out].astype(np.int64), left[out], count)
    inside = [t[block == i] for i in range(count)]
    spans = tuple((float(s[0]), float(s[-1])) for s in inside)
    return Predicted({"u": squares}, np.array([float(s.size) for s in inside]), {"u": 1.0}, spans)


def held_out(found: Fit, problem: InverseDynamics, block: FloatArray) -> Predicted | None:
    """The force error of a model over blocks of strokes left out of the fit; see ``left_out``."""
    return left_out(problem, block, lambda part: fit(found.model, part, found.free).model)


def holdout_windows(base: Fit, refined: Fit, problem: InverseDynamics, scales: Scales) -> Holdout:
    """Held-out rmse by channel of the base model and the refined one.

    No spans below two windows, nor where a model cannot be fitted to the other windows alone or not followed from
    there, which is then said.
    """
    windows, t = problem.starts.windows[1::2], problem.t
    if not windows:
        return Holdout.none()
    before = predicted_windows(problem, lambda part: _refitted(base, part), scales)
    if before is None:
        return Holdout.none("base")
    after = before if refined is base else predicted_windows(problem, lambda part: _refitted(refined, part), scales)
    if after is None:
        return Holdout.none("refined")
    return Holdout(tuple((w.t0, float(t[w.stop - 1])) for w in windows), before, after)


def predicted_windows(
    problem: InverseDynamics, fitted: Callable[[InverseDynamics], Model], scales: Scales
) -> dict[str, float] | None:
    """Rmse by channel over every second window, of a model fitted to what else there is.

    None where the fit fails: one of all samples must not stand in, which has seen what it would predict.
    """
    out = np.zeros(problem.t.size, dtype=np.bool_)
    for w in problem.starts.windows[1::2]:
        out[w.start : w.stop] = True
    measured = problem.measured
    touched: BoolArray = np.any(out[: measured.t.size].reshape(measured.moving.size, -1), axis=1)
    with suppress(SimulationError):
        model = fitted(problem.kept(~touched[measured.moving]))
        return rmse(observe(model, problem, (), scales, COARSE).y, problem, out)
    return None


def _refitted(found: Fit, part: InverseDynamics) -> Model:
    """Raises SimulationError where the values that count are fewer than its numbers."""
    if part.rows["u"].size <= len(found.free):
        raise SimulationError("the slider hardly moves")
    return fit(found.model, part, found.free).model
