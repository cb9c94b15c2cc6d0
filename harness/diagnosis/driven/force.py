"""The force a model asks for to move as recorded: its inverse dynamics, by the kernel's own laws."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import compiled
from harness.diagnosis.driven.starts import branch
from harness.kernels.integrate import mode_moving
from harness.kernels.layout import BRISTLE, FRICTION, lay_out
from harness.kernels.rhs import rhs
from harness.kernels.work import SPARE, Work, workspace
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


def inverse_force(model: Model, t: FloatArray, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
    """Force (n,), N, that moves the model through x (as its sensor shows it), v, a (n,) at t (s).

    Bristles are fully bent, Maxwell branches as the speed has left them, a second mass moves with the slider.
    """
    layout = lay_out(model, max(float(np.max(np.abs(v))), 1e-300))
    inside = np.zeros((t.size, layout.start.size - 2))
    for i, name in enumerate(layout.state_names[2:]):
        if layout.spec[FRICTION] == BRISTLE and i == 0:
            inside[:, i] = np.sign(v) * model.f_k / model.terms[_at(model, "presliding")].value("sigma0")
        elif name.startswith("viscoelastic"):
            states = np.zeros((t.size, 2))
            branch(t, v, t, model.terms[_at(model, "viscoelastic")].value("tau"), states)
            inside[:, i] = states[:, 0]
        elif 2 + i in layout.speeds:
            inside[:, i] = v
    work = workspace(
        layout.spec, layout.theta, np.empty(0, np.int64), np.ones(layout.start.size), layout.start,
        np.zeros((layout.start.size, 0)),
    )  # fmt: skip
    out = np.empty(t.size)
    forces(t, x - model.offset, v, a, inside, model.m, work, out)
    return out


def _at(model: Model, key: str) -> int:
    return next(i for i, entry in enumerate(model.terms) if entry.term.key == key)
