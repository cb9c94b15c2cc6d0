"""A search ends where its budget of work does, at the same place with any number of threads, and says so."""

import numpy as np
import pytest

import harness
from harness.core.budget import Budget, allowed, counted, given, spend
from harness.core.cores import each
from harness.core.errors import InputError, SimulationError
from harness.model.model import Model, ModelTerm


def test_what_pieces_beside_one_another_may_do_does_not_hang_on_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    def work(size: int) -> int:
        done = 0
        try:
            for _ in range(size):
                allowed(1)
                spend(10)
                done += 10
        except SimulationError:
            pass
        return done

    found = {}
    for threads in ("1", "2"):
        monkeypatch.setenv("HARNESS_THREADS", threads)
        budget = Budget(1000.0)
        with given(budget), counted():
            found[threads] = (each(work, [1, 2, 90, 3, 90, 4, 5, 6]), each(work, [90, 1]), budget.spent, budget.ended)
    assert found["1"] == found["2"]
    assert found["1"][0] == [10, 20, 500, 30, 500, 40, 50, 60]
    assert found["1"][1] == [0, 0]
    assert found["1"][3]


def test_nothing_is_counted_where_no_search_is() -> None:
    budget = Budget(0.0)
    with given(budget):
        harness.simulate(Model(1.0, 0.3, 150.0, 0.1, x0=0.05), np.linspace(0.0, 1.0, 50))
    assert (budget.spent, budget.ended) == (0, False)


def test_a_search_that_its_budget_ended_gives_the_best_so_far_and_says_so() -> None:
    t = np.arange(0.0, 5.0, 1.0 / 80.0)
    drag = ModelTerm.named("quadratic-drag", c2=2.0)
    x = harness.simulate(Model(1.0, 0.3, 150.0, 0.1, x0=0.05, terms=(drag,), mass_known=False), t).x
    recording = harness.Recording(t, {"x": x + 2e-5 * np.random.default_rng(5).standard_normal(t.size)}, "made")
    found = harness.diagnose(recording, zero="spring", engines=(), budget=0.05)
    assert found.bounded
    assert "--budget" in found.warnings[0]
    assert found.settings["budget_s"] == 0.05


def test_a_budget_is_positive() -> None:
    recording = harness.Recording(np.arange(60.0), {"x": np.cos(np.arange(60.0))}, "made")
    with pytest.raises(InputError, match="--budget"):
        harness.diagnose(recording, budget=0.0)
