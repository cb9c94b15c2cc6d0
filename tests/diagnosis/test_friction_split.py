"""From which shares of dry and viscous friction fits are begun again, and which fits are: by known answers."""

import math
from dataclasses import dataclass, field
from typing import Any

import pytest

from harness.core.errors import SimulationError
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.grading import friction_split
from harness.diagnosis.grading.friction_split import _best, _others, resplit
from harness.kernels.solve import Scales
from harness.model.model import Model

MODEL = Model(m=1.0, c=0.4, k=64.0, f_k=0.3)
SCALES = Scales(x=0.5, v=4.0, omega=8.0)


@dataclass
class Fake:
    """A fit by what is asked of it."""

    chi2: float
    model: Model = MODEL
    free: Any = field(default_factory=lambda: free_of(MODEL, ("c", "k", "f_k")))


def loss(model: Model) -> float:
    """Of a cycle at half the amplitude: 4 f_k X + pi c omega X^2."""
    swing = 0.5 * SCALES.x
    return 4.0 * model.f_k * swing + math.pi * model.c * SCALES.omega * swing**2


def test_every_start_loses_as_much_a_cycle_and_one_has_no_dry_friction() -> None:
    found = list(_others(MODEL, SCALES))
    assert [one.f_k for one in found] == [0.0, 0.15]
    assert [loss(one) for one in found] == pytest.approx([loss(MODEL)] * 2)


def test_where_there_is_no_dry_friction_half_of_the_damping_becomes_it() -> None:
    for f_k in (0.0, 1e-3):
        (one,) = _others(Model(m=1.0, c=0.4, k=64.0, f_k=f_k), SCALES)
        assert one.c == pytest.approx(0.2)
        assert loss(one) == pytest.approx(loss(Model(m=1.0, c=0.4, k=64.0, f_k=0.0)))


class Fits:
    """Stands for ``fit``: each leaves the next of these; keeps what it was asked."""

    def __init__(self, *chi2: float) -> None:
        self.left, self.asked = list(chi2), list[Any]()

    def __call__(self, model: Model, problem: Any, free: Any, scales: Scales, iterations: int, thorough: bool) -> Fake:
        self.asked.append((model.f_k, iterations, thorough))
        if not self.left:
            raise SimulationError("no end")
        return Fake(self.left.pop(0))


def asked(monkeypatch: pytest.MonkeyPatch, *chi2: float) -> Fits:
    fits = Fits(*chi2)
    monkeypatch.setattr(friction_split, "fit", fits)
    return fits


def test_rounds_go_on_while_they_come_nearer_by_a_tenth(monkeypatch: pytest.MonkeyPatch) -> None:
    fits = asked(monkeypatch, 80.0, 95.0, 74.0, 90.0)
    found: Any = _best(Fake(100.0), None, SCALES)  # type: ignore[arg-type]
    assert found.chi2 == 74.0
    # 100 to 80 is worth another round, 80 to 74 is not
    assert len(fits.asked) == 4
    assert not any(thorough for _, _, thorough in fits.asked)


def test_rounds_are_four_at_most_and_fits_without_an_end_are_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    fits = asked(monkeypatch, *(0.5**n for n in range(1, 20)))
    _best(Fake(1.0), None, SCALES)  # type: ignore[arg-type]
    assert len(fits.asked) == 8
    asked(monkeypatch)
    lone: Any = Fake(1.0)
    assert _best(lone, None, SCALES) is lone  # type: ignore[arg-type]
    bare: Any = Fake(1.0, free=free_of(MODEL, ("c", "k")))
    assert _best(bare, None, SCALES) is bare  # type: ignore[arg-type]


def test_fits_that_are_half_way_to_the_first_are_begun_again_and_those_behind_are_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    again: list[float] = []

    def best(one: Any, *_: Any) -> Any:
        again.append(one.chi2)
        return one

    monkeypatch.setattr(friction_split, "_best", best)
    fits: Any = [Fake(chi2) for chi2 in (1000.0, 200.0, 599.0, 601.0, 400.0)]
    assert resplit(fits, None, SCALES) == fits  # type: ignore[arg-type]
    assert again == [200.0, 599.0, 400.0]
    again.clear()
    many: Any = [Fake(10.0 + n) for n in range(20)] + [Fake(1e6)]
    resplit(many, None, SCALES)  # type: ignore[arg-type]
    assert again == [10.0 + n for n in range(8)]
    assert resplit([], None, SCALES) == []  # type: ignore[arg-type]
