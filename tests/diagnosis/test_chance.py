"""How likely a name that stands apart is the main effect: what it hangs on, which way, and whence its weights."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.calibrate import chance as calibration
from harness.diagnosis.grading.chance import OF_MOTION, Odds, Seen


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
