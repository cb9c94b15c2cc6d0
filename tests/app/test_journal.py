"""What libraries print goes into the log, at the level of descriptors, and nothing of ours does."""

import logging
import os
import subprocess
import sys
from pathlib import Path

import pytest

from harness.app.shared.progress import journal

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


def test_streams_come_back_after_a_failure(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError, match="boom"), journal(tmp_path / "log.txt"):
        raise ValueError("boom")
    print("after")
    assert capfd.readouterr().out == "after\n"


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
