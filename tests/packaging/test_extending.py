"""The examples of docs/extending.md, as a package that somebody installed: each is one file, and each works."""

import json
import re
import struct
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import harness
from harness.cli.main import run
from harness.core import apart, registered
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.scenario import FREE_DECAY
from harness.engines import registry as engines
from harness.engines.base import Task
from harness.exact.decay import free_decay
from harness.fidelity import kind as scenarios
from harness.fidelity import scenarios as own_scenarios
from harness.io import registry as readers
from harness.io.recording import read_recording
from harness.kernels.generate import examine

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "extending.md").read_text(encoding="utf-8")
FILES = dict(re.findall(r"^`(\w+\.(?:py|toml))`:\n\n```\w+\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL))
MOST_LINES = 60


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The files of the page in a folder that Python searches, with the entry points of its pyproject.toml."""
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    project = tomllib.loads(FILES["pyproject.toml"])["project"]
    about = tmp_path / f"{project['name'].replace('-', '_')}-{project['version']}.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n")
    # without the term: kernels are compiled for the terms there are, and this process has its own
    points = {group: found for group, found in project["entry-points"].items() if group != "harness.terms"}
    (about / "entry_points.txt").write_text(_points(points))
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    _forget()
    yield tmp_path
    monkeypatch.undo()
    _forget()
    for name in FILES:
        for module in (name.removesuffix(".py"), f"{own_scenarios.__name__}.{name.removesuffix('.py')}"):
            sys.modules.pop(module, None)


def _points(groups: Mapping[str, Mapping[str, str]]) -> str:
    """Entry points as an installed package has them."""
    return "".join(
        line
        for group, points in groups.items()
        for line in (f"[{group}]\n", *(f"{name} = {value}\n" for name, value in points.items()))
    )


def _forget() -> None:
    apart.dismiss()  # whoever reads for others knows their readers alone
    registered.points.cache_clear()
    scenarios.kinds.cache_clear()
    readers.by_suffix.cache_clear()


def test_every_example_is_one_short_file() -> None:
    kinds = {"my_engine.py", "my_term.py", "my_reader.py", "my_scenario.py", "my_command.py"}
    assert FILES.keys() == kinds | {"pyproject.toml"}
    assert all(FILES[name].count("\n") < MOST_LINES for name in kinds)


def test_the_engine_swings_and_rests(package: Path) -> None:
    trace = engines.load("toy").simulate(Task(FREE_DECAY, dt=1e-4))
    # first order in the step: omega_n dt is 1e-3, over a path of some metres
    np.testing.assert_allclose(trace.x, free_decay(FREE_DECAY, trace.t).x, atol=2e-3)
    assert trace.v[-1] == 0.0


def test_the_term_is_what_it_says_and_gets_its_number(package: Path) -> None:
    examine(import_module("my_term").QUINTIC)
    (package / "my_rig-1.dist-info" / "entry_points.txt").write_text(
        _points(tomllib.loads(FILES["pyproject.toml"])["project"]["entry-points"])
    )
    program = "from harness.kernels.generate import text; print(text())"
    # the registry is read once a process
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert "_quintic_stiffness(x, v, theta, o, out)" in done.stdout


def _rig(path: Path, samples: int = 60) -> Recording:
    t: FloatArray = 0.01 * np.arange(samples, dtype=np.float64)
    rows = np.column_stack((t, 5.0 * np.cos(10.0 * t), -0.05 * np.cos(10.0 * t))).astype("<f4")
    path.write_bytes(b"RIG1" + struct.pack("12x") + rows.tobytes())
    return Recording(t, {"x": 5e-3 * np.cos(10.0 * t), "a": -0.05 * 9.80665 * np.cos(10.0 * t)})


def test_the_reader_is_found_by_its_suffix(package: Path) -> None:
    want = _rig(package / "a.rig")
    found = read_recording(package / "a.rig")
    for channel in ("x", "a"):
        np.testing.assert_allclose(found[channel], want[channel], rtol=1e-6, atol=1e-9)
    assert found.units == {"t": "s", "x": "mm", "a": "g"}
    (package / "b.rig").write_bytes(b"something else")
    with pytest.raises(InputError, match="not a file of the rig"):
        read_recording(package / "b.rig")
    assert "files of the rig (.rig)" in readers.formats()


def shipped_creep(name: str, folder: Path) -> float:
    """Creep of MuJoCo as shipped under a load that is held, m/s."""
    result = harness.run(name, engines=["mujoco"], preset="as-shipped", out=folder / name)
    assert result.traces[1].metrics.creep_m_s is not None
    return result.traces[1].metrics.creep_m_s


def test_the_scenario_is_run_and_swept(package: Path, capfd: pytest.CaptureFixture[str]) -> None:
    creep = 1.6 * shipped_creep("hold-50", package)  # in proportion to the load
    assert shipped_creep("hold-80", package) == pytest.approx(creep, rel=0.05)
    line = "sweep --engine mujoco --route joint --preset as-shipped --dt 0.004 --jobs 1 --quiet --json - --out"
    assert run([*line.split(), str(package / "sweep")]) == 0
    rows = [row for row in json.loads(capfd.readouterr().out)["rows"] if row["scenario"] == "hold-80"]
    assert rows[0]["metrics"]["creep_m_s"] == pytest.approx(creep, rel=0.05)


def test_a_scenario_in_the_folder_is_run(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = package / "scenarios"
    folder.mkdir()
    (package / "my_scenario.py").rename(folder / "my_scenario.py")
    (package / "my_rig-1.dist-info" / "entry_points.txt").write_text("")
    _forget()
    monkeypatch.setattr(own_scenarios, "__path__", [*own_scenarios.__path__, str(folder)])
    assert shipped_creep("hold-80", package) == pytest.approx(1.6 * shipped_creep("hold-50", package), rel=0.05)


def test_the_command_is_one_of_the_commands(package: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _rig(package / "a.rig")
    assert run(["describe", str(package / "a.rig")]) == 0
    assert capsys.readouterr().out.startswith("60 samples over 0.59 s at 100 Hz\nx: -0.00")
    assert run(["describe", str(package / "none.rig")]) == 2
    assert run(["--help"]) == 0
    assert "describe" in capsys.readouterr().out


BAD = [
    ("harness.readers", "again = harness.io.readers.binary:NPZ", readers.by_suffix, "the suffix .npz is taken"),
    ("harness.scenarios", "again = harness.fidelity.scenarios.belt:BELT", scenarios.kinds, "registered twice"),
    ("harness.readers", "odd = collections:OrderedDict", readers.by_suffix, "harness.io.reader.Reader"),
]


@pytest.mark.parametrize(("group", "line", "look", "message"), BAD, ids=[line for _, line, *_ in BAD])
def test_what_another_package_must_not_do_is_refused(
    package: Path, group: str, line: str, look: object, message: str
) -> None:
    (package / "my_rig-1.dist-info" / "entry_points.txt").write_text(f"[{group}]\n{line}\n")
    _forget()
    assert callable(look)
    with pytest.raises(InputError, match=message):
        look()
