"""What was compiled from sources that have changed since is not used again, nor what others may write."""

import os
import stat
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from harness.core import jit, kernel_cache

KERNEL = """
from harness.core.jit import compiled
from harness.model.terms import cubic_stiffness

_law = compiled(cubic_stiffness.law, lean=True)


def _force(x, theta, out):
    _law(x, 0.0, theta, 6, out)


force = compiled(_force, lean=True)
"""
"""A kernel that has a law in its own code, as the dispatch has all of them."""
PROGRAM = """
import numpy as np
from harness.kernels.small import force
theta, out = np.full(9, 2.0), np.zeros(9)
force(0.5, theta, out)
print(out[0])
"""


def test_a_changed_law_is_compiled_anew(tmp_path: Path) -> None:
    package = tmp_path / "harness"
    for room in ("core", "model", "kernels"):
        for file in (Path(jit.__file__).parents[1] / room).rglob("*.py"):
            copy = package / room / file.relative_to(Path(jit.__file__).parents[1] / room)
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes(file.read_bytes())
    (package / "__init__.py").touch()
    (package / "kernels" / "small.py").write_text(KERNEL)
    law = package / "model" / "terms" / "cubic_stiffness.py"

    def value() -> float:
        environment = {"PYTHONPATH": str(tmp_path), "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
        command = [sys.executable, "-c", PROGRAM]
        return float(
            subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
        )

    assert value() == pytest.approx(2.0 * 0.5**3)
    law.write_text(law.read_text().replace("out[VALUE] = k3 * x2 * x", "out[VALUE] = 3.0 * k3 * x2 * x"))
    assert value() == pytest.approx(6.0 * 0.5**3)


@pytest.mark.parametrize("room", ["kernels", "model", "engines", "diagnosis"])
def test_a_room_that_compiles_laws_into_its_own_code_watches_them(
    room: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(jit, "_PACKAGE", tmp_path)
    law = tmp_path / "model" / "law.py"
    law.parent.mkdir()
    seen = set()
    for text in ("1", "2"):
        law.write_text(text)
        jit._fingerprint.cache_clear()
        seen.add(jit._fingerprint(room))
    jit._fingerprint.cache_clear()
    assert len(seen) == 2


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
