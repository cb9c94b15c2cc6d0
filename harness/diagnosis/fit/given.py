"""What covariates do: measured columns that push the slider, or make its friction or damping more or less."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.model.covariate import Acts
from harness.model.model import Model
from harness.model.term import Slot

_LEVELS = frozenset({Slot.FRICTION_LEVEL, Slot.BREAK_AWAY})
_FRICTION = _LEVELS | {Slot.FRICTION_LAW, Slot.FRICTION_MODULATION}


def factor(model: Model, values: Mapping[str, FloatArray], acts: Acts) -> FloatArray:
    """What f_k or c is times, (n,) or a number as the values are; never below 0, where nothing is left of it."""
    effects = [p.effect(values[p.name]) for p in model.covariates if p.acts is acts]
    return np.maximum(1.0 + np.sum(effects, axis=0), 0.0) if effects else np.ones(())


def pushed(model: Model, values: Mapping[str, FloatArray]) -> FloatArray:
    """The force (n,), N, by which covariates push the slider."""
    effects = [p.effect(values[p.name]) for p in model.covariates if p.acts is Acts.FORCE]
    return np.asarray(np.sum(effects, axis=0)) if effects else np.zeros(())


def frictionless(model: Model) -> Model:
    """The same without dry friction and without covariates."""
    smooth = tuple(model.terms[i] for i in frictionless_terms(model))
    return replace(model, f_k=0.0, f_s=None, terms=smooth, covariates=())


def frictionless_terms(model: Model) -> tuple[int, ...]:
    """Which terms of a model are none of dry friction."""
    return tuple(i for i, entry in enumerate(model.terms) if entry.term.slot not in _FRICTION)
