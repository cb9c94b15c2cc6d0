"""Files made to do harm are refused by name: exit 2, one line that a terminal shows, nothing else."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from hostile import HOSTILE, MODELS, ROWS

from harness.cli.main import run


@pytest.mark.parametrize("name", [*HOSTILE, *MODELS])
def test_a_hostile_file_is_refused_by_name(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    make, message = (HOSTILE | MODELS)[name]
    make(tmp_path / name)
    made = sorted(tmp_path.iterdir())
    code = run(["run", "--model", name, "--json", "-"] if name in MODELS else ["identify", name, "--json", "-"])
    out, err = capfd.readouterr()
    assert message in err
    assert (code, out) == (2, "")
    assert err.startswith(f"harness: {'scenario' if name == 'quick.json' else name}")
    assert err.count("\n") == 1
    assert err.removesuffix("\n").isprintable()
    assert len(err) < 1000
    assert sorted(tmp_path.iterdir()) == made


def test_a_name_that_is_no_text_is_refused(tmp_path: Path) -> None:
    name = os.fsencode(tmp_path) + b"/bad\xff.csv"
    Path(os.fsdecode(name)).write_text("\n".join(ROWS))
    command = [os.fsencode(sys.executable), b"-m", b"harness.cli", b"identify", name, b"--json", b"-"]
    done = subprocess.run(command, capture_output=True, check=False, cwd=Path(__file__).resolve().parents[2])
    assert (done.returncode, done.stdout) == (2, b"")
    assert done.stderr.endswith(b"bad\\udcff.csv: bytes that are no text in utf-8; a name that is text is accepted\n")


def test_what_is_not_asked_for_is_not_read(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """24 GB of a data set beside t and x, which the file only declares."""
    import h5py
    import numpy as np
    from hostile import T, X

    with h5py.File(tmp_path / "a.mat", "w") as file:
        file["t"], file["x"] = T, X
        file.create_dataset("camera", (3_000_000_000,), "f8", chunks=(1 << 20,))
    np.savez(tmp_path / "a.npz", t=T, x=X, camera=np.zeros((2, 3, 4)))
    for name in ("a.mat", "a.npz"):
        assert run(["identify", str(tmp_path / name), "--json", "-", "--out", str(tmp_path / f"out-{name}")]) == 0
        assert capfd.readouterr().err == ""
