"""A driven model on another recording: rmse over windows, and the force error by the published protocol."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.recording import Recording
from harness.diagnosis.driven.protocol import PUBLISHED, Filtered
from harness.diagnosis.observe import observe
from harness.diagnosis.problem import Problem
from harness.kernels.solve import Scales
from harness.model.model import Model, ModelTerm

RIPPLE = "force-ripple"


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

    def _refitted(self, model: Model) -> float | None:
        """The error on the other recording with the ripple's amplitude and phase refitted to it."""
        ripple = model.find(RIPPLE)
        if ripple is None:
            return None
        from harness.diagnosis.driven.force import inverse_force

        plain, r = without_ripple(model), self.other
        fitted = self.fitted
        offset = float(
            np.mean(fitted.u - PUBLISHED.decimated(inverse_force(plain, fitted.t, fitted.x, fitted.v, fitted.a)))
        )
        left = r.u - offset - PUBLISHED.decimated(inverse_force(plain, r.t, r.x, r.v, r.a))
        angle = 2.0 * np.pi * r.x / ripple.value("period")
        waves = PUBLISHED.decimated(np.column_stack((np.cos(angle), np.sin(angle))))
        left = left - waves @ np.linalg.lstsq(waves, left, rcond=None)[0]
        return 100.0 * float(np.linalg.norm(left) / np.linalg.norm(r.u))


def without_ripple(model: Model) -> Model:
    """The model without force ripples."""
    kept: tuple[ModelTerm, ...] = tuple(entry for entry in model.terms if entry.term.name != RIPPLE)
    return replace(model, terms=kept)


def window_rmse(model: Model, problem: Problem, scales: Scales) -> Mapping[str, float]:
    """Root mean square of recording minus model by channel, window by window, nothing fitted but the starts."""
    shown = observe(model, problem, (), scales)
    return {c: float(np.sqrt(np.mean((y - shown.y[c]) ** 2))) for c, y in problem.channels.items()}
