"""The force a model asks for to move as recorded, sample by sample."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.inverse_dynamics.asked import Path, asked
from harness.model.model import Model


def given_force(
    model: Model, t: FloatArray, x: FloatArray, v: FloatArray, a: FloatArray, given: Mapping[str, FloatArray]
) -> FloatArray:
    """Force (n,), N, that moves the model through x (as its sensor shows it), v, a (n,) at t (s).

    given : the model's covariates as they were measured, by name, (n,).
    """
    return asked(model, Path(t, x, v, a, given, np.ones(t.size, dtype=np.bool_)))[0]


def inverse_force(model: Model, t: FloatArray, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
    """The same, covariates apart."""
    return given_force(replace(model, covariates=()), t, x, v, a, {})
