"""Friction that a fit has lost to damping, given back a share of it, so that what acts on friction finds some."""

import math
from dataclasses import replace

from harness.diagnosis.rules import FRICTION_GONE
from harness.kernels.solve import Scales
from harness.model.model import Model


def with_friction(model: Model, base: tuple[str, ...], scales: Scales) -> Model | None:
    """A model whose friction, which is fitted, has vanished, with half of its damping as friction; None for others.

    base : names of what is fitted. Equal energy over a cycle of half the amplitude: 4 f_k X = pi c omega X^2.
    """
    as_friction = math.pi / 4.0 * model.c * scales.omega * 0.5 * scales.x
    if "f_k" not in base or model.f_k > FRICTION_GONE.value * as_friction:
        return None
    return replace(model, c=0.5 * model.c, f_k=0.5 * as_friction)
