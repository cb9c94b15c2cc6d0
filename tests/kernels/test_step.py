"""Sensitivities of displacement and speed are written out: they are those of any number of states, bit for bit."""

import numpy as np
from kernel_cases import model, term

from harness.kernels.layout import lay_out
from harness.kernels.solve import _columns
from harness.kernels.step import advance, carry, carry_two, slope
from harness.kernels.work import FIRST, STAGES, plain, workspace


def test_two_states_are_carried_as_any_number_is() -> None:
    moving = model(term("quadratic-drag", 0.3), term("cubic-stiffness", 2.0))
    layout = lay_out(moving, 1.0)
    columns, start = _columns(layout, ("c", "k", "f_k", "x0", "v0", (0, 0), (1, 0)))
    w = workspace(layout.spec, layout.theta, len(layout.names), columns, np.full(2, 1e-9), layout.start, start)
    w.h_max, w.sensitivity_error = 0.1, 1e-6
    w.z[:2] = 0.7, -1.3
    w.s[:2, :7] = np.random.default_rng(1).standard_normal((2, 7))
    slope(FIRST, 0.0, w.z, w.s, plain(-1), 0.0, w)
    assert advance(0.0, 0.05, plain(-1), 0.0, 0.0, w) > 0.0
    seen = []
    for carried in (carry, carry_two):
        error = carried(0.05, w)
        seen.append(np.concatenate(([error], w.s1[:2, :7].ravel(), w.kss[STAGES - 1, :2, :7].ravel())))
    assert np.all(seen[0] == seen[1])
    assert seen[0][0] > 0.0
    assert not np.array_equal(w.s1[:2, :7], w.s[:2, :7])
