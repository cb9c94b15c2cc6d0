"""Packed data come back bit for bit, whatever the bits."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.show.pack import (
    pack,
    pack_recording,
    pack_trajectory,
    recording_of,
    trajectory_of,
    unpack,
)

finite = st.floats(allow_nan=False, allow_infinity=False)


@given(st.lists(finite, min_size=1, max_size=60))
def test_any_doubles_come_back_bit_for_bit(values: list[float]) -> None:
    column = np.array(values)
    back, about = unpack(pack({"c": column}, {"k": 1}))
    assert back["c"].tobytes() == column.tobytes()
    assert about == {"k": 1}


@pytest.mark.parametrize(
    "values",
    [np.array([0.0, -0.0, 0.0]), np.array([5e-324, -5e-324, 1.7e308, -1.7e308]), np.linspace(-1.0, 1.0, 5000) ** 3],
)
def test_edges_of_the_number_range(values: FloatArray) -> None:
    assert unpack(pack({"c": values}, {}))[0]["c"].tobytes() == values.tobytes()


def assert_same(one: Trajectory, other: Trajectory) -> None:
    for name in ("t", "x", "v", "a"):
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes(), name
    for name in ("t", "kind", "x", "a_before", "a_after"):
        assert getattr(one.events, name).tobytes() == getattr(other.events, name).tobytes(), name
    assert (one.u is None) == (other.u is None)
    assert one.u is None or other.u is None or one.u.tobytes() == other.u.tobytes()
    assert (one.mode is None) == (other.mode is None)
    assert one.mode is None or other.mode is None or one.mode.tobytes() == other.mode.tobytes()
    assert {k: v.tobytes() for k, v in one.extra.items()} == {k: v.tobytes() for k, v in other.extra.items()}
    assert one.source == other.source


def test_trajectories_come_back_whole(sources: list[Trajectory]) -> None:
    for trajectory in sources:
        assert_same(trajectory, trajectory_of(*unpack(pack_trajectory(trajectory))))


def test_a_recording_comes_back_whole(recording: Recording) -> None:
    back = recording_of(*unpack(pack_recording(recording)))
    assert back.t.tobytes() == recording.t.tobytes()
    assert {k: v.tobytes() for k, v in back.channels.items()} == {k: v.tobytes() for k, v in recording.channels.items()}
    assert (back.file, back.sha256, back.notes, back.angular) == ("bench.csv", "ab" * 32, recording.notes, False)
    assert dict(back.units) == {"x": "mm"}


def test_a_smooth_motion_takes_little_room(sources: list[Trajectory]) -> None:
    t = np.arange(100_000) * 3e-6
    smooth = {"t": t, "x": np.exp(-0.5 * t) * np.cos(10.0 * t)}
    assert len(pack(smooth, {})) < 0.2 * sum(column.nbytes for column in smooth.values())
