"""The library: its names, what importing it loads, its page, and that it gives what the command gives."""

import inspect
import re
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click import Context, Option

import harness
from harness.cli.main import cli
from harness.core.errors import InputError
from harness.diagnosis.problem import Problem

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
HEAVY = ("numpy", "scipy", "numba", "pydantic", "mujoco", "pybullet", "rerun", "h5py", "pyarrow", "click", "rich")


def test_importing_loads_nothing_until_a_name_is_used() -> None:
    program = (
        "import sys, harness\n"
        "assert dir(harness) == sorted(harness.__all__)\n"
        f"print(sorted(set({HEAVY!r}) & set(sys.modules)), [m for m in sys.modules if m.startswith('harness.')])\n"
        "from harness import Recording, simulate\n"
        "print(Recording.__module__)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT, check=False)
    assert (done.stdout, done.stderr) == ("[] []\nharness.core.recording\n", "")


@pytest.mark.parametrize(
    "name", ["identify", "compare", "diagnose", "log", "run", "sweep", "regress", "diff", "tune", "prove", "words"]
)
def test_every_option_of_a_command_is_an_argument_with_its_default(name: str) -> None:
    context = Context(cli)
    command = cli.get_command(context, name)
    assert command is not None
    own = inspect.signature(getattr(harness, name)).parameters
    reading = inspect.signature(harness.load).parameters
    # of several recordings, or of a file that is read by load; --no-shift is shift=0, --together several recordings
    elsewhere = {"no_shift", "json_to", "quiet", "recordings", "jobs", "resume", "together", "sim_trace"}
    elsewhere |= {"sim_columns", "sim_skip_rows", "sim_rate"}
    # of a robot's joint: diagnose_joint and run_joint
    elsewhere |= {
        "robot",
        "joint",
        "gravity",
        "gain",
        "payload",
        "sensor",
        "names",
        "flip",
        "offset",
        "angle_unit",
        "join",
        "calibration",
        "topic",
        "base",
    }
    # of many recordings in one call: the library leaves the loop over them to its user
    elsewhere |= {"cluster", "conditions"}
    # of a servo's log: diagnose_servo
    elsewhere |= {"servo"}
    # a report of tests is the command's; a proof is verified by verify_proof
    elsewhere |= {"junit_to", "github", "verify"}
    # of a scene: run_scene
    elsewhere |= {"scene", "body"}
    # of two conditions: change; the page of what log has read is for people
    elsewhere |= {"before", "after", "page"}
    for option in command.params:
        assert option.name in own or option.name in reading or option.name in elsewhere, option.name
        if isinstance(option, Option) and option.name in own:
            default = option.get_default(context)
            # click has a mark of its own for an option without one
            assert own[option.name].default == (default if isinstance(default, str | float | int) else None), (
                option.name
            )


def test_the_page_is_made_of_the_docstrings() -> None:
    made = runpy.run_path(str(ROOT / "docs" / "api_page.py"))["text"]()
    assert made == TEXT, "run python docs/api_page.py"


EXAMPLES = re.findall(r"```python\n((?:(?!```).)*)```\n\nIt prints:\n\n```text\n(.*?)```", TEXT, re.DOTALL)


@pytest.mark.parametrize(("code", "said"), EXAMPLES, ids=["diagnose", "stages"])
def test_a_worked_example_prints_what_the_page_says(code: str, said: str, capsys: pytest.CaptureFixture[str]) -> None:
    exec(compile(code, "docs/api.md", "exec"), {})
    printed, wanted = capsys.readouterr().out.splitlines(), said.splitlines()
    assert len(printed) == len(wanted)
    number = r"-?\d+\.?\d*(?:e-?\d+)?"
    for found, line in zip(printed, wanted, strict=True):
        # the words to the letter, the numbers as far as another machine repeats them
        assert re.sub(number, "#", found) == re.sub(number, "#", line)
        values = [[float(value) for value in re.findall(number, one)] for one in (found, line)]
        assert values[0] == pytest.approx(values[1], rel=0.1)


@pytest.fixture(scope="module")
def decay() -> harness.Recording:
    model = harness.Model(1.0, 1.0, 100.0, 3.0, x0=1.0)
    t = np.arange(0.0, 3.0, 4e-3)
    motion, noise = harness.simulate(model, t), np.random.default_rng(3)
    return harness.Recording(
        t, {"x": motion.x + noise.normal(0.0, 1e-3, t.size), "a": motion.a + noise.normal(0.0, 0.3, t.size)}
    )


def test_identify_and_compare_take_what_is_in_memory(decay: harness.Recording, tmp_path: Path) -> None:
    found = harness.identify(decay, out=tmp_path / "identified")
    x_k = found.estimates["acceleration"].x_k.value
    assert x_k == pytest.approx(0.03, rel=0.1)
    assert (tmp_path / "identified" / "report.html").is_file()
    assert harness.identify(decay).estimates == found.estimates
    moved = harness.Recording(decay.t, {name: 1.2 * values for name, values in decay.channels.items()})
    compared = harness.compare(decay, moved)
    assert compared.verdict == "different"
    assert "<iframe" in compared._repr_html_()
    assert set(compared.curves) == {"sim", "real"}
    assert set(found.curves["recording"]) == {"t", "x", "a"}


def test_models_are_ranked_by_what_they_leave(decay: harness.Recording) -> None:
    found = harness.compare_models(decay, {"drag": ["quadratic-drag"], "base": [], "softer": ["cubic-stiffness"]})
    base = next(one for one in found.models if one.name == "base")
    assert base.parameters["x_k"].value == pytest.approx(0.03, rel=0.05)
    assert base.chi2_per_point == pytest.approx(1.0, abs=0.1)
    # nothing is missing: no law is decisively better than none
    assert base.delta_bic < 10.0
    assert sum(one.weight for one in found.models) == pytest.approx(1.0)
    assert found.plots == ["residual-x", "residual-a"]
    with pytest.raises(InputError, match="quadratic-drag"):
        harness.compare_models(decay, {"typo": ["quadratic-drg"]})


def test_a_model_has_no_motion_before_its_beginning() -> None:
    """One that is let go was held there; one that begins in the middle of a motion came from somewhere."""
    t = np.array([0.0, 0.1, 0.2, 0.5])
    held = harness.simulate(harness.Model(1.0, 1.0, 100.0, 3.0, x0=1.0, t0=0.2), t)
    assert held.x[:3].tolist() == [1.0, 1.0, 1.0]
    moving = harness.Model(1.0, 1.0, 100.0, 3.0, x0=1.0, v0=-2.0, t0=0.2)
    with pytest.raises(InputError, match=r"2 times before 0\.2 s.* t\[t >= 0\.2\]"):
        harness.simulate(moving, t)
    assert harness.simulate(moving, t[t >= 0.2]).x[0] == 1.0


def _ready(decay: harness.Recording) -> Problem:
    return harness.stages.prepare(decay, zero="spring").problem


def test_a_diagnosis_needs_no_engine(decay: harness.Recording, tmp_path: Path) -> None:
    result = harness.diagnose(decay, engines=(), zero="spring", out=tmp_path / "out")
    assert result.verdict == "adequate"
    assert (result.engines, result.attribution, result.settings["engines"]) == ({}, None, [])
    assert (tmp_path / "out" / "report.html").is_file()
    # step by step it comes to the same
    judged = harness.stages.judge(harness.stages.search(harness.stages.fit_base(_ready(decay))))
    outcome = harness.stages.explain(judged)
    assert outcome.verdict == result.verdict
    assert harness.stages.statement(outcome) == result.statement
    assert outcome.base.model.f_k == result.baseline_model.base.f_k
    # its own model and another recording may be given as they are
    model = harness.Model(1.0, 1.0, 100.0, 3.0, x0=1.0)
    again = harness.diagnose(decay, engines=(), model=model, validate=decay)
    assert again.settings["model"] == "a Model"
    assert again.validation is not None


def test_run_is_the_command(tmp_path: Path) -> None:
    alone = harness.run("belt", engines=(), out=tmp_path / "alone")
    assert [trace.source for trace in alone.traces] == ["reference"]
    assert (tmp_path / "alone" / "trace.rrd").is_file()
    both = harness.run(f_k=2.0, duration=0.5, engines=["mujoco"], preset="tuned", dt=2e-3)
    assert [trace.dt_s for trace in both.traces] == [None, 2e-3]
    assert both.files == {}
    assert set(both.curves) == {"reference exact", "mujoco tuned"}
    assert [both.curves["mujoco tuned"][name].shape for name in "txva"] == [(251,)] * 4
    model = harness.run(model=harness.Model(1.0, 1.0, 100.0, 3.0, x0=1.0), duration=0.5, engines=())
    assert model.scenario["model"]["base"]["f_k"] == 3.0
    with pytest.raises(InputError, match="--model: given with the scenario belt"):
        harness.run("belt", model=harness.Model(1.0, 1.0, 100.0, 3.0))
