"""An engine in another interpreter: the same bits, the same errors, and a death that does not spread."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from engine_cases import decay, engine, short

from harness.app.sweep.regress import counterpart
from harness.app.sweep.sweep import SweepOptions, engines_for, sweep
from harness.core.errors import InputError, SimulationError
from harness.engines import registry
from harness.engines.base import Drive, Engine, Task
from harness.engines.elsewhere.remote import Worker

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
    ("mujoco@/no/such/python", InputError, "engine @/no/such/python: no program; NAME@PYTHON with the path of"),
    ("mujoco@/bin/true", SimulationError, "engine mujoco@/bin/true: /bin/true: its process ended with code 0"),
    ("bullet@python", InputError, "engine: 'bullet@python'; one of "),
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
