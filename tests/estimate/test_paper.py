"""What the documentation says about the paper, recomputed."""

import math

import numpy as np
import pytest

from benchmarks.table1 import PHASE, run, table
from harness.core.slider import EXPERIMENT
from harness.estimate.paper import acceleration_paper, by_differences, by_sums
from harness.exact.decay import Decay, free_decay

OMEGA_D = 10.0 * math.sqrt(1.0 - 0.05**2)
EDGES = np.asarray(np.arange(9) * math.pi / OMEGA_D, dtype=np.float64)


def test_slips() -> None:
    listed = np.array([0.153, 0.151, 0.152, 0.155, 0.150])
    assert np.mean(listed) == pytest.approx(0.1522)
    assert 100.0 * (np.mean(listed) / 0.1456 - 1.0) == pytest.approx(4.5, abs=0.05)
    assert np.mean([0.1471, 0.1461, 0.1454, 0.1450, 0.1454]) == pytest.approx(0.1458, abs=5e-5)
    assert math.sqrt(2310.0 / 2.42) == pytest.approx(30.90, abs=0.005)
    assert EXPERIMENT.omega_n == pytest.approx(30.90, abs=0.005)
    assert EXPERIMENT.zeta == pytest.approx(0.0320, abs=5e-5)
    assert EXPERIMENT.x_k * 1e3 == pytest.approx(0.152, abs=5e-4)


@pytest.mark.parametrize(("points", "step"), [(1, 7.5e-4), (5, 1.5e-4)])
def test_published_accuracy_and_the_sampling_that_gives_it(points: int, step: float) -> None:
    first, fifth, zeta = [], [], []
    for shift in np.arange(20) / 20.0:
        t = np.asarray((np.arange(int(2.6 / step)) + shift) * step, dtype=np.float64)
        estimate = acceleration_paper(t, free_decay(Decay(10.0, 0.05, 0.03), t).a, EDGES, (OMEGA_D, 0.0), points, False)
        single = [row.x_k for row in estimate.per_reversal if row.x_k is not None]
        first.append(single[0] / 0.03 - 1.0)
        fifth.append(single[4] / 0.03 - 1.0)
        assert estimate.zeta.value is not None
        zeta.append(estimate.zeta.value / 0.05 - 1.0)
    assert np.mean(first) == pytest.approx(0.0100, abs=1e-4)
    assert np.mean(fifth) == pytest.approx(0.0031, abs=1e-4)
    assert np.sqrt(np.mean(np.square(zeta))) < 1.2e-3


def test_five_points_at_a_millisecond_read_too_much_friction() -> None:
    t = np.asarray((np.arange(2600) + 0.5) * 1e-3, dtype=np.float64)
    estimate = acceleration_paper(t, free_decay(Decay(10.0, 0.05, 0.03), t).a, EDGES, (OMEGA_D, 0.0), 5, False)
    assert estimate.per_reversal[0].x_k == pytest.approx(0.03 * 1.066, rel=5e-3)


def test_equations_12_and_13_are_exact_at_the_jumps() -> None:
    events = free_decay(Decay(10.0, 0.05, 0.03), np.linspace(0.0, 2.6, 50)).events
    assert by_differences(events.a_before[:7]) == pytest.approx([0.05] * 4, abs=1e-12)
    assert by_sums(events.a_after[:7]) == pytest.approx([0.05] * 5, abs=1e-12)


def test_table_1_simulated() -> None:
    figures, phases = run()
    assert np.mean(phases) == pytest.approx(PHASE, abs=3e-3)
    truth = (EXPERIMENT.x_k, EXPERIMENT.zeta)
    rms = {
        name: np.sqrt(np.mean((np.array(pairs) / np.array(truth) - 1.0) ** 2, axis=0))
        for name, pairs in figures.items()
    }
    for ours, theirs in (("acceleration", "acceleration-paper"), ("displacement", "displacement-paper")):
        assert np.all(rms[ours] < 0.02), (ours, rms[ours])
        assert np.all(rms[ours] < 0.5 * rms[theirs])
    text = table(found=(figures, phases))
    assert "Test 5" in text
    assert "acceleration-paper zeta" in text
