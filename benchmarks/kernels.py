"""The event-driven integrator for any model: against a general integrator, and what sensitivities cost."""

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.registry import Pair, benchmark
from harness.core.arrays import FloatArray
from harness.core.slider import PAPER
from harness.kernels.solve import solve
from harness.model.model import Model, ModelTerm

_T = np.linspace(0.0, 3.0, 4001)
_PAPER = Model.of_slider(PAPER, 1.0)
_BY = ("x0", "c", "k", "f_k", "v0")
_SETTINGS = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-12}


def _by_scipy(model: Model, t: FloatArray, quadratic_drag: float = 0.0) -> FloatArray:
    """x at t by solve_ivp: restarted at every reversal, until it sticks."""
    m, c, k, f_k = model.m, model.c, model.k, model.f_k
    x = np.empty_like(t)
    state, begin, side = np.array([model.x0, model.v0]), float(t[0]), -1.0
    filled = 0

    def turns(_: float, z: FloatArray) -> float:
        return float(z[1])

    turns.terminal = True  # type: ignore[attr-defined]
    while True:

        def slope(_: float, z: FloatArray, side: float = side) -> list[float]:
            drag = quadratic_drag * abs(z[1]) * z[1]
            return [z[1], -(c * z[1] + k * z[0] + drag + side * f_k) / m]

        turns.direction = -side  # type: ignore[attr-defined]
        found = solve_ivp(slope, (begin, t[-1]), state, events=turns, dense_output=True, **_SETTINGS)
        last = int(np.searchsorted(t, found.t[-1], side="right"))
        if last > filled:
            x[filled:last] = found.sol(t[filled:last])[0]
        filled, state, begin = last, np.array([found.y[0, -1], 0.0]), float(found.t[-1])
        if filled == t.size or k * abs(state[0]) <= f_k:
            x[filled:] = state[0]
            return x
        side = -side


@benchmark(
    "kernels.paper",
    peer="scipy.integrate.solve_ivp, DOP853 with events, rtol 1e-10",
    timed="the paper's case, 4001 samples of x, v, a against x alone; events and allocation on both sides",
    target=1 / 20,
)
def paper() -> Pair:
    assert np.abs(solve(_PAPER, _T).x - _by_scipy(_PAPER, _T)).max() < 1e-7
    return Pair(lambda: solve(_PAPER, _T), lambda: _by_scipy(_PAPER, _T))


@benchmark(
    "kernels.term",
    peer="scipy.integrate.solve_ivp, DOP853 with events, rtol 1e-10",
    timed="the paper's case with quadratic drag, as kernels.paper",
    target=1 / 20,
)
def with_a_term() -> Pair:
    model = _PAPER.with_terms(ModelTerm.named("quadratic-drag", c2=0.2))
    return Pair(lambda: solve(model, _T), lambda: _by_scipy(model, _T, 0.2))


@benchmark(
    "kernels.sensitivities",
    peer="ten simulations, two for each parameter",
    timed="the paper's case, 4001 samples of x, v, a with five sensitivities each, against central differences",
    target=0.5,
)
def sensitivities() -> Pair:
    def differences() -> None:
        for _ in range(2 * len(_BY)):
            solve(_PAPER, _T)

    return Pair(lambda: solve(_PAPER, _T, _BY), differences)


@benchmark(
    "kernels.bristle",
    peer="the same model without the bristle",
    timed="a presliding bristle of sigma0 x0/f_k = 1e4, 4001 samples with five sensitivities each",
    target=None,
)
def bristle() -> Pair:
    model = _PAPER.with_terms(ModelTerm.named("presliding", sigma0=3e4, sigma1=50.0))
    return Pair(lambda: solve(model, _T, _BY), lambda: solve(_PAPER, _T, _BY))
