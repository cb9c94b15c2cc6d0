"""How likely a name that stands apart is the main effect: what it hangs on, which way, and whence its weights."""

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.calibrate import chance as calibration
from harness.core.quantity import Quantity
from harness.diagnosis.fit import standard_errors
from harness.diagnosis.fit.standard_errors import loosest
from harness.diagnosis.grading.chance import FEATURES, OF_FORCES, OF_MOTION, Odds, Seen
from harness.model.model import Model, ModelTerm

SEEN = Seen(share=0.9, others=(0.5, 0.8, -0.1, 0.2), loosest=0.05, cycles=20.0, company=0.7)


def test_what_it_hangs_on_is_what_its_name_says() -> None:
    found = dict(zip(FEATURES, SEEN.features, strict=True))
    assert found["alike"] == pytest.approx((0.5**2 + 0.8**2 + 0.2**2) / 0.9**2)
    assert found["loose"] == pytest.approx(math.log(0.05))
    assert found["long"] == pytest.approx(math.log(20.0))
    assert found["share"] == 0.9
    assert found["company"] == 0.7
    assert replace(SEEN, others=()).features[0] == 0.0


@pytest.mark.parametrize("odds", [OF_MOTION, OF_FORCES])
def test_it_is_a_logistic_of_that(odds: Odds) -> None:
    z = odds.intercept + sum(w * one for w, one in zip(odds.weights, SEEN.features.tolist(), strict=True))
    assert odds.chance(SEEN) == pytest.approx(1.0 / (1.0 + math.exp(-z)))
    assert OF_MOTION.chance(replace(SEEN, share=0.0, others=(1.0,) * 30, loosest=math.inf)) == 0.0


@given(
    share=st.floats(0.6, 1.0),
    others=st.lists(st.floats(-0.2, 1.0), max_size=9),
    more=st.floats(0.0, 1.0),
    loosest=st.floats(1e-5, 1e3),
    cycles=st.floats(8.0, 300.0),
    factor=st.floats(1.0, 5.0),
    company=st.floats(0.0, 1.0),
)
def test_what_makes_it_less_likely(
    share: float, others: list[float], more: float, loosest: float, cycles: float, factor: float, company: float
) -> None:
    """Another that takes much off, loose numbers, many cycles, and less of its own beside another."""
    seen = Seen(share, tuple(others), loosest, cycles, company)
    chance = OF_MOTION.chance
    said = chance(seen)
    assert 0.0 <= said <= 1.0
    assert chance(replace(seen, others=(*others, more))) <= said + 1e-12
    assert chance(replace(seen, loosest=factor * loosest)) <= said + 1e-12
    assert chance(replace(seen, cycles=factor * cycles)) <= said + 1e-12
    assert chance(replace(seen, company=company / factor)) <= said + 1e-12
    assert chance(replace(seen, others=tuple(reversed(others)))) == pytest.approx(said)


def test_numbers_of_which_nothing_is_known_are_as_loose_as_they_are_large() -> None:
    assert OF_MOTION.chance(replace(SEEN, loosest=math.nan)) == OF_MOTION.chance(replace(SEEN, loosest=1.0))


def test_the_loosest_number_is_relative_but_a_phase_in_rad(monkeypatch: pytest.MonkeyPatch) -> None:
    """A phase near nought is not loose because it is small."""
    nothing: Any = None
    said = {
        "A": Quantity(0.2, 0.01, "N"),
        "Omega": Quantity(3.0, 0.3, "rad/s"),
        "phase": Quantity(1e-4, 0.2, "rad"),
    }
    entry = ModelTerm.named("harmonic-force", A=0.2, Omega=3.0, phase=1e-4)
    found: Any = SimpleNamespace(model=Model(1.0, 0.1, 9.0, 0.1, terms=(entry,)))
    monkeypatch.setattr(standard_errors, "term_parameters", lambda *_, **__: said)
    assert loosest(found, nothing, 0, 3.0) == pytest.approx(0.2)
    said["phase"] = Quantity(1e-4, None, "rad", "not seen")
    assert loosest(found, nothing, 0, 3.0) == pytest.approx(0.1)
    said.clear()
    assert math.isnan(loosest(found, nothing, 0, 3.0))


def test_weights_are_found_again_from_draws_that_follow_them() -> None:
    """Within three standard errors of 4,000 draws of a logistic with known weights."""
    rng = np.random.default_rng(8)
    scatter, middle = np.array([2.0, 0.5, 1.0, 0.1, 3.0]), np.array([1.0, 0.0, 3.0, 0.8, 0.0])
    x = scatter * rng.standard_normal((4000, 5)) + middle
    truth = np.array([0.5, -0.5, -1.0, 0.2, 4.0, 0.1])
    p = 1.0 / (1.0 + np.exp(-(truth[0] + x @ truth[1:])))
    found = calibration.fitted(x, rng.random(p.size) < p, np.ones(p.size))
    z = np.column_stack((np.ones(p.size), x))
    stderr = np.sqrt(np.diag(np.linalg.inv(z.T @ (z * (p * (1.0 - p))[:, None]))))
    assert np.all(np.abs(found - truth) < 3.0 * stderr)


def test_a_calibration_prints_the_weights_that_stand() -> None:
    """Draws that follow the weights as they stand end with the rule standing; few draws say that they are too few."""
    rng = np.random.default_rng(9)
    x = rng.standard_normal((9000, 5)) + np.array([1.0, -3.0, 3.0, 0.8, 0.0])
    at = x @ np.array(OF_MOTION.weights)
    right = rng.random(9000) < 1.0 / (1.0 + np.exp(-(at - np.median(at))))
    rows = [calibration.Row(one, bool(r), not r) for one, r in zip(x, right, strict=True)]
    rows += [calibration.Row(np.full(5, np.nan), False, i % 2 == 0) for i in range(2000)]
    controls = int(np.sum(~right)) + 1000
    whole = calibration.fitted(x, right, np.where(right, controls / (11000 - controls), 1.0))
    rounded = [round(float(one), 3) for one in whole]
    odds = Odds(OF_MOTION.least, rounded[0], tuple(rounded[1:]))
    (least,) = (line for line in calibration.said(odds, rows) if line.startswith("the least chance"))
    for value, says in ((float(least.rpartition(" ")[2]), "the rule stands"), (0.55, "the rule falls short")):
        odds = replace(odds, least=replace(odds.least, value=value))
        lines = list(calibration.said(odds, rows))
        assert f"intercept {whole[0]:.3f} (now {rounded[0]})" in lines
        assert says in lines[-1]
        assert lines[-1].endswith("weights as they stand")
    assert "too few" in list(calibration.said(odds, rows[:9]))[-1]


@pytest.mark.parametrize("odds", [OF_MOTION, OF_FORCES])
def test_features_and_weights_are_as_many(odds: Odds) -> None:
    assert len(FEATURES) == len(odds.weights) == SEEN.features.size
    assert all(math.isfinite(w) for w in (odds.intercept, *odds.weights))
