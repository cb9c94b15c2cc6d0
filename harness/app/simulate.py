"""A model document in the compiled reference."""

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from harness.core.arrays import FloatArray
from harness.core.trajectory import Trajectory
from harness.kernels.solve import simulate
from harness.model.document import from_document, load
from harness.results.model import ModelDocument


def motion_of(model: ModelDocument | Mapping[str, Any] | str | PathLike[str], t: FloatArray) -> Trajectory:
    """The motion of a model at times t (n,) in s; raises InputError, SimulationError."""
    if isinstance(model, ModelDocument):
        model = model.model_dump(mode="json", by_alias=True)
    found = from_document(model) if isinstance(model, Mapping) else load(Path(model))
    return simulate(found, t)
