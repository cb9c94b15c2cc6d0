"""A model of a slider as a file: harness.model/1."""

from typing import Literal

from pydantic import Field

from harness.results.common import Result


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
