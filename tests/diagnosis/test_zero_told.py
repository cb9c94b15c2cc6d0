"""Whether the zero was told, or chosen at the base fit: only where it is told a bench is expected."""

import numpy as np
import pytest

from harness.core.recording import Recording
from harness.diagnosis.pipeline import prepare, prepare_together
from harness.diagnosis.request import Asked
from harness.kernels.solve import simulate
from harness.model.model import Model, Restoring

T = np.linspace(0.0, 4.0, 900)


def decay(zero: float = 0.0, x0: float = 0.1) -> Recording:
    """About nine cycles, read from so far beside the rest."""
    noise = 1e-5 * np.random.default_rng(7).standard_normal(T.size)
    return Recording(T, {"x": simulate(Model(m=1.0, c=0.2, k=200.0, f_k=0.1, x0=x0), T).x + zero + noise})


@pytest.mark.parametrize(
    ("zero", "told", "free", "bench"),
    [
        (0.0, None, False, False),
        (0.0, False, False, True),
        (0.0, True, True, False),
        (0.01, None, True, False),
        (0.01, False, False, True),
    ],
)
def test_a_zero_is_of_a_bench_only_where_it_is_told(zero: float, told: bool | None, free: bool, bench: bool) -> None:
    problem, _ = prepare(decay(zero), Asked(Restoring.SPRING, told))
    assert (problem.zero_free, problem.on_bench) == (free, bench)


@pytest.mark.parametrize(("told", "bench"), [(None, False), (False, True)])
def test_recordings_together_and_each_of_them_know_what_was_told(told: bool | None, bench: bool) -> None:
    # the second swings further, so that the zero is chosen at it and taken over by the first
    both, _ = prepare_together([decay(), decay(x0=0.15)], Asked(Restoring.SPRING, told))
    assert not both.zero_free
    assert [both.on_bench, *(one.on_bench for one in both.alone)] == [bench] * 3
