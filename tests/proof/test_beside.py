"""Baselines on the proof's recordings: each finds what it is made for in a balance of forces, and nothing in noise."""

from collections.abc import Callable

import numpy as np
import pytest

from benchmarks.beside import Balance, by_lasso, by_process, by_r2, by_regression, by_stlsq, table


def _balance(cubic: float) -> Balance:
    """A mass on a spring with friction and a cubic law of such size, beside noise of a hundredth."""
    t = np.linspace(0.0, 20.0, 1200)
    x = np.sin(3.0 * t) + 0.4 * np.sin(5.1 * t)
    v = np.gradient(x, t)
    base = {"c": v, "f_k": np.sign(v), "m": np.gradient(v, t), "k": x}
    noise = 0.01 * np.random.default_rng(1).standard_normal(t.size)
    y = 0.3 * v + 0.5 * np.sign(v) + base["m"] + 9.0 * x + cubic * x**3 + noise
    laws = {"cubic-stiffness": x**3, "quadratic-drag": v * np.abs(v), "friction-drift": t * np.sign(v)}
    return Balance(y, base, laws, x, v, t, 120.0)


@pytest.mark.parametrize("namer", [by_r2, by_lasso, by_stlsq])
def test_a_law_is_named_and_noise_is_not(namer: Callable[[Balance], list[str]]) -> None:
    pytest.importorskip("pysindy")
    assert "cubic-stiffness" in namer(_balance(0.2))
    assert namer(_balance(0.0)) == []


def test_a_process_tells_noise_from_what_is_smooth() -> None:
    pytest.importorskip("sklearn")
    assert by_process(_balance(0.2))
    assert not by_process(_balance(0.0))


def test_plain_regression_has_the_friction_and_its_errors() -> None:
    found = by_regression(_balance(0.0))
    for name, true in (("c", 0.3), ("f_k", 0.5)):
        value, error = found[name]
        assert abs(value - true) < 4.0 * error


def test_a_margin_is_paired() -> None:
    said = [{("who", "what"): (1.0, 0.0)}, {("who", "what"): (0.0, 0.0)}, {}]
    (line,) = table(said).splitlines()[1:]
    assert line.split()[2:6] == ["2", "0.50", "0.00", "+0.50"]
