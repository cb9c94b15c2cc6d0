"""Compiled kernels are code: they are taken from a folder that nobody else can write to."""

import os
import stat
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from harness.core import kernel_cache


@pytest.fixture
def homes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of the user's that cannot be made, and a temporary folder of its own."""
    (tmp_path / "file").touch()
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.setattr("platformdirs.user_cache_path", lambda name: tmp_path / "file" / name)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def fallback(place: Path) -> Path:
    return place / f"friction-harness-{os.geteuid()}"


def test_a_folder_of_ones_own_is_made_closed_and_found_again(homes: Path) -> None:
    assert kernel_cache.cache_folder() == fallback(homes)
    assert stat.S_IMODE(fallback(homes).stat().st_mode) == 0o700
    assert kernel_cache.cache_folder() == fallback(homes)


@pytest.mark.parametrize("mode", [0o777, 0o770, 0o722])
def test_a_folder_that_others_can_write_to_is_left_alone(homes: Path, mode: int) -> None:
    fallback(homes).mkdir()
    fallback(homes).chmod(mode)
    found = kernel_cache.cache_folder()
    assert found != fallback(homes)
    assert stat.S_IMODE(found.stat().st_mode) == 0o700


def test_a_link_to_somewhere_else_is_left_alone(homes: Path) -> None:
    (homes / "elsewhere").mkdir()
    fallback(homes).symlink_to(homes / "elsewhere")
    assert kernel_cache.cache_folder() != fallback(homes)


def test_a_folder_of_another_user_is_left_alone(homes: Path) -> None:
    if os.geteuid() != 0:
        pytest.skip("giving a folder away needs root")
    fallback(homes).mkdir(mode=0o755)
    os.chown(fallback(homes), 12345, -1)
    assert kernel_cache.cache_folder() != fallback(homes)


def test_a_folder_that_is_named_is_held_to_the_same(homes: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    named = homes / "named"
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(named))
    assert kernel_cache.cache_folder() == named
    named.chmod(0o777)
    assert kernel_cache.cache_folder() == fallback(homes)


def test_a_folder_of_one_process_goes_with_it(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (tmp_path / f"friction-harness-{os.geteuid()}").touch()
    program = "from harness.core import jit; print(jit._ROOT)"
    environment = {
        "HOME": str(tmp_path / "file"),
        "TMPDIR": str(tmp_path),
        "PYTHONPATH": str(Path(__file__).parents[2]),
    }
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True)
    assert Path(done.stdout.strip()).parent == tmp_path
    assert not Path(done.stdout.strip()).exists()
