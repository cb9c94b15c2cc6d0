"""Every law's partial derivatives against differences of the plain function, and the generated dispatch."""

from collections.abc import Callable

import numpy as np
import pytest
from kernel_cases import VALUES

from harness.core.arrays import FloatArray
from harness.kernels import generate
from harness.kernels.layout import INTERNAL, MODULATIONS, SMOOTH
from harness.model.law import (
    COLUMNS,
    D_INTERNAL,
    D_MASS,
    D_PARAMETER,
    D_STIFFNESS,
    D_T,
    D_V,
    D_X,
    FIRST_TERM,
    INTERNAL_COLUMNS,
    MASS,
    STIFFNESS,
    V_SCALE,
    VALUE,
)
from harness.model.term import Slot, Term

POINTS = np.random.default_rng(3).uniform(-1.3, 1.3, (25, 5))
STEP = 1e-6


def theta_of(term: Term) -> FloatArray:
    theta = np.zeros(FIRST_TERM + 3)
    theta[[MASS, STIFFNESS, V_SCALE]] = 1.7, 80.0, 5.0
    theta[FIRST_TERM : FIRST_TERM + len(term.parameters)] = VALUES[term.key]
    return theta


def check(value: Callable[[FloatArray], FloatArray], at: FloatArray, columns: list[int], partials: FloatArray) -> None:
    """Compare the named columns with central differences of ``value`` by each coordinate of ``at``."""
    for i, column in enumerate(columns):
        shift = np.zeros_like(at)
        shift[i] = STEP * max(1.0, abs(at[i]))
        difference = (value(at + shift) - value(at - shift)) / (2.0 * shift[i])
        size = np.abs(partials[..., column]).max() + np.abs(value(at)).max() + 1.0
        assert np.abs(partials[..., column] - difference).max() < 1e-7 * size, column


@pytest.mark.parametrize("term", [*SMOOTH, *MODULATIONS], ids=lambda t: t.key)
def test_partials_of_a_smooth_law(term: Term) -> None:
    theta, law = theta_of(term), term.law
    assert law is not None
    places = [MASS, STIFFNESS, *range(FIRST_TERM, FIRST_TERM + len(term.parameters))]
    columns = [D_X, D_V, D_T, D_MASS, D_STIFFNESS, *range(D_PARAMETER, D_PARAMETER + len(term.parameters))]

    def row(at: FloatArray) -> FloatArray:
        changed, out = theta.copy(), np.zeros(COLUMNS)
        changed[places] = at[3:]
        law(float(at[0]), float(at[1]), float(at[2]), changed, FIRST_TERM, out)
        return out

    for x, v, t, _, _ in POINTS:
        at = np.array([x, v, t, *theta[places]])
        check(lambda a: row(a)[VALUE : VALUE + 1], at, columns, row(at)[None, :])


@pytest.mark.parametrize("term", INTERNAL, ids=lambda t: t.key)
def test_partials_of_a_law_with_internal_states(term: Term) -> None:
    theta, law = theta_of(term), term.law
    assert law is not None
    places = [MASS, *range(FIRST_TERM, FIRST_TERM + len(term.parameters))]
    columns = [D_X, D_V, D_INTERNAL, D_INTERNAL + 1, D_MASS, *range(D_PARAMETER, D_PARAMETER + len(term.parameters))]

    def rows(at: FloatArray) -> FloatArray:
        changed, out = theta.copy(), np.zeros((3, INTERNAL_COLUMNS))
        changed[places] = at[4:]
        law(*(float(value) for value in at[:4]), changed, FIRST_TERM, out)
        return out

    for x, v, _, w0, w1 in POINTS:
        at = np.array([x, v, w0, w1, *theta[places]])
        check(lambda a: rows(a)[:, VALUE], at, columns, rows(at))


def test_the_dispatch_is_the_one_of_the_registry() -> None:
    assert generate.TARGET.read_text(encoding="utf-8") == generate.text(), "run python -m harness.kernels.generate"


def test_every_term_with_a_law_of_its_own_is_dispatched() -> None:
    from harness.model.registry import TERMS

    dispatched = {*SMOOTH, *MODULATIONS, *INTERNAL}
    assert dispatched == {term for term in TERMS if term.law is not None}
    assert {t.slot for t in dispatched} == {Slot.SMOOTH, Slot.FRICTION_MODULATION, Slot.INTERNAL}
