"""However reading ends in the other process, it ends here as numbers or as one line."""

from pathlib import Path

import apart_readers
import numpy as np
import pytest

from harness.core import apart
from harness.core.apart import read_apart
from harness.core.errors import InputError

ACCEPTED = "a whole file"


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file to be read, with the readers of these tests within reach of the other process."""
    monkeypatch.setenv("PYTHONPATH", str(Path(apart_readers.__file__).parent))
    monkeypatch.setattr(apart, "LEAST_S", 2)
    monkeypatch.setitem(read_apart.__kwdefaults__ or {}, "kept", False)
    (tmp_path / "a.bin").write_bytes(b"1")
    return tmp_path / "a.bin"


def test_numbers_come_back_bit_for_bit(file: Path, capfd: pytest.CaptureFixture[str]) -> None:
    columns, about = read_apart("apart_readers:good", file, ACCEPTED, factor=0.1)
    assert list(columns) == ["t", "empty"]
    assert columns["t"].tobytes() == (0.1 * np.arange(4.0)).tobytes()
    assert columns["empty"].shape == (0,)
    assert about["said"][:2] == ["µ", None]
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("reader", "found"),
    [
        ("refuses", "nothing; expected something"),
        ("fails", f"cannot be read (RecursionError: a bug of the library); expected {ACCEPTED}"),
        ("panics", f"cannot be read (BaseException: a panic); expected {ACCEPTED}"),
        ("crashes", f"the library that reads it crashed (SIGSEGV); expected {ACCEPTED}"),
        ("leaves", f"the library that reads it ended the process; expected {ACCEPTED}"),
        ("hangs", f"takes longer than 2 s to read; expected {ACCEPTED}"),
        ("hungers", f"takes more than 2048 MiB of memory to read; expected {ACCEPTED}"),
        (
            "unsayable",
            f"cannot be read (TypeError: Object of type object is not JSON serializable); expected {ACCEPTED}",
        ),
    ],
)
def test_whatever_ends_it_is_one_line(file: Path, reader: str, found: str, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(InputError) as caught:
        read_apart(f"apart_readers:{reader}", file, ACCEPTED)
    assert str(caught.value) == f"{file}: {found}"
    assert capfd.readouterr() == ("", "")


def test_a_process_that_is_kept_reads_on_and_is_replaced_when_it_ended(file: Path) -> None:
    def number() -> int:
        return int(read_apart("apart_readers:number", file, ACCEPTED, kept=True)[1])

    apart.dismiss()  # those of other tests do not know these readers
    first = number()
    with pytest.raises(InputError, match="nothing"):
        read_apart("apart_readers:refuses", file, ACCEPTED, kept=True)
    assert number() == first
    with pytest.raises(InputError, match="crashed"):
        read_apart("apart_readers:crashes", file, ACCEPTED, kept=True)
    assert number() != first


def test_a_module_beside_the_recording_is_not_taken_for_one_of_the_library(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (file.parent / "json.py").write_text("raise SystemExit('a stranger runs')")
    monkeypatch.chdir(file.parent)
    _, about = read_apart("apart_readers:shadowed", file, ACCEPTED)
    assert Path(about[0]).parent != file.parent / "json.py"
    assert about[1] == "::"
