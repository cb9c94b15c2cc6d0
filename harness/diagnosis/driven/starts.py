"""How a window starts: position and speed as recorded, internal states as the motion before it has left them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import compiled
from harness.diagnosis.problem import Restarts, Window
from harness.kernels.solve import By
from harness.model.model import Model

_AT_REST = 3.0
"""Standard errors below which a speed is none."""


@dataclass(frozen=True, slots=True)
class Start:
    """The model at the start of a window, and how its starts move with its parameters.

    slopes : for each parameter, the partials by it of starts that hang on it, by the starts' names.
    """

    window: Window
    model: Model
    slopes: Mapping[By, Mapping[str, float]]


def _branch(t: FloatArray, v: FloatArray, at: FloatArray, tau: float, out: FloatArray) -> None:
    """y' = v - y/tau and its partial by tau at the times ``at`` (m,), relaxed at first; out (m, 2)."""
    y, slope, i = 0.0, 0.0, 0
    for j in range(at.size):
        while i + 1 < t.size and t[i + 1] <= at[j]:
            h = t[i + 1] - t[i]
            fade = math.exp(-h / tau)
            mean = 0.5 * (v[i] + v[i + 1])
            # exact for a speed that is constant over the interval
            slope = fade * (slope + y * h / (tau * tau)) + mean * ((1.0 - fade) - fade * h / tau)
            y = fade * y + mean * tau * (1.0 - fade)
            i += 1
        out[j, 0], out[j, 1] = y, slope


branch = compiled(_branch)


def starts_of(model: Model, restarts: Restarts) -> list[Start]:
    """The model at the start of every window.

    x0, v0 : as recorded, the sensor's offset taken off; a speed within its error of none is none. Bristle : fully bent
    in the direction of motion. Maxwell branch : as the recorded speed has left it. A second mass moves with the slider.
    """
    index = {entry.term.key: i for i, entry in enumerate(model.terms)}
    branches = np.zeros((len(restarts.windows), 2))
    if "viscoelastic" in index:
        times = np.array([w.t0 for w in restarts.windows])
        branch(restarts.t, restarts.v, times, model.terms[index["viscoelastic"]].value("tau"), branches)
    found = []
    for w, (y, by_tau) in zip(restarts.windows, branches, strict=True):
        v0 = 0.0 if abs(w.v0) < _AT_REST * w.v_sd else w.v0
        terms = list(model.terms)
        slopes: dict[By, dict[str, float]] = {"offset": {"x0": -1.0}}
        if "viscoelastic" in index:
            i = index["viscoelastic"]
            terms[i] = replace(terms[i], internal0=(float(y),))
            slopes[(i, 1)] = {"viscoelastic.w0": float(by_tau)}
        stiff = terms[index["presliding"]].value("sigma0") if "presliding" in index else 0.0
        if stiff > 0.0 and v0 != 0.0:
            i = index["presliding"]
            sigma0, side = stiff, math.copysign(1.0, v0)
            z = side * model.f_k / sigma0
            terms[i] = replace(terms[i], internal0=(z,))
            slopes["f_k"] = {"presliding.z": side / sigma0}
            slopes[(i, 0)] = {"presliding.z": -z / sigma0}
        started = replace(model, x0=w.x0 - model.offset, v0=v0, t0=w.t0, terms=tuple(terms))
        found.append(Start(w, started, slopes))
    return found
