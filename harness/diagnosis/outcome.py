"""What a diagnosis comes to."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from harness.core.quantity import Quantity
from harness.diagnosis.fit import Fit
from harness.diagnosis.problem import Problem
from harness.diagnosis.steps import Stepping
from harness.kernels.solve import Scales
from harness.model.model import ModelTerm

Verdict: TypeAlias = Literal["adequate", "missing_physics", "unexplained"]
Spans: TypeAlias = tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class Alternative:
    """Another name that the data do not rule out; delta_bic: by how much it is worse, below 10."""

    name: str
    delta_bic: float


@dataclass(frozen=True, slots=True)
class Mechanism:
    """One piece of physics that was left out.

    entry : the term with its fitted values. statement : one plain sentence with numbers. parameters : with standard
    errors. delta_bic : what BIC loses without it. spans : times (s) in which it acts.
    """

    entry: ModelTerm
    statement: str
    parameters: Mapping[str, Quantity]
    delta_bic: float
    spans: Spans
    alternatives: tuple[Alternative, ...] = ()

    @property
    def name(self) -> str:
        """Catalogue name."""
        return self.entry.term.name


@dataclass(frozen=True, slots=True)
class Forced:
    """The best-ranked term put into a model that needs none: held-out rmse by channel without it and with it."""

    name: str
    baseline_rmse: Mapping[str, float]
    refined_rmse: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Holdout:
    """Prediction of samples that took no part in the fits: spans (s), rmse by channel before and after.

    forced : where nothing is missing, what one term too many would do to the prediction.
    """

    spans: Spans
    baseline_rmse: Mapping[str, float]
    refined_rmse: Mapping[str, float]
    forced: Forced | None = None


@dataclass(frozen=True, slots=True)
class Outcome:
    """A diagnosis of one recording.

    problem : with the noise that the verdict rests on. base : fit of viscous and Coulomb friction. refined : fit of the
    model that was chosen (the base when nothing is missing). evidence : delta BIC of every catalogue name that was
    tried alone, best first. mechanisms : strongest first. stepping : of the engine whose trace the recording is.
    """

    problem: Problem
    scales: Scales
    base: Fit
    refined: Fit
    verdict: Verdict
    mechanisms: tuple[Mechanism, ...]
    holdout: Holdout
    evidence: tuple[tuple[str, float], ...]
    base_parameters: Mapping[str, Quantity] = field(default_factory=dict)
    refined_parameters: Mapping[str, Quantity] = field(default_factory=dict)
    next_experiment: str = ""
    warnings: tuple[str, ...] = ()
    stepping: Stepping | None = None
