"""The force a model asks for to move as recorded: its inverse dynamics, by the kernel's own laws."""

from collections.abc import Mapping

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import compiled
from harness.diagnosis.fit.given import factor, frictionless, pushed
from harness.kernels.integrate import mode_moving
from harness.kernels.layout import Layout, lay_out
from harness.kernels.rhs import rhs
from harness.kernels.solve import By
from harness.kernels.work import SPARE, Work, workspace
from harness.model.covariate import Acts
from harness.model.history import History
from harness.model.model import Model


def _forces(
    t: FloatArray, x: FloatArray, v: FloatArray, a: FloatArray, inside: FloatArray, m: float, w: Work, out: FloatArray
) -> None:
    """m (a - acceleration without drive) at every sample; inside (n, k): internal states beyond x and v."""
    for n in range(t.size):
        w.z[0], w.z[1] = x[n], v[n]
        for i in range(inside.shape[1]):
            w.z[2 + i] = inside[n, i]
        rhs(SPARE, t[n], w.z, mode_moving(v[n], w), 0.0, w)
        out[n] = m * (a[n] - w.ks[SPARE, 1])


forces = compiled(_forces)


def given_force(
    model: Model, t: FloatArray, x: FloatArray, v: FloatArray, a: FloatArray, given: Mapping[str, FloatArray]
) -> FloatArray:
    """The same with the covariates of the model as they were measured; given : by name, (n,)."""
    force = inverse_force(model, t, x, v, a)
    if not model.covariates:
        return force
    dry, wet = (factor(model, given, acts) - 1.0 for acts in (Acts.FRICTION, Acts.DAMPING))
    if dry.ndim:
        force = force + dry * (force - inverse_force(frictionless(model), t, x, v, a))
    return np.asarray(force + wet * model.c * v - pushed(model, given), dtype=np.float64)


def inverse_force(model: Model, t: FloatArray, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
    """Force (n,), N, that moves the model through x (as its sensor shows it), v, a (n,) at t (s), covariates apart.

    Internal states are as each term says that the motion leaves them; what it says nothing of moves with the slider.
    """
    layout = lay_out(model, max(float(np.max(np.abs(v))), 1e-300))
    inside, _ = states_inside(model, layout, t, v)
    work = workspace(
        layout.spec, layout.theta, len(layout.names), np.empty(0, np.int64), np.ones(layout.start.size), layout.start,
        np.zeros((layout.start.size, 0)),
    )  # fmt: skip
    out = np.empty(t.size)
    forces(t, x - model.offset, v, a, inside, model.m, work, out)
    return out


def states_inside(
    model: Model, layout: Layout, t: FloatArray, v: FloatArray, by: tuple[By | None, ...] = ()
) -> tuple[FloatArray, FloatArray]:
    """Internal states (n, k) as the motion leaves them, and their partials (k, n, q) by numbers of the model.

    The partials are of size 0 where no state hangs on any of them.
    """
    count = layout.start.size - 2
    inside, moved = np.zeros((t.size, count)), np.zeros((count if by else 0, t.size, len(by)))
    if count == 0:
        return inside, moved
    inside[:, [i - 2 for i in layout.speeds if i > 1]] = v[:, None]
    motion = History(t, v, t, v, model.f_k)
    for i, (names, entry) in enumerate(zip(model.internal_names, model.terms, strict=True)):
        if entry.term.implied is None:
            continue
        columns = [layout.state_names.index(name) - 2 for name in names]
        states = entry.term.implied(entry.values, motion)
        inside[:, columns] += states.values
        for key, partials in states.by.items():
            number = (i, key) if isinstance(key, int) else key
            if number in by:
                moved[columns, :, by.index(number)] = partials.T
    return inside, moved
