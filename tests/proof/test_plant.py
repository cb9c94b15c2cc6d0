"""The plant against closed forms: decrements, descents, static friction, a driven one."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares

from benchmarks.calibrate.static_force import static_force
from harness.core.arrays import FloatArray
from harness.proof.plant.base_fit import decay_motion, descend
from harness.proof.plant.cases import draw
from harness.proof.plant.decrement import Decrement, decrement
from harness.proof.score import LARGEST, forced

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
    x, *_ = decay_motion(np.linspace(0.0, 0.4, 300), 20.0, 0.02, 0.02, 1.0, 0.0)
    assert math.isnan(decrement(np.linspace(0.0, 0.4, 300), x, "x").omega_n)


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


def test_it_stops_where_there_is_no_point_in_going_on() -> None:
    start = np.array([1.3, 0.2, 4.8, 0.1])
    whole, short = Counted(), Counted()
    best = descend(whole, start, 1e-4, 30)
    bound = 10.0 * best.chi2
    found = descend(short, start, 1e-4, 30, bounds=(bound, math.inf))
    assert best.chi2 < found.chi2 < bound
    assert short.calls < whole.calls


def test_what_lies_beyond_doubt_is_left_with_less_care() -> None:
    start = np.array([1.3, 0.2, 4.8, 0.1])
    careless = Counted()
    found = descend(careless, start, 1e-4, 30, bounds=(-math.inf, 1.0))
    assert found.chi2 < 1.5 * descend(Counted(), start, 1e-4, 30).chi2


OMEGA, LENGTH, X_K = 10.0, 0.5, 0.02
"""m = 1 kg, so that k = 100 N/m, the scale of the speed is 5 m/s and f_k = 2 N."""


def answer(form: str, at: FloatArray, plant: dict[str, dict[str, Any]]) -> dict[str, Any]:
    base = {"m": 1.0, "omega_n": OMEGA, "zeta": 0.01, "x_k": X_K, "x0": -LENGTH, "options": ["--restoring", "spring"]}
    return {**base, "plant": plant, "table": {"form": form, "at": at.tolist(), "force": [0.0] * at.size}}


IN_TIME = {"harmonic-force": {"amplitude": 3.0, "Omega": 2.0, "phase": 0.1}, "stiffness-drift": {"rate": 0.2}}
SOFT = {"alien-softening": {"size": 4.0, "width": 0.3}}
DRAG = {"quadratic-drag": {"c2": 0.7}}
CUBIC = {"cubic-stiffness": {"k3": -5.0}}
RUBS = {"alien-edge-rub": {"size": 0.4}}
BOTH = {"alien-position-viscous": {"size": 1.5}}


def test_a_table_over_position_measures_every_spring() -> None:
    x = np.linspace(-0.5, 0.4, 31)
    found = static_force(answer("f(x)", x, {**SOFT, **CUBIC, **DRAG, **RUBS, **BOTH, **IN_TIME}))
    assert found == pytest.approx(4.0 * np.tanh(x / 0.3) - 5.0 * x**3)


def test_a_table_over_speed_measures_every_damper_and_friction_that_falls() -> None:
    v = np.linspace(-3.0, 4.0, 32)
    stribeck = {"stribeck": {"f_s": 2.6, "v_s": 0.8}}
    pushed = {"constant-force": {"force": 1.0}}
    found = static_force(answer("f(v)", v, {**SOFT, **DRAG, **BOTH, **IN_TIME, **stribeck, **pushed}))
    assert found == pytest.approx(0.7 * v * np.abs(v) + 0.6 * np.sign(v) * np.exp(-((v / 0.8) ** 2)))


def test_a_table_of_friction_by_position_measures_what_rubs() -> None:
    x = np.linspace(-0.5, 0.5, 31)
    sloped = {"position-dependent-friction": {"slope": 0.3}}
    found = static_force(answer("g(x) sgn v", x, {**SOFT, **RUBS, **sloped, "friction-drift": {"rate": 0.1}}))
    rubs = 1.0 + 0.4 * (x / LENGTH) ** 4 / 2.0
    assert found == pytest.approx(2.0 * (rubs * (1.0 + 0.3 * x) - 1.0))


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


def test_a_ratio_above_the_bound_is_a_shortfall() -> None:
    found = forced({"1": CONTROL, "2": CONTROL}, {"1": _said(LARGEST + 0.01, 2.0), "2": _said(1.0, 2.0)})
    assert found.above == ("1",)
    assert len(found.shortfalls()) == 1


def test_what_is_withheld_counts_against_and_effects_do_not_count_at_all() -> None:
    truths = {"1": CONTROL, "2": CONTROL, "3": CONTROL, "4": {"mechanisms": ["stribeck"], "channels": "x"}}
    silent = {"verdict": "adequate", "holdout": {}}
    found = forced(truths, {"1": silent, "2": _said(1.0, None), "4": _said(9.0, 9.0)})
    assert found.withheld == ("1",)
    assert found.worst == math.inf
    assert found.named == ("3",)
    assert found.as_dict()["worst"] is None
    assert len(found.shortfalls()) == 2


def test_without_controls_there_is_nothing_to_say_and_that_is_a_shortfall() -> None:
    assert forced({}, {}).shortfalls() == ["no control with a term forced in"]
