"""Pieces that several results share; a model as a file (harness.model/1); an installation (harness.doctor/1)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from types import FunctionType
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, PrivateAttr, model_validator

from harness.core.events import Regime
from harness.core.quantity import Quantity


def rare(description: str | None = None, factory: Callable[[], Any] | None = None) -> Any:
    """A field that is left out where it says nothing; factory : of its default, None where that is null."""
    if factory is None:
        return Field(default=None, description=description, exclude_if=lambda value: value is None)
    return Field(default_factory=factory, description=description, exclude_if=lambda value: not value)


class Result(BaseModel):
    """Base of every result model: strict about names, so that a typo is an error and not a new field.

    A Quantity, or any object with the attributes that a field's model asks for, may stand for it.
    """

    model_config = ConfigDict(
        extra="forbid", frozen=True, from_attributes=True, ser_json_inf_nan="null", populate_by_name=True
    )

    @classmethod
    def taken_from(cls, found: object, /, **more: Any) -> Self:
        """From what was found: its attributes that have the names of fields, and ``more`` beside and before them."""
        own = {name: getattr(found, name) for name in cls.model_fields if name not in more and hasattr(found, name)}
        return cls.model_validate(own | more)

    def __dir__(self) -> list[str]:
        """What a result says and does, without what its base brings along."""
        kinds = [kind for kind in type(self).__mro__ if issubclass(kind, Result)]
        does = {name for kind in kinds for name, one in vars(kind).items() if isinstance(one, FunctionType | property)}
        hidden = {"schema_", "drawn", "model_post_init"}
        return sorted({*type(self).model_fields, *does} - hidden)


Swing = Literal["spring", "pendulum"]
"""What pulls back."""
Curves = Mapping[str, Mapping[str, np.ndarray]]
"""Motions by name: t, x, v, a and what else there is of each, (n,), SI units."""


@dataclass(slots=True)
class Drawing:
    """What a result is drawn from; no part of what it says, and not pickled with it.

    page : the page, or what makes it of the result. curves : the motions that are on it.
    """

    page: Any = field(default=None, compare=False, repr=False)
    curves: Curves = field(default_factory=dict, compare=False, repr=False)

    def __reduce__(self) -> tuple[type["Drawing"], tuple[()]]:
        return Drawing, ()


class Paged(Result):
    """A result that prints itself, is a page in a notebook, and gives its numbers, plots and curves."""

    LINES: ClassVar[str] = ""
    """The field that holds its rows, where the numbers of a result are rows of a table."""

    _drawing: Drawing = PrivateAttr(default_factory=Drawing)

    def drawn(self, page: Any, curves: Curves | None = None) -> Self:
        """This result with its page, or what makes that of the result, and the motions that are on it."""
        self._drawing.page, self._drawing.curves = page, curves or {}
        return self

    def __str__(self) -> str:
        """The verdict, and the numbers with their errors."""
        text: str = import_module("harness.show.notebook").text(self)
        return text

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        text: str = import_module("harness.show.notebook").html(self)
        return text

    def to_frame(self) -> Any:
        """Every number with its error and unit as a pandas.DataFrame, indexed by part and quantity; or the rows.

        Raises InputError where pandas is not installed.
        """
        return import_module("harness.show.notebook").frame(self)

    @property
    def curves(self) -> Curves:
        """The motions by name, each with t, x, v, a as arrays (n,) in SI units; none of a result that was read."""
        return self._drawing.curves

    @property
    def plots(self) -> list[str]:
        """Names of the plots on the page, that which answers first."""
        names: list[str] = import_module("harness.show.notebook").names(self)
        return names

    def plot(self, name: str | None = None, library: Literal["plotly", "matplotlib"] | None = None) -> Any:
        """A plot of the page as a figure of plotly or matplotlib.

        name : one of ``plots``, None for the first. library : None for plotly where it is installed, else matplotlib.
        Raises InputError where there is no such plot, or neither library.
        """
        return import_module("harness.show.notebook").plot(self, name, library)


Floats = Annotated[list[float], BeforeValidator(lambda y: y.tolist() if isinstance(y, np.ndarray) else y)]
"""Or an array (n,)."""


def _without_tuples(settings: Mapping[str, Any]) -> dict[str, Any]:
    return {name: list(value) if isinstance(value, tuple) else value for name, value in settings.items()}


Settings = Annotated[dict[str, Any], BeforeValidator(_without_tuples)]
"""Of an engine, as JSON has them."""


class P(Result):
    """A number: value, standard error, unit; what is null says why."""

    value: float | None
    stderr: float | None
    unit: str
    why: str | None = rare()
    systematic: float | None = rare(
        "what effects that could not be seen, or another form of a named law, could shift it by"
    )

    @model_validator(mode="after")
    def _nothing_missing_without_reason(self) -> "P":
        if (self.value is None or self.stderr is None) and not self.why:
            raise ValueError("null value or stderr needs a why")
        return self

    @classmethod
    def of(cls, quantity: Quantity) -> "P":
        """The result form of a core Quantity."""
        return cls.model_validate(quantity)

    def __str__(self) -> str:
        """With its error and unit, or why there is none."""
        if self.value is None:
            return f"none ({self.why})"
        return str(Quantity(self.value, self.stderr, self.unit, self.why, self.systematic))


class FleetTrend(Result):
    """A straight line of a parameter over a condition."""

    name: str = Field(description="the condition")
    slope: P
    differs: bool = Field(description="from none, all that is asked counted")
    said: str = Field(default="", description="in words, behind the parameter's name")


class RepeatedResult(Result):
    """A parameter as several recordings of one machine say it, each by itself."""

    value: P = Field(
        description="of all; its error counts the spread between them (type A); systematic: hidden effects (type B)"
    )
    expanded: float | None = rare("expanded uncertainty, k = 2, of both types")
    trends: list[FleetTrend] = rare("with --conditions: over each of them", list)
    within: float = Field(description="standard error of a single recording's, root mean square")
    between: float = Field(description="standard deviation of what they differ by beyond their errors")
    outliers: list[str] = Field(description="files whose value stands out from the others'")


Span = Annotated[list[float], Field(min_length=2, max_length=2, description="[t0, t1] in s")]


class Where(Result):
    """Where a mismatch lies: time spans, a regime, a plain condition, and the share of the mean square it holds."""

    time_s: list[Span]
    regime: Regime
    condition: str
    share: float | None


class Machine(Result):
    """What a result was made with."""

    python: str
    packages: dict[str, str]
    system: str
    cores: int
    seeds: dict[str, int] = Field(default_factory=dict)


class MotionResult(Result):
    """What kind of motion was seen before any fit."""

    kind: Literal[
        "free-decay", "several-decays", "run-down", "driven", "slow-axis", "held", "steps", "spin-up", "at-rest",
        "not-mechanical", "friction-curve",
    ]  # fmt: skip
    reason: str = Field(description="what of it tells so, in a line")
    spans_s: list[Span] = Field(default_factory=list, description="of the decays, or of the run-down")
    wanted: str = Field(default="", description="what recording would tell friction, where this one does not")


class DampingResult(Result):
    """Damping and frequency of a free decay over its amplitude, from turning points, without a law of friction."""

    amplitude: Floats
    unit: Literal["m", "rad"] = Field(description="of amplitudes")
    zeta: Floats = Field(description="equivalent viscous damping ratio; the loss factor is twice as much")
    zeta_stderr: Floats
    frequency_hz: Floats
    frequency_stderr: Floats = Field(description="Hz")
    laws: dict[str, dict[str, Floats]] = Field(description="by model: amplitude, zeta, frequency_hz")


class RecordingInfo(Result):
    """What was read."""

    file: str
    sha256: str
    samples: int
    channels: list[str]
    rate_hz: float
    duration_s: float
    noise: dict[str, float | str | None]
    notes: list[str] = Field(default_factory=list)
    speeds: str | None = rare("of a table of steady speeds, which has no time: from where to where, with the unit")


Json = dict[str, Any]


class Check(Result):
    """One thing that works or does not."""

    name: str
    ok: bool
    found: str = Field(description="a version, a path, or what is wrong")
    needed_for: str = Field(description="what does not work without it")
    remedy: str | None = Field(default=None, description="what to do when it is not there")


class DoctorResult(Result):
    """harness doctor."""

    schema_: Literal["harness.doctor/1"] = Field(default="harness.doctor/1", alias="schema")
    checks: list[Check]
    machine: Machine


class BaseParameters(Result):
    """m x'' + c x' + k R(x) + terms + f = u, in SI units; per unit mass (m = 1) where the mass is unknown."""

    m: float = Field(gt=0.0, description="mass, kg")
    c: float = Field(ge=0.0, description="viscous damping, N s/m")
    k: float = Field(ge=0.0, description="stiffness, N/m; 0 with restoring none")
    f_k: float = Field(ge=0.0, description="kinetic friction, N")
    f_s: float | None = Field(default=None, description="break-away force, N; f_k when absent")


class Release(Result):
    """How it starts."""

    x0: float = Field(default=0.0, description="m")
    v0: float = Field(default=0.0, description="m/s")
    t0: float = Field(default=0.0, description="time of the release, s")


class ModelEntry(Result):
    """One catalogue entry with values for its parameters."""

    name: str
    variant: str = Field(default="", description="which of the laws that share the name")
    parameters: dict[str, float]
    internal: list[float] = Field(default_factory=list, description="start of the internal states; 0 when absent")


class ModelDocument(Result):
    """model.json; harness.model.document turns it into a model and back."""

    schema_: Literal["harness.model/1"] = Field(default="harness.model/1", alias="schema")
    base: BaseParameters
    restoring: Literal["spring", "pendulum", "none"] = "spring"
    release: Release = Field(default_factory=Release)
    terms: list[ModelEntry] = Field(default_factory=list)
    mass_known: bool = True
    offset: float = Field(default=0.0, description="what the sensor of x shows where the restoring force is nil, m")
