"""Results appear whole or not at all."""

import errno
import os
import random
import shutil
import stat
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from harness.core.errors import StoreError
from harness.io.store import check_writable, output_folder, write_text

CHECKOUT = Path(__file__).resolve().parents[2]


def everything(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def test_a_folder_appears_whole(tmp_path: Path) -> None:
    with output_folder("run", tmp_path / "new" / "out") as output:
        (output / "model/slider.xml").write_text("x")
        assert everything(tmp_path / "new" / "out") == []
        assert output.at("model/slider.xml") == str(tmp_path / "new" / "out" / "model" / "slider.xml")
        output.commit()
    assert everything(tmp_path) == ["new", "new/out", "new/out/model", "new/out/model/slider.xml"]


@pytest.mark.parametrize("failure", [KeyboardInterrupt(), ValueError("a bug"), SystemExit(1)])
def test_nothing_is_left_after_a_failure(tmp_path: Path, failure: BaseException) -> None:
    with pytest.raises(type(failure)), output_folder("run", tmp_path / "new" / "out") as output:  # noqa: PT012
        (output / "half.json").write_text("{")
        raise failure
    assert everything(tmp_path) == []


def test_an_empty_folder_is_taken_and_stays_after_a_failure(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    with pytest.raises(KeyboardInterrupt), output_folder("run", tmp_path / "out"):
        raise KeyboardInterrupt
    assert everything(tmp_path) == ["out"]
    with output_folder("run", tmp_path / "out") as output:
        output.commit()


def test_a_folder_with_files_is_refused(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("precious")
    with (
        pytest.raises(StoreError, match="holds files already; expected a new or empty one"),
        output_folder("run", tmp_path),
    ):
        pass
    assert everything(tmp_path) == ["mine.txt"]


def test_default_folders_never_clash(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names = set()
    for _ in range(3):
        with output_folder("free-decay") as output:
            output.commit()
            names.add(output.final.name)
            assert output.final.parent == tmp_path / "reports"
    assert len(names) == 3


@pytest.mark.parametrize("place", ["/proc/out", "/dev/null/out", "file/out"])
def test_a_place_that_cannot_be_written_is_one_line(
    tmp_path: Path, place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("file").write_text("x")
    with pytest.raises(StoreError, match=r"expected|Try: ") as caught, output_folder("run", Path(place)):
        pass
    assert "\n" not in str(caught.value)
    assert everything(tmp_path) == ["file"]


@pytest.fixture
def tiny(tmp_path: Path) -> Iterator[Path]:
    """A file system of 64 KiB."""
    place = tmp_path / "tiny"
    place.mkdir()
    mounted = os.geteuid() == 0 and subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=64k", "none", str(place)], capture_output=True, check=False
    )
    if not mounted or mounted.returncode != 0:
        pytest.skip("mounting a small file system needs root")
    yield place
    subprocess.run(["umount", str(place)], check=True)


def test_a_full_disk_is_one_line_and_leaves_nothing(tiny: Path) -> None:
    with pytest.raises(StoreError, match="no space left"), output_folder("run", tiny / "out") as output:
        (output / "big").write_bytes(bytes(1 << 20))
    assert everything(tiny) == []
    (tiny / "kept.json").write_text("{}")
    with pytest.raises(StoreError, match="no space left"):
        write_text(tiny / "kept.json", "x" * (1 << 20))
    assert everything(tiny) == ["kept.json"]
    assert (tiny / "kept.json").read_text() == "{}"


def test_lack_of_space_is_told_apart_from_bugs(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="no space left"), output_folder("run", tmp_path / "out"):
        raise OSError(errno.ENOSPC, "No space left on device")
    with pytest.raises(FileNotFoundError), output_folder("run", tmp_path / "out"):
        raise FileNotFoundError(errno.ENOENT, "a bug")


def test_a_file_is_replaced_at_once_and_readable(tmp_path: Path) -> None:
    path = tmp_path / "result.json"
    path.write_text("old")
    write_text(path, "new")
    assert path.read_text() == "new"
    assert stat.S_IMODE(path.stat().st_mode) == 0o666 & ~_umask()
    assert everything(tmp_path) == ["result.json"]


def _umask() -> int:
    mask = os.umask(0o022)
    os.umask(mask)
    return mask


def test_devices_are_written_to_and_stay(tmp_path: Path) -> None:
    write_text(Path("/dev/null"), "x")
    with pytest.raises(StoreError, match="no space left"):
        write_text(Path("/dev/full"), "x" * 100_000)
    assert stat.S_ISCHR(os.stat("/dev/full").st_mode)


@pytest.mark.parametrize("path", ["/no/such/folder/a.json", "/proc/a.json", "/tmp"])
def test_a_file_that_cannot_be_written_is_known_before_the_work(path: str) -> None:
    with pytest.raises(StoreError, match=r"expected|Try: "):
        check_writable(Path(path))


def test_what_a_killed_process_left_is_removed_and_what_is_in_use_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in (".run-1.abcdefgh.partial", ".run-2.abcdefgh.partial", "run-1", ".mine.partial"):
        (tmp_path / "reports" / name).mkdir(parents=True)
    (tmp_path / "reports" / "run-1.partial").write_text("mine")
    with output_folder("run") as living:
        with output_folder("run") as output:
            (output / "a").touch()
            output.commit()
        assert living.work.is_dir()
        left = {path.name for path in (tmp_path / "reports").iterdir()}
        assert left == {".mine.partial", "run-1.partial", living.work.name, living.final.name, output.final.name}
    (tmp_path / ".a.json.abcdefgh.partial").write_text("half")
    (tmp_path / ".b.json.abcdefgh.partial").write_text("of another file")
    write_text(tmp_path / "a.json", "whole")
    assert everything(tmp_path)[:2] == [".b.json.abcdefgh.partial", "a.json"]


WRITER = """
import sys
from pathlib import Path
from harness.io.store import output_folder, write_text

place, text = Path(sys.argv[1]), "x" * 200_000 + "."
sys.stdout.write("started\\n")
sys.stdout.flush()
for i in range(100_000):
    write_text(place / "kept.json", text)
    with output_folder("run", place / f"out-{i % 3}-{i}") as output:
        (output / "a.json").write_text(text)
        (output / "b.json").write_text(text)
        output.commit()
"""


def killed_at_random(place: Path, times: int) -> None:
    """Kill a process that writes, at moments drawn at random, and look at what there is."""
    chance = random.Random(17)
    for _ in range(times):
        process = subprocess.Popen([sys.executable, "-c", WRITER, str(place)], stdout=subprocess.PIPE, cwd=CHECKOUT)
        assert process.stdout is not None
        process.stdout.readline()
        time.sleep(chance.uniform(0.0, 0.03))
        process.kill()
        process.communicate()
        if (place / "kept.json").exists():
            assert (place / "kept.json").read_text().endswith("x.")
        for folder in place.glob("out-*"):
            names = sorted(path.name for path in folder.iterdir())
            assert names in ([], ["a.json", "b.json"])
            assert all(path.read_text().endswith("x.") for path in folder.iterdir())
            shutil.rmtree(folder)
    write_text(place / "kept.json", "whole")
    for part in {path.name.removeprefix(".").split(".")[0] for path in place.glob(".out-*")}:
        with output_folder("run", place / part):
            pass
    assert everything(place) == ["kept.json"]


def test_a_writer_that_is_killed_leaves_nothing_that_looks_whole(tmp_path: Path) -> None:
    killed_at_random(tmp_path, 6)


@pytest.mark.full
def test_a_writer_that_is_killed_two_hundred_times(tmp_path: Path) -> None:
    killed_at_random(tmp_path, 200)
