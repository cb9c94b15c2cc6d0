"""How deep a box rests in a soft floor."""

from typing import Any

import mujoco
from scipy.optimize import brentq

from harness.core.errors import SimulationError

_DEEPEST = 0.1
"""m; a floor softer than this is no floor."""


def rest_height(model: Any) -> float:
    """Height (m, below 0) of the joint "lift" at which the contact carries the box at rest without acceleration.

    A run that started at height 0 would begin with a fall, and with friction that falls short and then overshoots.
    Raises SimulationError when the contact carries the box nowhere.
    """
    data = mujoco.MjData(model)
    lift = model.joint("lift").qposadr[0]

    def rising(height: float) -> float:
        mujoco.mj_resetData(model, data)
        data.qpos[lift] = height
        mujoco.mj_forward(model, data)
        return float(data.qacc[model.joint("lift").dofadr[0]])

    shallow, deep = -1e-12, -1e-9
    while rising(deep) < 0.0:
        shallow, deep = deep, 2.0 * deep
        if deep < -_DEEPEST:
            raise SimulationError("mujoco: the contact is too soft to carry the box")
    return float(brentq(rising, shallow, deep, xtol=1e-15, rtol=1e-12)) if rising(shallow) < 0.0 else shallow
