"""Engines by name, without PyBullet, and in another interpreter."""

import os
import signal
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest
from engine_cases import decay, engine, short
from packaging.requirements import Requirement

from harness.app import doctor
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.run.run import RunOptions
from harness.app.shared.reading import ReadOptions
from harness.app.sweep.regress import counterpart
from harness.app.sweep.sweep import SweepOptions, engines_for, sweep
from harness.cli.main import run
from harness.core import registered
from harness.core.errors import InputError, SimulationError
from harness.engines import registry
from harness.engines.base import Engine, Task
from harness.engines.elsewhere.remote import Worker
from harness.engines.forces import Drive
from harness.proof.engine_source import engine_motion
from harness.proof.plant.model import base_model

HERE = sys.executable


@pytest.fixture(scope="module")
def there() -> Engine:
    return registry.load(f"mujoco@{HERE}")


def test_the_motion_is_the_same_to_the_last_bit_and_says_where_it_was_made(there: Engine) -> None:
    task = short("joint", drive=Drive.none().with_knock(0.2, 0.1, 1e-3), dt=1e-3)
    mine, theirs = engine("mujoco").simulate(task), there.simulate(task)
    assert all(np.array_equal(getattr(mine, name), getattr(theirs, name)) for name in ("t", "x", "v", "a", "u", "mode"))
    assert theirs.source.settings == mine.source.settings
    assert theirs.source.name == there.label == f"mujoco@4.0.0({Path(sys.prefix).name})"
    assert not theirs.x.flags.writeable
    assert there.presets("joint", "tuned") == engine("mujoco").presets("joint", "tuned")
    assert there.routes == engine("mujoco").routes


def test_what_runs_at_once_comes_across_with_its_errors_in_their_place() -> None:
    class Together(type(registry.load(f"mujoco@{HERE}"))):  # type: ignore[misc]
        batches = True

    tasks = [short("joint", dt=1e-3), Task(decay(), "joint", "as-shipped", 0.5), short("law", dt=1e-3)]
    first, failed, last = Together().simulate_all(tasks)
    assert isinstance(failed, SimulationError)
    for found, task in ((first, tasks[0]), (last, tasks[2])):
        assert found.source.name == f"mujoco@4.0.0({Path(sys.prefix).name})"
        assert np.array_equal(found.x, engine("mujoco").simulate(task).x)


def test_errors_come_across_as_they_are(there: Engine) -> None:
    with pytest.raises(InputError, match="mujoco setting stickiness: unknown"):
        there.simulate(Task(decay(), settings={"stickiness": 1.0}))
    with pytest.raises(SimulationError, match="mujoco: the run diverged"):
        there.simulate(Task(decay(), "joint", "as-shipped", 0.5))


@pytest.fixture
def dying() -> Iterator[Worker]:
    made = Worker(HERE, "harness.engines.mujoco:MujocoEngine")
    yield made
    made.close()


def test_a_death_is_told_and_the_next_question_starts_another_process(dying: Worker) -> None:
    assert dying.ask("about")[0] == "mujoco"
    first = dying._process
    assert first is not None
    os.kill(first.pid, signal.SIGKILL)
    with pytest.raises(SimulationError, match="its process ended with code -9"):
        dying.ask("simulate", short("joint"))
    assert dying.ask("about")[0] == "mujoco"


BAD = [
    ("mujoco@/no/such/python", InputError, "engine @/no/such/python: no program; expected NAME@PYTHON with the path"),
    ("mujoco@/bin/true", SimulationError, "engine mujoco@/bin/true: /bin/true: its process ended with code 0"),
    ("bullet@python", InputError, "engine: 'bullet@python'; expected one of "),
]


@pytest.mark.parametrize(("name", "kind", "message"), BAD)
def test_what_is_no_interpreter_is_refused(name: str, kind: type[Exception], message: str) -> None:
    with pytest.raises(kind) as caught:
        registry.load(name)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_sweep_holds_two_of_one_engine_side_by_side(tmp_path: Path) -> None:
    options = SweepOptions(("mujoco", f"mujoco@{HERE}"), ("joint",), ("tuned",), (1e-3,), short=True, jobs=1)
    rows = list(sweep(options, tmp_path / "sweep").rows())
    assert {(row["engine"], row["version"], row["environment"]) for row in rows} == {
        ("mujoco", "4.0.0", ""),
        ("mujoco", "4.0.0", Path(sys.prefix).name),
    }
    half = len(rows) // 2
    assert [row["metrics"] for row in rows[:half]] == [row["metrics"] for row in rows[half:]]
    assert len({row["name"] for row in rows}) == len(rows)
    with pytest.raises(InputError, match=r"--engine: mujoco@4\.0\.0.* twice"):
        engines_for(SweepOptions((f"mujoco@{HERE}", f"mujoco@{Path(HERE).parent}/../bin/{Path(HERE).name}")))


