"""What a law takes beside another: known squares of known columns."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.arrays import FloatArray
from harness.diagnosis.search.against import in_company

N = 40
E = np.eye(N)


def base(residual: FloatArray, partials: FloatArray | None = None) -> Any:
    return SimpleNamespace(residual=residual, jacobian=np.zeros((N, 1)) if partials is None else partials)


def law(before: Any, change: FloatArray) -> Any:
    return SimpleNamespace(residual=before.residual - change)


def test_alone_it_takes_all_that_it_takes() -> None:
    before = base(3.0 * E[0] + 4.0 * E[1])
    assert in_company(law(before, 3.0 * E[0]), [], before) == pytest.approx(9.0)


def test_what_nothing_else_takes_it_keeps() -> None:
    """3 and 4 across each other: each keeps its own, 9 and 16."""
    before = base(3.0 * E[0] + 4.0 * E[1])
    one, other = law(before, 3.0 * E[0]), law(before, 4.0 * E[1])
    assert in_company(one, [other], before) == pytest.approx(9.0)
    assert in_company(other, [one], before) == pytest.approx(16.0)


def test_a_sum_of_two_shares_with_each_of_them() -> None:
    """The sum takes 2 first and 1 after one of its halves: 3/2; the half 1 first and nothing last: 1/2."""
    before = base(E[0] + E[1])
    both, half = law(before, E[0] + E[1]), law(before, E[0])
    assert in_company(both, [half], before) == pytest.approx(1.5)
    assert in_company(half, [both], before) == pytest.approx(0.5)


def test_of_several_others_the_one_counts_with_which_it_leaves_least() -> None:
    """Beside a part of itself it would keep 1.125; beside what it leaves, and nothing is left then, 1.25."""
    before = base(E[0] + 2.0 * E[1] + 0.5 * E[2])
    one, part, rest = (law(before, change) for change in (E[0] + 0.5 * E[2], E[2], 2.0 * E[1]))
    assert in_company(one, [part], before) == pytest.approx(1.125)
    assert in_company(one, [part, rest], before) == pytest.approx(1.25)


def test_sizes_are_free() -> None:
    before = base(3.0 * E[0] + 4.0 * E[1])
    one, other = law(before, E[0] + E[1]), law(before, E[1])
    assert in_company(law(before, -7.0 * (E[0] + E[1])), [law(before, 0.01 * E[1])], before) == pytest.approx(
        in_company(one, [other], before)
    )


def test_what_the_base_can_do_itself_is_not_counted() -> None:
    before = base(3.0 * E[0], partials=np.column_stack([E[1], 2.0 * E[1], np.zeros(N)]))
    assert in_company(law(before, 3.0 * E[0] + 5.0 * E[1]), [], before) == pytest.approx(9.0)
    assert in_company(law(before, E[1]), [], before) == pytest.approx(0.0, abs=1e-20)


def test_a_law_that_changes_nothing_takes_nothing() -> None:
    before = base(E[0])
    assert in_company(law(before, np.zeros(N)), [law(before, E[0])], before) == pytest.approx(0.0, abs=1e-12)
    assert in_company(law(before, E[0]), [law(before, np.zeros(N))], before) == pytest.approx(1.0)


@given(seed=st.integers(0, 2**31), others=st.integers(0, 5), partials=st.integers(1, 6))
def test_it_is_between_nothing_and_all(seed: int, others: int, partials: int) -> None:
    rng = np.random.default_rng(seed)
    before = base(rng.standard_normal(N), rng.standard_normal((N, partials)))
    laws = [law(before, rng.standard_normal(N)) for _ in range(others + 1)]
    taken = in_company(laws[0], laws[1:], before)
    assert -1e-9 <= taken <= float(before.residual @ before.residual) + 1e-9
