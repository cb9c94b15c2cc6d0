"""Tables as terms: the spline they are made of, what they say at rest, where they are known; no search names one."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from harness.model.law import D_PARAMETER, INTERNAL_COLUMNS, VALUE
from harness.model.model import Model, ModelTerm, beyond
from harness.model.registry import NAMED, TERMS
from harness.model.spline import KNOTS, SIDE, curve, surface
from harness.model.term import Polynomial, Slot

TABLES = [t for t in TERMS if t.known is not None]
VALUES = np.array([1.0, -2.0, 0.5, 4.0, 3.0, -1.0, 0.0, 2.0, 5.0, -3.0, 1.5, 2.5])


def spline(u: float, values: np.ndarray = VALUES) -> tuple[float, float, np.ndarray]:
    out = np.zeros(INTERNAL_COLUMNS)
    value, slope = curve(u, 0, values, 0, out)
    return value, slope, out[D_PARAMETER:]


def test_the_spline_is_the_natural_one() -> None:
    known = CubicSpline(np.arange(KNOTS), VALUES, bc_type="natural")
    for u in np.linspace(0.0, KNOTS - 1.0, 57).tolist():
        value, slope, _ = spline(u)
        assert value == pytest.approx(known(u), abs=1e-12)
        assert slope == pytest.approx(known(u, 1), abs=1e-11)


def test_the_spline_is_linear_in_its_values() -> None:
    value, _, weights = spline(3.7)
    assert value == pytest.approx(weights[:KNOTS] @ VALUES)
    assert weights[:KNOTS].sum() == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("u", "last"), [(-0.5, VALUES[0]), (-1e300, VALUES[0]), (40.0, VALUES[-1]), (1e300, VALUES[-1])]
)
def test_beyond_its_ends_it_keeps_the_last_value(u: float, last: float) -> None:
    value, slope, _ = spline(u)
    assert value == pytest.approx(last)
    assert slope == 0.0


def test_no_number_is_no_place_in_memory() -> None:
    assert spline(float("nan"))[0] == VALUES[0]


def test_no_search_names_a_table() -> None:
    assert not {t.key for t in TABLES} & {t.key for t in NAMED}
    assert len({t.known for t in TABLES}) > 1
    assert not any(t.probes is not TABLES[0].probes or t.amplitude is not None for t in TABLES)


@pytest.mark.parametrize(
    "entry", [t for t in TABLES if t.known is not None and t.known.of in ("|v|", "v", "-v")], ids=lambda t: t.key
)
def test_a_resistance_by_speed_is_nothing_at_rest_and_never_jumps(entry: object) -> None:
    assert entry in TABLES
    term = next(t for t in TABLES if t is entry)
    assert term.law is not None
    for v in (0.0, 1e-12, -1e-12):
        out = np.zeros(INTERNAL_COLUMNS)
        term.law(0.3, v, np.array(term.example), 0, out)
        assert abs(out[VALUE]) < 1e-9


def test_what_is_not_known_is_said() -> None:
    table = next(t for t in TABLES if t.known is not None and t.known.of == "x" and t.slot is Slot.SMOOTH)
    model = Model(1.0, 0.1, 100.0, 0.1, x0=1.0).with_terms(ModelTerm(table, table.example))
    still = np.zeros(2)
    assert beyond(model, np.array([-1.2, 1.3]), still) == []
    (said,) = beyond(model, np.array([-1.2, 1.4]), still)
    assert "known from x = -1.2 to 1.3 m, and the motion reaches 1.4 m" in said
    (said,) = beyond(model, np.array([-1.3, 1.0]), still)
    assert "reaches -1.3 m" in said


def table(values: np.ndarray, low: float = -0.2, high: float = 0.3) -> ModelTerm:
    named = {f"f_{i + 1}": float(value) for i, value in enumerate(values)}
    return ModelTerm.named("tabulated-stiffness", **named, low=low, high=high)


def test_a_table_that_is_a_cubic_has_the_words_of_a_joint() -> None:
    """3 x - 40 x^2 + 500 x^3 at the knots; the spline between them bends a little less at its ends."""
    x = np.linspace(-0.2, 0.3, KNOTS)
    entry = table(3.0 * x - 40.0 * x**2 + 500.0 * x**3)
    assert entry.term.elements is not None
    (said,) = entry.term.elements(entry.values, 100.0)
    assert isinstance(said, Polynomial)
    a, b, c = said.stiffness
    force = 3.0 * x - 40.0 * x**2 + 500.0 * x**3
    assert a * x + b * x**2 + c * x**3 == pytest.approx(force, abs=0.01 * float(np.abs(force).max()))
    assert said.damping == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    "force",
    [
        pytest.param(lambda x: np.where(x > 0.1, 80.0 * (x - 0.1), 0.0), id="a stop"),
        pytest.param(lambda x: 2.0 + 30.0 * x, id="not 0 at x = 0"),
        pytest.param(lambda x: np.sin(60.0 * x), id="a ripple"),
        pytest.param(np.zeros_like, id="nothing"),
    ],
)
def test_what_a_cubic_would_only_come_near_has_none(force: Callable[[np.ndarray], np.ndarray]) -> None:
    entry = table(force(np.linspace(-0.2, 0.3, KNOTS)))
    assert entry.term.elements is not None
    assert not any(any(e.stiffness) for e in entry.term.elements(entry.values, 100.0) if isinstance(e, Polynomial))


def of_plane(p: float, q: float, values: np.ndarray) -> tuple[float, float, float, np.ndarray]:
    out = np.zeros(INTERNAL_COLUMNS)
    value, by_p, by_q = surface(p, q, values.ravel(), 0, out)
    return value, by_p, by_q, out[D_PARAMETER : D_PARAMETER + SIDE * SIDE]


GRID = np.random.default_rng(5).standard_normal((SIDE, SIDE))


def test_the_surface_is_the_natural_spline_along_both_sides() -> None:
    knots = np.arange(SIDE)
    along = CubicSpline(knots, GRID, axis=0, bc_type="natural")
    for p, q in np.random.default_rng(6).uniform(0.0, SIDE - 1.0, (40, 2)).tolist():
        across = CubicSpline(knots, along(p), bc_type="natural")
        slope = CubicSpline(knots, along(p, 1), bc_type="natural")
        value, by_p, by_q, weights = of_plane(p, q, GRID)
        assert value == pytest.approx(across(q), abs=1e-12)
        assert by_p == pytest.approx(slope(q), abs=1e-11)
        assert by_q == pytest.approx(across(q, 1), abs=1e-11)
        assert value == pytest.approx(weights @ GRID.ravel())
        assert weights.sum() == pytest.approx(1.0)


@pytest.mark.parametrize(("p", "q"), [(-3.0, 2.2), (2.2, 1e300), (-1e300, -1.0), (float("nan"), 2.2)])
def test_beyond_its_edge_a_surface_keeps_the_value_there(p: float, q: float) -> None:
    value, by_p, by_q, _ = of_plane(p, q, GRID)
    edge_p, edge_q = (0.0 if np.isnan(y) else min(max(y, 0.0), SIDE - 1.0) for y in (p, q))
    assert value == of_plane(edge_p, edge_q, GRID)[0]
    assert by_p == 0.0 or edge_p == p
    assert by_q == 0.0 or edge_q == q


def test_a_motion_that_leaves_the_oval_of_a_plane_is_said() -> None:
    (term,) = (t for t in TABLES if t.known is not None and t.known.of == "x, v")
    values = (*np.zeros(SIDE * SIDE).tolist(), -1.0, 3.0, 2.0, 1.1)
    model = Model(1.0, 0.1, 100.0, 0.1, x0=1.0).with_terms(ModelTerm(term, values))
    # the middle is at x = 1, half the way is 2
    assert beyond(model, np.array([3.0, 1.0, -1.0]), np.array([0.0, -2.0, 0.0])) == []
    (said,) = beyond(model, np.array([1.0, 3.0]), np.array([0.0, 2.0]))
    assert "x = 3 m at v = 2 m/s, 1.29 times as far out" in said
