"""The whole command, everything written, against a process that reads the recording and fits the base alone.

Both start from nothing on one core, and load the same libraries.
"""

import atexit
import os
import shutil
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.registry import Pair, benchmark
from harness.core.arrays import FloatArray
from harness.kernels.solve import solve
from harness.model.model import Model, ModelTerm

_BASE = "import sys; from harness import stages; stages.fit_base(stages.prepare(sys.argv[1]).problem)"
_PEER = "a process that reads it and fits viscous and Coulomb friction alone, one core"
_ENCODER = 2.0 * np.pi / 8192.0
"""Step of an encoder, rad."""


def _written(folder: Path, name: str, t: FloatArray, x: FloatArray, unit: str) -> Path:
    file = folder / f"{name}.csv"
    np.savetxt(file, np.column_stack([t, x]), delimiter=",", header=f"t [s],x [{unit}]", comments="", fmt="%.8g")
    return file


def _machine(folder: Path) -> Path:
    """An arm on a torsion spring, 8000 samples of its encoder: drag, and smaller things beside it."""
    t: FloatArray = np.arange(8000, dtype=np.float64) * 1e-3
    terms = (
        ModelTerm.named("quadratic-drag", c2=0.05),
        ModelTerm.named("cubic-stiffness", k3=4.0),
        ModelTerm.named("harmonic-force", A=0.2, Omega=41.0, phase=0.4),
    )
    x = solve(Model(m=1.0, c=0.15, k=260.0, f_k=0.6, x0=0.9, terms=terms), t).x + 0.07
    return _written(folder, "arm", t, _ENCODER * np.round(x / _ENCODER), "rad")


def _smooth(folder: Path) -> Path:
    """A slider with quadratic drag, 50,000 samples, white noise."""
    t: FloatArray = np.arange(50_000, dtype=np.float64) * 4e-4
    drag = ModelTerm.named("quadratic-drag", c2=1.5)
    x = solve(Model(m=1.0, c=0.12, k=400.0, f_k=0.06, x0=0.1, terms=(drag,)), t).x
    return _written(folder, "slider", t, x + 1e-5 * np.random.default_rng(1).standard_normal(t.size), "m")


def _alone(*words: str) -> None:
    """Run Python with these words on one core. Raises CalledProcessError."""
    one = dict(os.environ, HARNESS_THREADS="1", OPENBLAS_NUM_THREADS="1")
    subprocess.run([sys.executable, *words], env=one, check=True, stdout=subprocess.DEVNULL)


def _whole(file: Path) -> None:
    out = file.parent / "out"
    shutil.rmtree(out, ignore_errors=True)
    _alone("-m", "harness.cli", "diagnose", str(file), "--quiet", "--out", str(out))


def _folder() -> Path:
    folder = Path(tempfile.mkdtemp(prefix="benchmark-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _pair(file: Path) -> Pair:
    return Pair(partial(_whole, file), partial(_alone, "-c", _BASE, str(file)), rounds=1)


@benchmark(
    "command.machine",
    peer=_PEER,
    timed="harness diagnose, everything written, of 8000 samples of a machine that no entry explains alone, one core",
    target=8.0,
)
def machine() -> Pair:
    return _pair(_machine(_folder()))


@benchmark(
    "command.smooth",
    peer=_PEER,
    timed="harness diagnose, everything written, of 50,000 smooth samples, one core",
    target=10.0,
)
def smooth() -> Pair:
    return _pair(_smooth(_folder()))
