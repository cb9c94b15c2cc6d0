"""Data of a trace come back bit for bit, thinned for a plot and whole in the file."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.trajectory import Source, Trajectory
from harness.show.decimate import keep, position_at, position_error, reversal_times
from harness.show.pack import pack, unpack

finite = st.floats(allow_nan=False, allow_infinity=False)


@given(st.lists(finite, min_size=1, max_size=60))
def test_any_doubles_come_back_bit_for_bit(values: list[float]) -> None:
    column = np.array(values)
    back, about = unpack(pack({"c": column}, {"k": 1}))
    assert back["c"].tobytes() == column.tobytes()
    assert about == {"k": 1}


def test_a_smooth_motion_takes_little_room(sources: list[Trajectory]) -> None:
    t = np.arange(100_000) * 3e-6
    smooth = {"t": t, "x": np.exp(-0.5 * t) * np.cos(10.0 * t)}
    assert len(pack(smooth, {})) < 0.2 * sum(column.nbytes for column in smooth.values())


def motion(t: np.ndarray) -> Trajectory:
    return Trajectory(t, np.sin(3.0 * t), 3.0 * np.cos(3.0 * t), -9.0 * np.sin(3.0 * t), Source("made up"))


@pytest.mark.parametrize("n", [10_001, 54_321, 100_000])
def test_spikes_ends_and_reversals_survive(n: int) -> None:
    t = np.linspace(0.0, 1.0, n)
    x = np.zeros(n)
    x[n // 3], x[n // 5] = 1.0, -1.0
    chosen = keep(t, [x], np.array([0.5]), 2000)
    assert chosen.size <= 2000
    assert np.all(np.diff(chosen) > 0)
    assert {0, n // 3, n // 5, n - 1} <= set(chosen.tolist())
    centre = int(np.searchsorted(t, 0.5))
    assert set(range(centre - 500, centre + 500)) <= set(chosen.tolist())


def test_reversals_without_events_lie_between_the_samples() -> None:
    t = np.linspace(0.0, 3.0, 4001)
    expected = (np.arange(3) + 0.5) * np.pi / 3.0
    assert np.allclose(reversal_times(motion(t))[:3], expected[expected < 3.0], atol=1e-6)


def test_interpolation_is_exact_at_samples_and_of_fourth_order_between() -> None:
    errors = []
    for n in (101, 201, 401):
        reference = motion(np.linspace(0.0, 3.0, n))
        assert np.array_equal(position_at(reference, reference.t)[0], reference.x)
        between = 0.5 * (reference.t[1:] + reference.t[:-1])
        errors.append(np.max(np.abs(position_at(reference, between)[0] - np.sin(3.0 * between))))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.allclose(orders, 4.0, atol=0.1)


def test_no_error_is_claimed_where_the_reference_has_ended() -> None:
    reference = motion(np.linspace(0.0, 1.0, 101))
    longer = motion(np.linspace(0.0, 2.0, 201))
    error = position_error(longer.t, longer.x, reference)
    assert np.isnan(error[longer.t > 1.0]).all()
    assert np.max(np.abs(error[longer.t <= 1.0])) < 1e-7
