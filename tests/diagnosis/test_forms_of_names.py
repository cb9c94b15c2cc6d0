"""One effect in another form than the catalogue's stays one name."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import harness
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.kernels.solve import solve
from harness.model.model import Model, ModelTerm

T = np.linspace(0.0, 6.0, 361)


def seen(x: FloatArray, noise: float) -> Recording:
    return Recording(T, {"x": x + noise * np.random.default_rng(5).standard_normal(T.size)})


def names(recording: Recording) -> list[str]:
    found = harness.diagnose(recording, restoring="spring", zero="spring", engines=())
    return [] if found.verdict != "missing_physics" else [one.name for one in found.mechanisms]


@pytest.mark.parametrize(("gap", "name"), [(0.05, "backlash"), (0.75, "end-stop")])
def test_what_stiffens_on_both_sides_is_play_from_near_the_middle_on_and_a_stop_near_the_ends(
    gap: float, name: str
) -> None:
    stop = ModelTerm.named("end-stop", gap=gap, k_stop=30.0)
    machine = Model(m=1.0, c=0.15, k=60.0, f_k=0.3, x0=1.0, terms=(stop,), mass_known=False)
    assert names(seen(solve(machine, T).x, 1e-4)) == [name]


def test_a_spring_that_relaxes_at_once_and_slowly_is_one_viscoelastic_spring() -> None:
    """Three branches of other stiffness each, without friction: a linear machine, by its matrix."""
    arms = ((3.0, 0.03), (2.0, 0.1), (1.5, 0.5))
    a = np.zeros((5, 5))
    a[0, 1], a[1, :2] = 1.0, (-60.0, -0.15)
    for i, (stiff, time) in enumerate(arms, 2):
        a[1, i], a[i, 1], a[i, i] = -stiff, 1.0, -1.0 / time
    state, step, x = np.array([1.0, 0.0, 0.0, 0.0, 0.0]), expm(a * T[1]), list[float]()
    for _ in T:
        x.append(float(state[0]))
        state = step @ state
    assert names(seen(np.array(x), 1e-5)) == ["viscoelastic"]


def rubbed(friction: Callable[[float, float], float]) -> FloatArray:
    """1 kg on 60 N/m with 0.15 N s/m, let go at 1 m, under a friction, N, of t and x; from one turning point on."""

    def law(t: float, state: FloatArray, way: float) -> list[float]:
        x, v = state
        return [v, -60.0 * x - 0.15 * v - way * friction(t, x)]

    def turns(t: float, state: FloatArray, way: float) -> float:
        return way * float(state[1])

    turns.terminal, turns.direction = True, -1.0  # type: ignore[attr-defined]
    t, state, way, x = 0.0, (1.0, 0.0), -1.0, np.full(T.size, np.nan)
    while t < T[-1]:
        run = solve_ivp(law, (t, T[-1]), state, args=(way,), events=turns, dense_output=True, rtol=1e-10, atol=1e-12)
        within = (t <= T) & (run.t[-1] >= T)
        x[within] = run.sol(T[within])[0]
        t, state, way = float(run.t[-1]), (float(run.y[0, -1]), 0.0), -way
    return x


def test_a_spring_across_a_weight_loads_its_guide_as_both_add_up_at_right_angles() -> None:
    """The guide bears 20 N of weight and, across it, the spring: friction of .015 of both."""
    x = rubbed(lambda t, x: 0.015 * math.hypot(20.0, 60.0 * x))
    found = harness.diagnose(seen(x, 1e-4), restoring="spring", zero="spring", engines=())
    (one,) = found.mechanisms
    assert (found.verdict, one.name) == ("missing_physics", "load-dependent-friction")
    assert one.parameters["gain_2"].value == pytest.approx((60.0 / 20.0) ** 2, rel=0.05)
    assert found.refined.parameters["x_k"].value == pytest.approx(0.015 * 20.0 / 60.0, rel=0.02)


def test_friction_that_wears_off_ever_more_slowly_is_no_law_of_the_amplitude() -> None:
    """From .6 N to .3 N in 1.5 s, as of a guide that warms; a drag follows it more nearly than an even pace does."""
    x = rubbed(lambda t, x: 0.3 * (1.0 + math.exp(-t / 1.5)))
    found = harness.diagnose(seen(x, 1e-4), restoring="spring", zero="spring", engines=())
    assert found.mechanisms[0].name == "friction-drift"
    slowing = found.mechanisms[0].parameters["slowing"]
    assert slowing.value == pytest.approx(1.0 / 1.5, rel=0.1)


def test_a_load_that_sways_flatter_than_a_cosine_has_one_name() -> None:
    x = rubbed(lambda t, x: 0.3 * (1.0 + 0.5 * math.tanh(2.0 * math.sin(4.0 * t))))
    found = harness.diagnose(seen(x, 2e-5), restoring="spring", zero="spring", engines=())
    (one,) = found.mechanisms
    assert (found.verdict, one.name) == ("missing_physics", "normal-load-variation")
    assert one.parameters["Omega"].value == pytest.approx(4.0, rel=2e-3)
    assert one.parameters["depth"].value == pytest.approx(0.5 * math.tanh(2.0), rel=0.03)


C, F_K, K = 0.1, 0.4, 40.0


def dahl_squared(w: float) -> float:
    """What a bristle at the share w of its full deflection gains of a way; Dahl 1968, with an exponent of two."""
    return (1.0 - w) * abs(1.0 - w)


def elasto_plastic(w: float) -> float:
    """The same, elastic up to a third and whenever it is let back (Dupont and others 2002)."""
    r = min(max((w - 0.33) / 0.67, 0.0), 1.0)
    return 1.0 - r * r * (3.0 - 2.0 * r) * w


def on_bristles(gains: Callable[[float], float], bends: float) -> FloatArray:
    """1 kg on a spring, let go at .3 m, whose bristles bend so far, m, until it slides."""

    def law(t: float, state: FloatArray) -> list[float]:
        x, v, z = state
        way = gains(math.copysign(z / bends, z * v))
        return [v, -K * x - C * v - F_K * z / bends, v * way]

    found = solve_ivp(law, (0.0, T[-1]), (0.3, 0.0, 0.0), rtol=1e-8, atol=1e-10, max_step=5e-3, dense_output=True)
    x: FloatArray = found.sol(T)[0]
    return x


@pytest.mark.parametrize(("gains", "near"), [(dahl_squared, 0.005), (elasto_plastic, 0.06)])
def test_bristles_of_any_form_are_one_name_and_leave_the_other_numbers_right(
    gains: Callable[[float], float], near: float
) -> None:
    recording = seen(on_bristles(gains, 0.006), 1e-5)
    found = harness.diagnose(recording, restoring="spring", zero="spring", engines=())
    assert found.mechanisms[0].name == "presliding"
    for name, truth in (("zeta", C / (2.0 * math.sqrt(K))), ("x_k", F_K / K)):
        assert found.refined.parameters[name].value == pytest.approx(truth, rel=near)


def without_friction(law: Callable[[float, float], float], x0: float) -> FloatArray:
    """1 kg under a law of x and v, on the left, let go at x0, m."""
    found = solve_ivp(lambda t, s: [s[1], -law(s[0], s[1])], (0.0, T[-1]), (x0, 0.0), rtol=1e-9, atol=1e-12, t_eval=T)
    x: FloatArray = found.y[0]
    return x


def test_a_valve_that_is_squared_one_way_is_damping_that_differs_by_direction() -> None:
    recording = seen(without_friction(lambda x, v: K * x + C * v + 0.15 * max(v, 0.0) ** 2, 0.3), 1e-5)
    found = harness.diagnose(recording, restoring="spring", zero="spring", engines=())
    (one,) = found.mechanisms
    assert (found.verdict, one.name) == ("missing_physics", "asymmetric-viscous")
    for name, truth in (("c_diff", 0.15), ("exponent", 2.0)):
        said = one.parameters[name]
        assert said.stderr is not None
        assert said.value == pytest.approx(truth, abs=3.0 * said.stderr), name
    assert found.refined.parameters["zeta"].value == pytest.approx(C / (2.0 * math.sqrt(K)), rel=0.02)


def test_a_column_of_gas_is_a_spring_whose_sides_differ() -> None:
    """At one temperature, F h/(h + x) of a column that is h long presses back: K = F/h beside x^2/(1 + x/h)."""
    h = 0.5
    recording = seen(without_friction(lambda x, v: K * h * (1.0 - h / (h + x)) + C * v, 0.2), 1e-5)
    found = harness.diagnose(recording, restoring="spring", zero="spring", engines=())
    (one,) = found.mechanisms
    assert (found.verdict, one.name) == ("missing_physics", "quadratic-stiffness")
    for name, truth in (("k2", -K / h), ("closing", 1.0 / h)):
        said = one.parameters[name]
        assert said.stderr is not None
        assert said.value == pytest.approx(truth, abs=3.0 * said.stderr), name
