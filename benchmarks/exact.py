"""The exact reference: against filling arrays, against a general integrator, and on two threads."""

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.exact_batch import fill_batch, stack
from benchmarks.exact_sensitivity import fill_sensitivities
from benchmarks.registry import Pair, benchmark
from harness.core.arrays import FloatArray
from harness.core.slider import PAPER
from harness.exact.decay import Decay, fill_at, fill_uniform

_LONG = 4_000_000
_PAPER = Decay.of(PAPER, 1.0)


def _fill_constant(*arrays: FloatArray) -> None:
    for array in arrays:
        array.fill(1.0)


@benchmark(
    "exact.samples",
    peer="numpy: fill three arrays with a constant",
    timed="4e6 samples of x, v, a of the paper's decay, uniform grid over 3 s; preallocated arrays, one thread",
    target=4.0,
)
def samples() -> Pair:
    x, v, a = np.empty((3, _LONG))
    return Pair(lambda: fill_uniform(_PAPER, 0.0, 3.0 / _LONG, x, v, a), lambda: _fill_constant(x, v, a))


@benchmark(
    "exact.samples-allocated",
    peer="numpy: allocate three arrays and fill them with a constant",
    timed="as exact.samples, with the allocation of the three arrays inside the clock on both sides",
    target=None,
)
def samples_allocated() -> Pair:
    def ours() -> None:
        fill_uniform(_PAPER, 0.0, 3.0 / _LONG, np.empty(_LONG), np.empty(_LONG), np.empty(_LONG))

    return Pair(ours, lambda: _fill_constant(np.empty(_LONG), np.empty(_LONG), np.empty(_LONG)))


@benchmark(
    "exact.samples-irregular",
    peer="numpy: fill three arrays with a constant",
    timed="1e6 samples of x, v, a of the paper's decay at irregular times; both into preallocated arrays, one thread",
    target=None,
)
def samples_irregular() -> Pair:
    t = np.sort(np.random.default_rng(1).uniform(0.0, 3.0, 1_000_000))
    x, v, a = np.empty((3, t.size))
    return Pair(lambda: fill_at(_PAPER, t, x, v, a), lambda: _fill_constant(x, v, a))


@benchmark(
    "exact.sensitivities",
    peer="the same samples without derivatives",
    timed="4001 irregular samples of x, v, a with six derivatives each, preallocated, one thread",
    target=None,
)
def sensitivities() -> Pair:
    t = np.sort(np.random.default_rng(1).uniform(0.0, 3.0, 4001))
    x, v, a = np.empty((3, t.size))
    dx, dv, da = np.empty((3, t.size, 6))
    return Pair(lambda: fill_sensitivities(_PAPER, t, x, v, a, dx, dv, da), lambda: fill_at(_PAPER, t, x, v, a))


def _by_integration(t: FloatArray, x: FloatArray, v: FloatArray, a: FloatArray) -> None:
    """The paper's case as a careful user of scipy writes it: one call a half-cycle, ended by its reversal."""

    def rest(_: float, state: FloatArray, direction: float) -> float:
        return float(state[1]) * direction

    rest.terminal = True  # type: ignore[attr-defined]
    rest.direction = -1.0  # type: ignore[attr-defined]

    def slide(_: float, state: FloatArray, direction: float) -> tuple[float, float]:
        return state[1], -(PAPER.c * state[1] + PAPER.k * state[0] + PAPER.f_k * direction) / PAPER.m

    begin, state, done = 0.0, [1.0, 0.0], 0
    while abs(state[0]) > PAPER.x_s and done < t.size:
        direction = -np.sign(state[0])
        span, times = (begin, float(t[-1])), t[done:]
        run = solve_ivp(
            slide, span, state, "DOP853", times, events=rest, args=(direction,), rtol=1e-10, atol=1e-12, first_step=1e-6
        )
        upto = done + run.t.size
        x[done:upto], v[done:upto] = run.y
        a[done:upto] = slide(0.0, run.y, direction)[1]
        done = upto
        begin, state = float(run.t_events[0][0]), [float(run.y_events[0][0, 0]), 0.0]
    x[done:], v[done:], a[done:] = state[0], 0.0, 0.0


@benchmark(
    "exact.against-integration",
    peer="scipy solve_ivp: DOP853, events, rtol 1e-10, one call a half-cycle",
    timed="the paper's case, 4001 samples of x, v, a over 3 s uniform grid, both into preallocated arrays",
    target=1.0 / 500.0,
)
def against_integration() -> Pair:
    t = np.linspace(0.0, 3.0, 4001)
    ours, theirs = np.empty((3, t.size)), np.empty((3, t.size))
    _by_integration(t, *theirs)
    fill_uniform(_PAPER, 0.0, 3.0 / 4000, *ours)
    # a peer that computes something else would be no peer
    np.testing.assert_allclose(ours[:2], theirs[:2], rtol=0, atol=1e-7)
    return Pair(lambda: fill_uniform(_PAPER, 0.0, 3.0 / 4000, *ours), lambda: _by_integration(t, *theirs))


@benchmark(
    "exact.batch-two-threads",
    peer="the same on one thread",
    timed="10,000 random sliders x 1000 samples of x, v, a on two threads, preallocated",
    target=1.0 / 1.5,
)
def batch() -> Pair:
    rng = np.random.default_rng(5)
    decays = [
        Decay(rng.uniform(5, 50), rng.uniform(0, 0.2), rng.uniform(0.001, 0.05), rng.uniform(0.5, 1.5), rng.normal())
        for _ in range(10_000)
    ]
    parameters = stack(decays)
    x, v, a = np.empty((3, len(decays), 1000))
    return Pair(
        lambda: fill_batch(parameters, 0.0, 3e-3, x, v, a, threads=2),
        lambda: fill_batch(parameters, 0.0, 3e-3, x, v, a, threads=1),
    )
