"""A model document in the compiled reference."""

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.trajectory import Trajectory
from harness.kernels.solve import simulate
from harness.model.document import from_document, load
from harness.model.model import Model
from harness.results.common import ModelDocument

Given: TypeAlias = Model | ModelDocument | Mapping[str, Any] | str | PathLike[str]


def motion_of(model: Given, t: FloatArray) -> Trajectory:
    """The motion of a model at times t (n,) in s.

    Before its release a model is held where that begins; one that begins in the middle of a motion has no past.
    Raises InputError for times before that, SimulationError.
    """
    found = model_of(model)
    early = int(np.count_nonzero(t < found.t0))
    if early and found.v0 != 0.0:
        raise InputError(
            "simulate: t",
            f"{early} times before {found.t0:.9g} s, where the model begins and moves already",
            f"times from there on: t[t >= {found.t0!r}]",
        )
    return simulate(found, t)


def model_of(model: Given) -> Model:
    """The model that is given as one, as a result holds it, as plain data, or as a model.json. Raises InputError."""
    if isinstance(model, Model):
        return model
    if isinstance(model, ModelDocument):
        model = model.model_dump(mode="json", by_alias=True)
    return from_document(model) if isinstance(model, Mapping) else load(Path(model))
