"""The decrement at a glance: right where nothing is hidden, and it looks twice at what nobody would believe."""

import math

import numpy as np
import pytest

from harness.proof.plant.base_fit import decay
from harness.proof.plant.cases import draw
from harness.proof.plant.decrement import Decrement, decrement

T = np.linspace(0.0, 5.0, 3000)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("channel", ["x", "a"])
def test_a_decay_without_noise_gives_its_numbers(channel: str, sign: float) -> None:
    x, a = decay(T, 20.0, 0.02, 0.02, sign, 0.0)
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


@pytest.mark.parametrize(
    "odd",
    [
        Decrement(math.nan, 0.02, 0.01),
        Decrement(21.5, 0.02, 0.01),
        Decrement(20.0, -0.001, 0.01),
        Decrement(20.0, 0.11, 0.01),
        Decrement(20.0, 0.02, -0.001),
        Decrement(20.0, 0.02, 0.2),
    ],
)
def test_what_looks_odd_is_not_plausible(odd: Decrement) -> None:
    assert not odd.plausible(20.0, 1.0)


def test_too_few_half_cycles_say_nothing() -> None:
    x, _ = decay(np.linspace(0.0, 0.4, 300), 20.0, 0.02, 0.02, 1.0, 0.0)
    assert math.isnan(decrement(np.linspace(0.0, 0.4, 300), x, "x").omega_n)
