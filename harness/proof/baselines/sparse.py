"""Sparse regression: pysindy's sequentially thresholded least squares over the same laws.

Brunton, Proctor and Kutz, PNAS 113, 2016. pysindy is an optional extra.
"""

import math
import warnings
from collections.abc import Sequence

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.proof.baselines.laws import BASE, Named, Recording, refusal, regressors, states_of

THRESHOLDS = tuple(float(x) for x in np.geomspace(0.002, 0.2, 15))
"""Smallest coefficients that may stay, of laws and acceleration scaled to a standard deviation of 1; BIC chooses."""
RIDGE = 1e-5


def name_by_sindy(recording: Recording, thresholds: Sequence[float] = THRESHOLDS) -> Named:
    """Names of the laws besides spring, viscous and Coulomb friction whose coefficients survive.

    Speed is the smoothed derivative of position; pysindy differentiates it once more by its smoothed finite
    difference. Of the thresholds the one with the lowest BIC of the regression is taken, one independent sample in each
    smoothing window. Raises SimulationError when pysindy is not installed.
    """
    try:
        import pysindy
    except ImportError:
        raise SimulationError("pysindy is not installed: pip install pysindy") from None
    why = refusal(recording)
    if why:
        return Named((), False, why)
    s = states_of(recording)
    if s is None:
        return Named((), False, "no oscillation")
    names, columns = [], []
    for name, law in regressors(s).items():
        if name == "viscous":
            continue  # the state itself
        # speed is smoothed once, and once more where pysindy differentiates it
        for column in s.smoothed(s.smoothed(law)).reshape(s.t.size, -1).T:
            spread = float(np.std(column))
            names.append(name)
            # a constant is its own unit
            columns.append(column / spread if spread > 1e-9 * float(np.max(np.abs(column))) else np.ones(s.t.size))
    # time in units in which speed and acceleration are alike
    scale = float(np.std(s.a) / np.std(s.v))
    speed, laws, t = s.v[:, None] / float(np.std(s.v)), np.column_stack(columns), s.t * scale
    derivative = pysindy.SmoothedFiniteDifference(
        smoother_kws={"window_length": s.width, "polyorder": 3, "mode": "interp"}
    )
    independent = max(s.t.size / s.width, 10.0)
    best: tuple[float, FloatArray] | None = None
    for threshold in thresholds:
        model = pysindy.SINDy(
            optimizer=pysindy.STLSQ(threshold=threshold, alpha=RIDGE),
            feature_library=pysindy.IdentityLibrary(),
            differentiation_method=derivative,
        )
        with warnings.catch_warnings():
            # of coefficients all below the threshold, which is an answer
            warnings.simplefilter("ignore")
            model.fit(speed, t=t, u=laws)
        coefficients = np.asarray(model.coefficients(), dtype=np.float64)[0]
        left = derivative(speed, t=t)[:, 0] - np.column_stack([speed, laws]) @ coefficients
        bic = independent * math.log(float(np.mean(left**2))) + np.count_nonzero(coefficients) * math.log(independent)
        if best is None or bic < best[0]:
            best = (bic, coefficients)
    assert best is not None
    found = {name for name, c in zip(names, best[1][1:], strict=True) if c != 0.0}
    return Named(tuple(name for name in dict.fromkeys(names) if name in found and name not in BASE))
