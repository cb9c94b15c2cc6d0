"""A term of another package, from its file to a diagnosis that names it; nothing of the house is edited."""

import json
import os
import shutil
import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest
import third_party_terms

import harness
from harness.core import registered
from harness.core.errors import InputError
from harness.model import registry

POINTS = {"magnet": "third_party_terms:MAGNET", "tanh": "third_party_terms:TANH"}
SOLVED = """
import json
import numpy as np
from scipy.integrate import solve_ivp
from harness.kernels.solve import simulate, solve
from harness.model.model import Model, ModelTerm

said = {}
t = np.linspace(0.0, 2.0, 401)
base = Model(1.0, 0.4, 100.0, 0.6, x0=1.0)
tanh = ModelTerm.named("tanh-friction", v_r=0.3)
magnet = ModelTerm.named("magnet", h=60.0, w=0.2)
both = base.with_terms(tanh, magnet)

def slope(_, z):
    x, v = z
    return [v, -0.4 * v - 100.0 * x - 60.0 * x * np.exp(-((x / 0.2) ** 2)) - 0.6 * np.tanh(v / 0.3)]

exact = solve_ivp(slope, (0.0, 2.0), [1.0, 0.0], t_eval=t, rtol=1e-10, atol=1e-12).y[0]
said["reference"] = float(np.abs(simulate(both, t).x - exact).max())
step = 1e-4
ends = [solve(base.with_terms(tanh, ModelTerm.named("magnet", h=60.0 + d, w=0.2)), t).x for d in (step, -step)]
difference = (ends[0] - ends[1]) / (2.0 * step)
said["sensitivity"] = float(np.abs(solve(both, t, ((1, 0),)).dx[:, 0] - difference).max() / np.abs(difference).max())
"""
NAMED = """
from harness.core.recording import Recording
from harness.diagnosis.pipeline import diagnose, prepare
from harness.diagnosis.request import Asked
from harness.engines.simulator import task_of
from harness.engines.registry import load

trace = load("mujoco").simulate(task_of(both, 1.0, 5e-4))
said["engine"] = float(np.abs(trace.x - simulate(both, trace.t).x).max())

t = 0.01 * np.arange(400) + 0.003
motion = simulate(Model(1.0, 0.4, 100.0, 0.6, x0=1.0, terms=(magnet,)), t)
noise = np.random.default_rng(2)
x = motion.x + noise.normal(0.0, 1e-3, t.size)
outcome = diagnose(prepare(Recording(t, {"x": x}), Asked())[0])
said["named"] = [m.name for m in outcome.mechanisms]
said["statement"] = outcome.mechanisms[0].statement
said["where"] = outcome.mechanisms[0].place.condition
said["h"] = outcome.mechanisms[0].parameters["h"].value
said["stderr"] = outcome.mechanisms[0].parameters["h"].stderr
"""
TOLD = "print(json.dumps(said))"


def said_with_the_package(place: Path, program: str, **environment: str) -> dict[str, Any]:
    """What a program says in a copy of the house beside which the package is installed, its dispatch made anew."""
    house = Path(harness.__file__).parent
    shutil.copytree(house, place / "harness")  # as compiled: times of files are copied too
    shutil.copytree(house.parent / "models", place / "models")
    package = Path(third_party_terms.__file__)
    shutil.copy(package, place / package.name)
    (place / "third_party_terms-1.dist-info").mkdir()
    (place / "third_party_terms-1.dist-info" / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: third-party-terms\nVersion: 1\n"
    )
    lines = [f"{name} = {value}\n" for name, value in POINTS.items()]
    (place / "third_party_terms-1.dist-info" / "entry_points.txt").write_text(f"[{registry.GROUP}]\n{''.join(lines)}")
    own = os.environ | {"PYTHONPATH": str(place), "NUMBA_CACHE_DIR": str(place / "cache")} | environment

    def run(*command: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *command], env=own, cwd=place, capture_output=True, text=True, check=False
        )

    stale = run("-c", "import harness.kernels.solve")
    assert "harness/kernels/dispatch.py: written without tanh-friction; expected what python -m harness" in stale.stderr
    assert run("-m", "harness.kernels.generate").stderr == ""
    done = run("-c", program + TOLD)
    assert done.stderr == ""
    said: dict[str, Any] = json.loads(done.stdout)
    return said


def test_a_term_of_another_package_is_simulated_with_its_sensitivities(tmp_path: Path) -> None:
    """Not compiled, which would take longer than all that is asked."""
    said = said_with_the_package(tmp_path, SOLVED, NUMBA_DISABLE_JIT="1")
    assert said["reference"] < 1e-7
    assert said["sensitivity"] < 1e-5


@pytest.mark.full
def test_a_term_of_another_package_is_found(tmp_path: Path) -> None:
    said = said_with_the_package(tmp_path, SOLVED + NAMED)
    assert said["reference"] < 1e-7
    assert said["sensitivity"] < 1e-5
    assert said["engine"] < 2e-3
    assert said["named"] == ["magnet"]
    assert said["statement"].startswith("A magnet holds the slider within ")
    assert said["where"].startswith("|x| < 0.2")
    assert abs(said["h"] - 60.0) < 4.0 * said["stderr"]


BAD = [
    (
        "no_such_package:TERM",
        "term mine: no_such_package:TERM: No module named 'no_such_package'; expected a package that loads",
    ),
    ("collections:OrderedDict", r"is <class 'collections.OrderedDict'>; expected a harness.model.term.Term"),
    ("harness.model.terms.stribeck:TERM", "term stribeck: registered twice; expected one"),
]


@pytest.mark.parametrize(("value", "message"), BAD)
def test_what_is_no_term_is_refused(value: str, message: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registered, "points", lambda group: (EntryPoint("mine", value, registry.GROUP),))
    with pytest.raises(InputError, match=message):
        registry._catalogue()
