"""The result of models compared on one recording: harness.models/1."""

from typing import ClassVar, Literal

from pydantic import Field

from harness.results.common import P, Paged, RecordingInfo, Result


class ComparedModel(Result):
    """One model, fitted to the recording."""

    name: str
    terms: list[str] = Field(description="of the catalogue, beside viscous and Coulomb friction")
    fitted: int = Field(description="numbers that were fitted")
    chi2_per_point: float = Field(description="in units of the noise that the best model leaves; 1 when only noise is")
    delta_bic: float = Field(description="worse than the best by BIC; 10 is decisive")
    weight: float = Field(description="probability among these models, were they equally likely before")
    rmse: dict[str, float]
    parameters: dict[str, P] = Field(description="omega_n, zeta, x_k; on a free axis mass, c, f_k")
    note: str = ""


class ModelsResult(Paged):
    """Models of one recording, the best first."""

    LINES: ClassVar[str] = "models"

    schema_: Literal["harness.models/1"] = Field(default="harness.models/1", alias="schema")
    recording: RecordingInfo
    statement: str
    models: list[ComparedModel]
