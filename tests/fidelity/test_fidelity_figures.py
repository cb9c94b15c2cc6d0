"""Rows of the matrix against figures that engines are known by, on every route."""

import pytest

from harness.engines import registry
from harness.engines.base import Preset, Route
from harness.fidelity.kind import Metrics, suite
from harness.fidelity.row import Spec, run_row


def metrics(engine: str, route: Route, base: Preset, dt: float | None, scenario: str, **changed: object) -> Metrics:
    found = registry.load(engine)
    case = suite(route)[scenario]
    row = run_row(found, Spec(engine, found.version(), route, "x", base, tuple(changed.items()), dt, case))
    assert row.error is None
    return row.metrics


def agrees(value: float | None, printed: str, scale: float = 1.0) -> bool:
    """Within 5 % or one unit of the last printed digit."""
    assert value is not None
    expected = float(printed)
    unit = 10.0 ** -len(printed.partition(".")[2])
    return abs(scale * value - expected) <= max(0.05 * abs(expected), unit * (1.0 + 1e-9))


@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
@pytest.mark.parametrize("route", ["joint", "contact", "law"])
def test_belt(engine: str, route: Route) -> None:
    # PyBullet's contact takes 500 iterations a step, so its step is the coarse one
    dt = 1.0 / 240.0 if (engine, route) == ("pybullet", "contact") else 1e-3
    found = metrics(engine, route, "tuned", dt, "belt")
    assert agrees(found["period_s"], "0.6658")
    assert agrees(found["near_belt_fraction"], "0.286")


def test_belt_converges_where_break_away_is_read_from_the_force() -> None:
    found = metrics("mujoco", "joint", "tuned", 1e-4, "belt")
    assert found["period_s"] == pytest.approx(0.6659, abs=1e-4)


@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
@pytest.mark.parametrize(("route", "amplitude_mm"), [("joint", "262.610"), ("contact", "26.261"), ("law", "262.610")])
def test_harmonic(engine: str, route: Route, amplitude_mm: str) -> None:
    dt = 1.0 / 240.0 if (engine, route) == ("pybullet", "contact") else 1e-3
    assert agrees(metrics(engine, route, "tuned", dt, "harmonic")["amplitude_m"], amplitude_mm, 1e3)


@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
def test_stops_last_as_long_as_they_should(engine: str) -> None:
    found = metrics(engine, "joint", "tuned", 1e-3, "harmonic-stops")
    assert found["stop_fraction"] == pytest.approx(0.3711, abs=0.003)


def test_a_pyramidal_cone_creeps_like_an_elliptic_one() -> None:
    # both fall as 1/impratio; the pyramid's creep is a tenth larger
    for ratio in (1.0, 10.0, 100.0):
        pyramid = metrics("mujoco", "contact", "as-shipped", 1e-3, "hold-50", impratio=ratio)["creep_m_s"]
        assert agrees(pyramid, "433", 1e6 * ratio)


def test_a_stiff_contact_throws_a_fast_box_up() -> None:
    changed = {"cone": "elliptic", "solref": (0.002, 1.0), "solimp": (0.9999, 0.9999, 0.001, 0.5, 2.0)}
    fast = metrics("mujoco", "contact", "as-shipped", 1e-3, "free-decay-x10", **changed)["lift_m"]
    slow = metrics("mujoco", "contact", "as-shipped", 1e-3, "free-decay", **changed)["lift_m"]
    assert fast is not None
    assert slow is not None
    assert 0.170 < fast < 0.250
    assert slow < 1e-4


def test_what_cannot_run_is_a_row_with_its_reason() -> None:
    engine = registry.load("mujoco")
    case = suite("joint")["free-decay"]
    for changed, dt, message in (
        ((("integrator", "Verlet"),), 1e-3, "one of Euler, RK4"),
        ((("no_such", 1),), 1e-3, "mujoco setting no_such: unknown"),
        ((), 0.3, "diverged"),
    ):
        row = run_row(engine, Spec("mujoco", "x", "joint", "bad", "as-shipped", changed, dt, case))
        assert row.error is not None
        assert message in row.error
        assert row.metrics == {}
