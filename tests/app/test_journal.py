"""What is written while a call works, and which samples of very many are looked at."""

import logging
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from diagnose_examples import stopped

from harness.app.diagnose.one import investigate
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.shared import reading as room
from harness.app.shared.progress import Pace, journal
from harness.app.shared.reading import ReadOptions, read
from harness.core.recording import Recording
from harness.model.registry import NAMED

CHECKOUT = Path(__file__).resolve().parents[2]


def test_descriptors_and_logging_end_in_the_log(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    print("before")
    with journal(tmp_path / "log.txt"):
        os.write(1, b"from C on 1\n")
        os.write(2, b"from C on 2\n")
        logging.getLogger("harness.test").warning("a warning")
    print("after")
    out, err = capfd.readouterr()
    assert (out, err) == ("before\nafter\n", "")
    text = (tmp_path / "log.txt").read_text()
    assert "from C on 1\n" in text
    assert "from C on 2\n" in text
    assert "harness.test WARNING a warning" in text


def test_what_c_has_buffered_does_not_come_out_later(tmp_path: Path) -> None:
    program = (
        "import ctypes, sys\nfrom pathlib import Path\nfrom harness.app.shared.progress import journal\n"
        f"with journal(Path({str(tmp_path / 'log.txt')!r})):\n    ctypes.CDLL(None).puts(b'late')\n"
        "print('{}')\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=CHECKOUT)
    assert done.stdout == "{}\n"
    assert (tmp_path / "log.txt").read_text() == "late\n"


def test_a_closed_standard_output_does_no_harm(tmp_path: Path) -> None:
    program = (
        "import os\nos.close(1)\nfrom pathlib import Path\nfrom harness.app.shared.progress import journal\n"
        f"with journal(Path({str(tmp_path / 'log.txt')!r})):\n    os.write(2, b'x')\n"
    )
    done = subprocess.run([sys.executable, "-c", program], stderr=subprocess.PIPE, text=True, check=False, cwd=CHECKOUT)
    assert (done.returncode, done.stderr) == (0, "")


class Clock:
    """A clock that is set by hand."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def test_the_time_left_is_that_of_the_rest_at_the_same_pace() -> None:
    clock = Clock()
    pace = Pace(clock)
    assert pace.line() == ""
    for done in range(5):
        pace.tell("rows", done, 10)
        clock.now += 2.0
    clock.now -= 2.0
    assert pace.line() == "rows: 4 of 10 done, about 12 s left for these"
    clock.now += 5.0  # while the next one is in work
    assert pace.line() == "rows: 4 of 10 done, about 7 s left for these"
    clock.now += 60.0
    assert pace.line() == "rows: 4 of 10 done"


def test_what_was_done_before_and_what_is_other_work_say_nothing_of_the_pace() -> None:
    clock = Clock()
    pace = Pace(clock)
    for done in (90, 91, 92, 93):
        pace.tell("rows", done, 100)
        clock.now += 1.0
    clock.now -= 1.0
    assert pace.line() == "rows: 93 of 100 done, about 7 s left for these"
    pace.tell("trying end-stop", 5, 24)
    assert pace.line() == "trying end-stop: 5 of 24 done"
    pace.tell("report", 0, 0)
    assert pace.line() == "report"


def test_a_diagnosis_names_what_it_tries_and_how_many_of_how_many(tmp_path: Path) -> None:
    recording = read(stopped(tmp_path / "decay.csv"), ReadOptions())
    heard: list[tuple[str, int, int]] = []
    investigate(recording, DiagnoseOptions(engines=()), lambda *said: heard.append(said))
    tried = {step.removeprefix("trying ") for step, _, _ in heard if step.startswith("trying ")}
    assert "end-stop" in tried
    assert tried & {term.name for term in NAMED} == {name for name in tried if " with " not in name}
    assert all(0 <= done < total for _, done, total in heard)


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
