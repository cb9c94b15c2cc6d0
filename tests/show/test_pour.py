"""A library that writes by itself is never kept waiting, and a full disk is known at the end."""

import os
import threading
from pathlib import Path

import numpy as np
import pytest

from harness.core.errors import StoreError
from harness.core.scenario import FREE_DECAY
from harness.exact.decay import free_decay
from harness.show.report.run_scene import run_scene
from harness.show.stored import poured
from harness.show.trace import write_trace

PIECE = bytes(range(256)) * 4096


def write(name: str, pieces: int) -> None:
    """What a library does in a thread of its own."""
    with open(name, "wb", buffering=0) as pipe:
        for _ in range(pieces):
            pipe.write(PIECE)


def test_what_is_written_arrives(tmp_path: Path) -> None:
    with poured(tmp_path / "a") as pipe:
        thread = threading.Thread(target=write, args=(pipe.name, 5))
        thread.start()
        thread.join()
        pipe.opened()
    assert (tmp_path / "a").read_bytes() == 5 * PIECE


def test_a_full_disk_keeps_nobody_waiting_and_is_told() -> None:
    with pytest.raises(OSError, match="No space left"), poured(Path("/dev/full")) as pipe:
        write(pipe.name, 5)


def test_an_error_of_the_writer_passes_and_leaves_no_descriptor(tmp_path: Path) -> None:
    before = len(os.listdir("/dev/fd"))
    with pytest.raises(ValueError, match="a bug"), poured(tmp_path / "a"):
        raise ValueError("a bug")
    assert len(os.listdir("/dev/fd")) == before


@pytest.mark.parametrize("room", [30_000, 60_000, 90_000])
def test_a_trace_on_a_full_disk_ends_with_one_line(tmp_path: Path, room: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A disk that is full after so many bytes, wherever in the file that is."""

    class Disk:
        left = room

        def write(self, data: memoryview) -> int:
            if not Disk.left:
                raise OSError(28, "No space left on device")
            taken = min(Disk.left, len(data))
            Disk.left -= taken
            return taken

    from harness.show import stored

    whole = stored.Pipe
    monkeypatch.setattr(stored, "Pipe", lambda file: whole(Disk()))  # type: ignore[arg-type]
    scene = run_scene([free_decay(FREE_DECAY, np.linspace(0.0, 3.0, 20_001))], {"name": "free-decay"}, {}, "A test.")
    with pytest.raises(StoreError, match=r"t\.rrd: no space left on the device") as caught:
        write_trace(tmp_path / "t.rrd", scene)
    assert Disk.left == 0
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []
