"""How a window starts: position and speed as recorded, internal states as the motion before it has left them."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.diagnosis.problem import Restarts, Window
from harness.kernels.solve import By
from harness.model.history import History
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


def starts_of(model: Model, restarts: Restarts) -> list[Start]:
    """The model at the start of every window.

    x0, v0 : as recorded, the sensor's offset taken off; a speed within its error of none is none. Internal states : as
    each term says that the recorded motion leaves them.
    """
    times = np.array([w.t0 for w in restarts.windows])
    speeds = np.array([0.0 if abs(w.v0) < _AT_REST * w.v_sd else w.v0 for w in restarts.windows])
    motion = History(restarts.t, restarts.v, times, speeds, model.f_k)
    implied = {i: e.term.implied(e.values, motion) for i, e in enumerate(model.terms) if e.term.implied is not None}
    found = []
    for at, (w, v0) in enumerate(zip(restarts.windows, speeds.tolist(), strict=True)):
        terms = list(model.terms)
        slopes: dict[By, dict[str, float]] = {"offset": {"x0": -1.0}}
        for i, states in implied.items():
            terms[i] = replace(terms[i], internal0=tuple(states.values[at].tolist()))
            for by, partials in states.by.items():
                names = zip(model.internal_names[i], partials[at].tolist(), strict=True)
                moved = slopes.setdefault((i, by) if isinstance(by, int) else by, {})
                moved |= {name: partial for name, partial in names if partial != 0.0}
        started = replace(model, x0=w.x0 - model.offset, v0=v0, t0=w.t0, terms=tuple(terms))
        found.append(Start(w, started, slopes))
    return found