KNOWN = [("mujoco", "3.9.0", ""), ("mujoco", "3.10.0", ""), ("mujoco", "3.9.0", "old"), ("dart", "9.0", "")]


@pytest.mark.parametrize(
    ("of", "against"),
    [
        (("mujoco", "3.9.0", ""), ("mujoco", "3.9.0", "")),
        (("mujoco", "3.9.0", "old"), ("mujoco", "3.9.0", "old")),
        (("mujoco", "3.9.0", "mine"), ("mujoco", "3.9.0", "")),
        (("mujoco", "4.0.0", ""), ("mujoco", "3.10.0", "")),
        (("drake", "1.0", ""), None),
    ],
)
def test_a_version_is_held_against_itself_or_the_newest(
    of: tuple[str, str, str], against: tuple[str, str, str] | None
) -> None:
    assert counterpart(of, KNOWN) == against


_WITHOUT_LXML = """
import sys
sys.modules["lxml"] = None
import harness.engines.elsewhere.worker, harness.engines.samples, harness.engines.stepping
"""


def test_what_an_engine_needs_in_an_environment_of_its_own_is_there_without_a_parser_of_models() -> None:
    subprocess.run([sys.executable, "-c", _WITHOUT_LXML], check=True)


CHECKOUT = Path(__file__).resolve().parents[2]


@pytest.fixture
def hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    """An interpreter that cannot import pybullet."""
    for name in list(sys.modules):
        if name == "pybullet" or name.startswith("harness.engines.pybullet"):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "pybullet", None)


@pytest.fixture
def later(hidden: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same on a Python that has no wheel of it."""
    monkeypatch.setattr(registry, "NO_PYBULLET", sys.version_info[:2])


def test_it_is_a_dependency_where_there_is_a_wheel() -> None:
    lines = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())["project"]["dependencies"]
    (found,) = [one for one in map(Requirement, lines) if one.name == "pybullet"]
    assert found.marker is not None
    for version in ("3.11", "3.12", "3.13", "3.14"):
        asked = found.marker.evaluate({"python_version": version})
        assert asked == (tuple(map(int, version.split("."))) < registry.NO_PYBULLET)


@pytest.mark.usefixtures("later")
def test_the_usual_engines_are_those_that_can_be_had() -> None:
    assert registry.usual() == ("mujoco",)
    assert RunOptions().engines == RunOptions.asked().engines == ("mujoco",)
    assert DiagnoseOptions().engines == DiagnoseOptions.chosen(ReadOptions()).engines == ("mujoco",)


@pytest.mark.usefixtures("pybullet")
@pytest.mark.usefixtures("hidden")
def test_a_broken_installation_is_no_reason_to_leave_it_out() -> None:
    assert registry.usual() == ("mujoco", "pybullet")
    assert not doctor.healthy(doctor.doctor())


@pytest.mark.usefixtures("hidden")
def test_asked_for_by_name_it_is_said_to_be_missing() -> None:
    with pytest.raises(SimulationError, match="engine pybullet: not installed"):
        registry.load("pybullet")
    with pytest.raises(SimulationError, match="engine pybullet: not installed"):
        engine_motion(base_model(1.0, 1.0, 100.0, 3.0, 1.0), np.linspace(0.0, 1.0, 11), "pybullet")


@pytest.mark.usefixtures("later")
def test_the_doctor_says_so_and_is_content(monkeypatch: pytest.MonkeyPatch) -> None:
    found = doctor.doctor()
    (check,) = [one for one in found.checks if one.name == "engine pybullet"]
    assert not check.ok
    assert "not installed" in check.found
    assert check.remedy is not None
    assert "Python 3.11" in check.remedy
    assert "optional" in check.needed_for
    assert doctor.healthy(found)


@pytest.mark.usefixtures("later")
def test_the_main_job_runs_and_names_what_is_left_out(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert run(["run", "--preset", "tuned", "--out", str(tmp_path / "out")]) == 0
    out, _ = capfd.readouterr()
    assert "mujoco tuned" in out
    assert "pybullet tuned" not in out
    assert "- pybullet is not run: it has no wheel for this Python" in out


@pytest.mark.usefixtures("pybullet")
def test_the_engines_of_the_house_are_registered() -> None:
    assert {"mujoco", "pybullet"} <= set(registry.names())
    assert registry.load("mujoco").name == "mujoco"
    assert registry.load("pybullet").version() == "3.2.7"


def point(name: str, value: str) -> EntryPoint:
    return EntryPoint(name, value, registry.GROUP)


def test_what_is_no_engine_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registered, "points", lambda group: (point("odd", "collections:OrderedDict"),))
    with pytest.raises(SimulationError, match=r"engine odd: collections:OrderedDict is not a harness\.engines"):
        registry.load("odd")


def test_without_any_engine_the_message_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registered, "points", lambda group: ())
    with pytest.raises(InputError, match="an installed package that registers engines"):
        registry.load("mujoco")
