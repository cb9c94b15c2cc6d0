"""Recordings of far more samples than their motion needs: all of them are in the answers, and one still counts."""

import numpy as np
import pytest

import harness
from harness.app.shared.estimates import estimate
from harness.app.shared.reading import averaged
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.core.slider import PAPER
from harness.exact.decay import Decay, free_decay

LONG = 400_000
TRUE = {"omega_n": 10.0, "zeta": 0.05, "x_k": 0.03}


def noisy(channels: tuple[str, ...], count: int = LONG) -> Recording:
    t: FloatArray = np.linspace(0.0, 3.0, count)
    exact, random = free_decay(Decay.of(PAPER, 1.0), t), np.random.default_rng(4)
    sizes = {"x": 2e-3, "a": 0.3}
    return Recording(t, {c: getattr(exact, c) + random.normal(0.0, sizes[c], count) for c in channels})


def test_a_long_recording_tells_as_much_as_its_samples() -> None:
    found, few = estimate(noisy(("a",))), estimate(noisy(("a",), LONG // 16))
    for name, true in TRUE.items():
        one, other = getattr(found.methods["acceleration"], name), getattr(few.methods["acceleration"], name)
        assert abs(one.value - true) < 4.0 * one.stderr
        assert one.stderr == pytest.approx(other.stderr / 4.0, rel=0.1)
    assert found.noise["a"].sigma == pytest.approx(0.3, rel=0.02)


@pytest.mark.parametrize("far", [3.0, 1e3, 1e9])
def test_however_far_a_sample_strays_the_motion_is_that_of_the_others(far: float) -> None:
    """A dropped reading of 9999 m is no drift of a sensor, and hides itself in no noise."""
    t = np.arange(0.0, 6.0, 0.004)
    x = free_decay(Decay.of(PAPER, 1.0), t).x + np.random.default_rng(3).normal(0.0, 1e-4, t.size)
    plain = harness.identify(Recording(t, {"x": x}))
    strange = x.copy()
    strange[200] += far
    found = harness.identify(Recording(t, {"x": strange}))
    assert any("1 sample of x strays" in line for line in found.warnings)
    one, other = (each.estimates["displacement"].omega_n for each in (plain, found))
    assert one.value is not None
    assert other.value == pytest.approx(one.value, rel=1e-4)


def test_a_sample_that_strays_in_a_long_recording_is_skipped() -> None:
    recording = noisy(("x",))
    x = recording["x"].copy()
    x[123_456] += 0.5
    found = estimate(Recording(recording.t, {"x": x}))
    assert "1 sample of x strays" in found.warnings[0]
    x_k = found.methods["displacement"].x_k
    assert x_k.value == pytest.approx(0.03, abs=4.0 * (x_k.stderr or 0.0))


def test_means_leave_out_the_reversals_and_begin_where_the_recording_does() -> None:
    recording = noisy(("a",))
    edges: FloatArray = estimate(recording).edges
    seen = averaged(recording, edges)
    assert 50_000 < len(seen) < LONG // 3
    assert seen.t[0] == recording.t[0]
    size = LONG // len(seen)
    for edge in edges[1:-1]:
        assert np.min(np.abs(seen.t - edge)) > 0.4 * size * recording.interval
