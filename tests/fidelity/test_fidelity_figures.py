"""Rows of the matrix against figures that engines are known by, on every route."""

import re
from pathlib import Path

import pytest

from harness.app.sweep.regress import load_baseline
from harness.engines import registry
from harness.engines.base import Preset, Route
from harness.fidelity.compare import slope
from harness.fidelity.kind import Metrics, suite
from harness.fidelity.row import Spec, run_row

PUBLISHED = Path(__file__).resolve().parents[2] / "reports" / "fidelity" / "baseline.json"


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


def test_as_shipped_mujoco_creeps_at_1583_micrometres_a_second() -> None:
    assert agrees(metrics("mujoco", "joint", "as-shipped", None, "hold-50")["creep_m_s"], "1583", 1e6)


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


ORDERS: list[tuple[str, Preset, dict[str, object], float]] = [
    ("mujoco", "as-shipped", {}, 1.0),
    ("mujoco", "tuned", {}, 4.0),
    ("pybullet", "tuned", {}, 2.0),
]


@pytest.mark.parametrize(("engine", "base", "changed", "order"), ORDERS)
def test_order_of_convergence_without_friction(
    engine: str, base: Preset, changed: dict[str, object], order: float
) -> None:
    steps = (4e-3, 2e-3, 1e-3)
    errors = [
        metrics(engine, "joint", base, dt, "free-decay-no-friction", **changed)["max_error_m"] or 0.0 for dt in steps
    ]
    measured, spread = slope(steps, errors)
    assert measured == pytest.approx(order, abs=0.1)
    assert spread < 1.05


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


PRINTED = [
    ("mujoco/joint/as-shipped/integrator=implicitfast/dt=0.001/free-decay", "12.8", "-1.15"),
    ("mujoco/joint/as-shipped/integrator=RK4/dt=0.0001/free-decay", "13.6", "-1.16"),
    ("mujoco/joint/as-shipped/integrator=discrete/dt=0.001/free-decay", "30.3", "0.86"),
    ("mujoco/joint/stiff/integrator=implicitfast,{}=0.002 1/dt=0.001/free-decay", "4.17", "-1.1e-4"),
    ("mujoco/joint/stiff/integrator=RK4,{}=0.002 1/dt=0.001/free-decay", "1.39", "-1.1e-4"),
    ("mujoco/joint/stiff/integrator=RK4,{}=0.0002 1/dt=0.0001/free-decay", "0.14", "-1.1e-5"),
    ("mujoco/joint/stiff/integrator=discrete,{}=0.002 1/dt=0.001/free-decay", "27.7", "2e-4"),
    ("mujoco/joint/tuned/dt=0.001/free-decay", "0.69", "-5.5e-5"),
    ("pybullet/joint/undamped/leapfrog=False/dt=0.00416667/free-decay", "20.2", "0"),
    ("pybullet/joint/undamped/leapfrog=False/dt=0.001/free-decay", "4.84", "0"),
    ("pybullet/joint/undamped/leapfrog=False/dt=0.0001/free-decay", "0.48", "0"),
    ("pybullet/joint/as-shipped/dt=0.001/free-decay", "67.7", "0"),
    ("mujoco/joint/as-shipped/dt=0.001/free-decay-no-friction", "4.30", None),
    ("mujoco/joint/as-shipped/integrator=implicitfast/dt=0.001/free-decay-no-friction", "4.30", None),
    ("mujoco/joint/as-shipped/integrator=RK4/dt=0.001/free-decay-no-friction", "6e-7", None),
    ("mujoco/joint/as-shipped/integrator=discrete/dt=0.001/free-decay-no-friction", "35", None),
]


def within(value: float, printed: str) -> bool:
    """As ``agrees``, for figures with an exponent too; a printed 0 means below 1e-3 of the unit."""
    mantissa, _, exponent = printed.partition("e")
    unit = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
    if float(printed) == 0.0:
        return abs(value) < 1e-3
    return abs(value - float(printed)) <= max(0.05 * abs(float(printed)), unit * (1.0 + 1e-9))


@pytest.mark.parametrize(("name", "error_mm", "creep_mm_s"), PRINTED, ids=[row[0] for row in PRINTED])
def test_the_published_rows_hold_the_known_figures(name: str, error_mm: str, creep_mm_s: str | None) -> None:
    # a published row is named with its engine's version; the figures are those of the engine
    rows = {re.sub(r"@[^/]*", "", row, count=1): found for row, found in load_baseline(PUBLISHED).rows.items()}
    found = rows[name.format("solimpfriction=0.9999 0.9999 0.001 0.5 2,solreffriction")].metrics
    error, creep = found["max_error_m"], found["creep_m_s"]
    assert error is not None
    assert within(1e3 * error, error_mm)
    if creep_mm_s is not None:
        assert creep is not None
        assert within(1e3 * creep, creep_mm_s)
