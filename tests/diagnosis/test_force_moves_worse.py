"""A model that says a force to its noise and moves worse than the base model explains nothing."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.diagnosis.inverse_dynamics import search as room
from harness.diagnosis.rules import PREDICTS_WORSE

X = np.sin(np.linspace(0.0, 20.0, 500))


def a_fit(missed: float) -> Any:
    """What shows the motion but for this share of it."""
    return SimpleNamespace(shown=SimpleNamespace(y={"x": (1.0 - missed) * X}))


@pytest.mark.parametrize(
    ("base", "found", "predicts"),
    [
        (0.2, 0.1, True),
        (0.2, 0.2, True),
        (0.2, 0.2 * 0.99 * PREDICTS_WORSE.value, True),
        (0.2, 0.2 * 1.01 * PREDICTS_WORSE.value, False),
        (0.2, 0.4, False),
        (1.3, 1.2, True),
        (1.3, 1.5, False),
    ],
)
def test_by_how_much_worse(base: float, found: float, predicts: bool) -> None:
    problem: Any = SimpleNamespace(channels={"x": X}, weight={"x": np.ones(X.size)})
    assert room._predicts(a_fit(found), a_fit(base), problem) is predicts
