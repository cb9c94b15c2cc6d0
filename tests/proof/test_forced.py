"""Controls with a term forced in: the worst ratio counts, and what is withheld counts against."""

import math
from typing import Any

import pytest

from harness.proof.score import LARGEST, forced

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
