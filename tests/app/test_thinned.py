"""Of very many samples some are looked at, where those between say nothing more."""

import numpy as np
import pytest

from harness.app.shared import reading as room
from harness.core.recording import Recording

T = np.arange(20_000, dtype=np.float64) / 2000.0
SWING = np.exp(-0.1 * T) * np.cos(10.0 * T)


@pytest.fixture(autouse=True)
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "MOST", 6000)


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_a_slow_motion_is_thinned_and_says_so(noise: float) -> None:
    x = SWING + noise * np.random.default_rng(0).normal(size=T.size)
    whole = Recording(T, {"x": x}, notes=("read",))
    kept = room.thinned(whole)
    assert np.array_equal(kept.t, T[::4])
    assert np.array_equal(kept["x"], x[::4])
    assert kept.notes[0] == "read"
    assert kept.notes[1].startswith("Of 20000 samples each 4th is looked at")
    assert room.thinned(kept) is kept


def test_a_quick_motion_a_force_and_a_short_recording_stay() -> None:
    quick = Recording(T, {"x": SWING, "a": np.cos(500.0 * T)})
    driven = Recording(T, {"x": SWING, "u": SWING})
    short = Recording(T[:6000], {"x": SWING[:6000]})
    assert all(room.thinned(one) is one for one in (quick, driven, short))


def test_jumps_of_the_acceleration_are_no_quick_motion() -> None:
    a = 50.0 * SWING + 3.0 * np.sign(np.sin(10.0 * T))
    assert len(room.thinned(Recording(T, {"x": SWING, "a": a}))) == 5000
