"""What a diagnosis comes to.

A hypothesis on what is missing, and how likely it is.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Literal, TypeAlias

from harness.core.arrays import BoolArray, FloatArray
from harness.core.quantity import Quantity
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.integrator_maps import Stepping
from harness.diagnosis.pooling.pooled import Pooled
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import Rule
from harness.kernels.solve import Scales
from harness.model.model import ModelTerm
from harness.model.term import Place, Spans


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """names : what is missing; none where it is nothing, or no name by itself. probability : that it is so."""

    names: tuple[str, ...]
    probability: float


Verdict: TypeAlias = Literal["adequate", "missing_physics", "main_effect", "one_of", "unexplained"]


@dataclass(frozen=True, slots=True)
class Alternative:
    """Another name that the data do not rule out; delta_bic: by how much it is worse, below 10."""

    name: str
    delta_bic: float


class Grade(StrEnum):
    """How much of what is missing a term is."""

    EXPLAINS = "explains"
    MAIN = "main"
    ONE_OF = "one-of"
    PART = "part"
    MINOR = "minor"
    TABULATED = "tabulated"


@dataclass(frozen=True, slots=True)
class Prediction:
    """What took no part in a fit, predicted by the base and by the model with a term: rmse by channel, in its unit.

    spans : s. ratios : of the squares, after over before, span by span.
    """

    spans: Spans
    baseline_rmse: Mapping[str, float]
    refined_rmse: Mapping[str, float]
    ratios: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Mechanism:
    """One piece of physics that was left out.

    entry : the term with its fitted values. statement : one plain sentence with numbers. parameters : with standard
    errors. delta_bic : what BIC loses when it is taken out of the refined model and the rest is fitted again; of a lone
    term, base minus refined. place : where
    it acts. grade : how much of what is missing it is. share : of the misfit beyond noise that it takes
    off alone. held_out : blocks of cycles left out of the fit; forward : a free run of the last part from a fit of the
    first. chance : to be the main effect, where it stands apart from every other name. probability : that it is
    missing; None of what has no name.
    """

    entry: ModelTerm
    statement: str
    parameters: Mapping[str, Quantity]
    delta_bic: float
    place: Place
    alternatives: tuple[Alternative, ...] = ()
    grade: Grade = Grade.EXPLAINS
    share: float | None = None
    held_out: Prediction | None = None
    forward: Prediction | None = None
    chance: float | None = None
    probability: float | None = None

    @property
    def name(self) -> str:
        """Catalogue name."""
        return self.entry.term.name


@dataclass(frozen=True, slots=True)
class Tried:
    """A catalogue name alone. delta_bic : by which it beats the base; share : of the misfit beyond noise, if graded."""

    name: str
    delta_bic: float
    share: float | None = None


@dataclass(frozen=True, slots=True)
class Forced:
    """The best-ranked term put into a model that needs none: held-out rmse by channel without it and with it."""

    name: str
    baseline_rmse: Mapping[str, float]
    refined_rmse: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Holdout:
    """Prediction of samples that took no part in the fits: spans (s), rmse by channel before and after.

    forced : where nothing is missing, what one term too many would do to the prediction. why : where there is no figure
    because a fit failed, a sentence that says so.
    """

    spans: Spans
    baseline_rmse: Mapping[str, float]
    refined_rmse: Mapping[str, float]
    forced: Forced | None = None
    why: str = ""

    @classmethod
    def none(cls, of: str = "") -> "Holdout":
        """No figure; ``of`` : the model that could not be fitted without what was held out, or not followed there."""
        said = f"there is no prediction of what is held out: the {of} model, fitted to the rest, cannot be followed"
        return cls((), {}, {}, why=said if of else "")


@dataclass(frozen=True, slots=True)
class Remainder:
    """What the best model found leaves.

    share : of the base's misfit beyond noise. over_noise : its rms in units of the sensors'. looks_like : one sentence.
    depends_on : by "x", "v", "t", "direction", "amplitude", the share of it that is a function of that alone.
    """

    share: float
    over_noise: float
    looks_like: str
    depends_on: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Table:
    """A force without a name, as a curve with one standard error.

    form : "f(x)" and the like. of : "x", "v" or "|v|". at (m,) : m (a sensor shows the model's offset more) or m/s,
    over the range that was swept; beyond it nothing is known. force, stderr (m,) : N, on the left of the equation of
    motion; of "g(x) sgn v" the force at v > 0. swept (l,) : quantiles of the motion. gauge : what the table has none of
    over them, as it belongs to the base: "constant" (the zero, or f_k), "level" (of a given force), "line" (k, or c).
    described : its shape in words. nearest : catalogue names and the share of it that they say.
    """

    form: str
    of: Literal["x", "v", "|v|"]
    at: FloatArray
    force: FloatArray
    stderr: FloatArray
    swept: FloatArray
    gauge: tuple[str, ...]
    described: str = ""
    nearest: tuple[tuple[str, float], ...] = ()

    @property
    def has_constant(self) -> bool:
        """Whether a constant is the table's own."""
        return not {"constant", "level"} & set(self.gauge)


@dataclass(frozen=True, slots=True)
class Surface:
    """A force without a name over position and speed at once, on the left of the equation of motion, beside the tables
    of either.

    x (m,) : m (a sensor shows the model's offset more). v (k,) : m/s. force, stderr (k, m) : N. known (k, m) : where
    the motion was; elsewhere nothing is known. described : in words.
    """

    x: FloatArray
    v: FloatArray
    force: FloatArray
    stderr: FloatArray
    known: BoolArray
    described: str = ""


@dataclass(frozen=True, slots=True)
class Outcome:
    """A diagnosis of one recording.

    problem : with the noise that the verdict rests on. base : fit of viscous and Coulomb friction. refined : fit of the
    best model found (the base when nothing is missing or nothing helps). evidence : every catalogue name that was
    tried alone, best first. mechanisms : strongest first. stepping : of the engine whose trace it is.
    posterior : which names are missing, most likely first.
    rules : those that decided. remainder : where no model explains the recording to its noise. tables : of what has no
    name, part of the refined model; surface : what of it hangs on position and speed at once. pooled : what several
    recordings share, where there are several. bounded : whether a budget ended the search. shifts : by which a law that
    could hide, or a named one in another form, or one that is listed, would shift each number of the refined model, by
    name.
    """

    problem: Problem
    scales: Scales
    base: Fit
    refined: Fit
    verdict: Verdict
    mechanisms: tuple[Mechanism, ...]
    holdout: Holdout
    evidence: tuple[Tried, ...]
    base_parameters: Mapping[str, Quantity] = field(default_factory=dict)
    refined_parameters: Mapping[str, Quantity] = field(default_factory=dict)
    next_experiment: str = ""
    warnings: tuple[str, ...] = ()
    stepping: Stepping | None = None
    posterior: tuple[Hypothesis, ...] = ()
    rules: tuple[Rule, ...] = ()
    remainder: Remainder | None = None
    tables: tuple[Table, ...] = ()
    surface: Surface | None = None
    pooled: Pooled[Any] | None = None
    bounded: bool = False
    shifts: Mapping[str, float] = field(default_factory=dict)

    def chi2_per_point(self, found: Fit) -> float | None:
        """Of the base or the refined fit, in units of the noise; None where nothing says how large that is.

        A fitted force counts in units of what the model of most evidence leaves; the remainder says what of that is
        noise.
        """
        seen, left = found.chi2 / max(found.points, 1), self.refined.chi2 / max(self.refined.points, 1)
        if self.remainder is None or left <= 0.0:
            return seen
        if not math.isfinite(self.remainder.over_noise):
            return None
        return seen * self.remainder.over_noise**2 / left
