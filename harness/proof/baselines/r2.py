"""Choosing by R^2: the law whose addition to a regression of the force balance raises R^2 the most."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.proof.baselines.laws import BASE, Named, Recording, refusal, regressors, states_of

LEAST_GAIN = 0.01
"""Share of what the base leaves unexplained that a law must explain to be named."""


def name_by_r2(recording: Recording) -> Named:
    """The one law that explains most of the acceleration beside spring, viscous and Coulomb friction, or nothing."""
    why = refusal(recording)
    if why:
        return Named((), False, why)
    states = states_of(recording)
    if states is None:
        return Named((), False, "no oscillation")
    laws = {name: states.smoothed(law) for name, law in regressors(states).items()}
    base = [laws[name] for name in BASE]
    before = _r_squared(base, states.a)
    after = {name: _r_squared([*base, law], states.a) for name, law in laws.items() if name not in BASE}
    best = max(after, key=lambda name: after[name])
    enough = after[best] - before > LEAST_GAIN * (1.0 - before)
    return Named((best,) if enough else ())


def _r_squared(columns: list[FloatArray], a: FloatArray) -> float:
    matrix = np.column_stack(columns)
    matrix = matrix / np.linalg.norm(matrix, axis=0)
    left = a - matrix @ np.linalg.lstsq(matrix, a, rcond=None)[0]
    return 1.0 - float(np.sum(left**2) / np.sum((a - a.mean()) ** 2))
