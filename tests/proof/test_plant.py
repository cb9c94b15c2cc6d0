"""The plant against closed forms: decrements, descents, static friction, a driven one."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares

from harness.core.arrays import FloatArray
from harness.proof.plant.base_fit import decay_motion, descend
from harness.proof.plant.cases import draw
from harness.proof.plant.decrement import decrement
from harness.proof.score import forced

T = np.linspace(0.0, 5.0, 3000)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("channel", ["x", "a"])
def test_a_decay_without_noise_gives_its_numbers(channel: str, sign: float) -> None:
    x, _, a = decay_motion(T, 20.0, 0.02, 0.02, sign, 0.0)
    found = decrement(T, x if channel == "x" else a, channel)
    assert found.omega_n == pytest.approx(20.0, rel=0.01)
    assert found.zeta == pytest.approx(0.02, rel=0.1)
    assert found.x_k == pytest.approx(0.02, rel=0.1)
    assert found.plausible(20.0, 1.0)


@pytest.mark.parametrize("kind", ["control", "cubic-stiffness", "stribeck"])
def test_what_is_drawn_is_plausible_in_each_channel(kind: str) -> None:
    for seed in range(4):
        case = draw(kind, np.random.default_rng([5, seed]))
        for channel in case.channels:
            found = decrement(case.recorded["t"], case.recorded[channel], channel)
            assert found.plausible(case.base.omega_n, case.base.length)


TIMES = np.linspace(0.0, 4.0, 300)
TRUE = np.array([1.0, 0.4, 5.0, 0.3])
SEEN = TRUE[0] * np.exp(-TRUE[1] * TIMES) * np.cos(TRUE[2] * TIMES + TRUE[3]) + 0.01 * np.random.default_rng(1).normal(
    size=300
)


class Counted:
    """Residual of a damped cosine in units of its noise; counts what it is asked."""

    def __init__(self) -> None:
        self.calls = 0

    def __call__(self, z: FloatArray) -> FloatArray:
        self.calls += 1
        said = z[0] * np.exp(-z[1] * TIMES) * np.cos(z[2] * TIMES + z[3])
        return np.asarray((SEEN - said) / 0.01)


@pytest.mark.parametrize("start", [(1.3, 0.2, 4.8, 0.1), (0.7, 0.6, 5.2, 0.6), (1.0, 0.4, 5.0, 0.3)])
def test_the_minimum_is_that_of_scipy_and_costs_less(start: tuple[float, ...]) -> None:
    ours, theirs = Counted(), Counted()
    found = descend(ours, np.array(start), 1e-4, 30)
    known = least_squares(theirs, np.array(start), method="lm")
    assert found.chi2 == pytest.approx(2.0 * known.cost, abs=0.5)
    assert found.z == pytest.approx(known.x, rel=2e-2)
    assert ours.calls < 0.7 * theirs.calls


CONTROL: dict[str, Any] = {"mechanisms": [], "channels": "xa"}


def _said(x: float, a: float | None, verdict: str = "adequate") -> dict[str, Any]:
    after = {"x": x} if a is None else {"x": x, "a": a}
    block = {"name": "stribeck", "baseline_rmse": {"x": 1.0, "a": 2.0}, "refined_rmse": after}
    return {"verdict": verdict, "holdout": {"forced": block}}


def test_the_worst_channel_of_the_worst_control_counts() -> None:
    found = forced({"1": CONTROL, "2": CONTROL}, {"1": _said(1.01, 2.0), "2": _said(1.0, 2.08)})
    assert (found.cases, found.worst_file) == (2, "2")
    assert found.worst == pytest.approx(1.04)
    assert not found.above
    assert not found.shortfalls()


def test_what_is_withheld_counts_against_and_effects_do_not_count_at_all() -> None:
    truths = {"1": CONTROL, "2": CONTROL, "3": CONTROL, "4": {"mechanisms": ["stribeck"], "channels": "x"}}
    silent = {"verdict": "adequate", "holdout": {}}
    found = forced(truths, {"1": silent, "2": _said(1.0, None), "4": _said(9.0, 9.0)})
    assert found.withheld == ("1",)
    assert found.worst == math.inf
    assert found.named == ("3",)
    assert found.as_dict()["worst"] is None
    assert len(found.shortfalls()) == 2
