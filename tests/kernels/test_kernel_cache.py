"""What was compiled from sources that have changed since is not used again."""

import subprocess
import sys
from pathlib import Path

import pytest

from harness.core import jit

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
