"""A model document in the compiled reference."""

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, TypeAlias

from harness.core.arrays import FloatArray
from harness.core.trajectory import Trajectory
from harness.kernels.solve import simulate
from harness.model.document import from_document, load
from harness.model.model import Model
from harness.results.model import ModelDocument

Given: TypeAlias = Model | ModelDocument | Mapping[str, Any] | str | PathLike[str]


def motion_of(model: Given, t: FloatArray) -> Trajectory:
    """The motion of a model at times t (n,) in s; raises InputError, SimulationError."""
    return simulate(model_of(model), t)


def model_of(model: Given) -> Model:
    """The model that is given as one, as a result holds it, as plain data, or as a model.json. Raises InputError."""
    if isinstance(model, Model):
        return model
    if isinstance(model, ModelDocument):
        model = model.model_dump(mode="json", by_alias=True)
    return from_document(model) if isinstance(model, Mapping) else load(Path(model))
