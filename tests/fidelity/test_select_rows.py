"""Rows by pattern: run alone, skipped, known to fail; what systems of continuous integration read of them."""

import json
import os
import re
import stat
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from killing import environment
from lxml import etree

from harness.app.sweep import regress as room
from harness.app.sweep.sweep import SweepOptions
from harness.cli.commands.regress import command
from harness.core.errors import InputError
from harness.fidelity.select import Pattern
from harness.results.sweep import RegressResult

DOCS = Path(__file__).resolve().parents[2] / "docs"
SOME = partial(SweepOptions, ("mujoco",), ("joint",), short=True, jobs=1, only=("as-shipped/dt=own/hold", "own/belt"))
HOLD, BELT = (f"mujoco@4.0.0/joint/as-shipped/dt=own/{name}" for name in ("hold-97", "belt"))


@pytest.fixture(scope="module")
def fresh() -> room.Rows:
    return room.fresh_rows(SOME())


@pytest.fixture
def baseline(fresh: room.Rows, tmp_path: Path) -> Path:
    """One in which the hold crept less than it does."""
    better = {**fresh[HOLD]["metrics"], "creep_m_s": 0.1 * fresh[HOLD]["metrics"]["creep_m_s"]}
    room.update(tmp_path / "friction.json", fresh | {HOLD: fresh[HOLD] | {"metrics": better}}, SOME())
    return tmp_path / "friction.json"


@pytest.mark.parametrize(
    ("text", "name", "meant"),
    [
        ("own/belt", BELT, True),
        ("belt", "mujoco@4.0.0/joint/tuned/dt=0.001/belt/slider-1", True),
        ("*/belt", "mujoco@4.0.0/joint/tuned/dt=0.001/belt/slider-1", False),
        ("mujoco@*/hold-??", HOLD, True),
        ("mujoco@*/hold-?", HOLD, False),
        ("pybullet", HOLD, False),
    ],
)
def test_a_pattern_is_part_of_a_name_or_a_whole_one(text: str, name: str, meant: bool) -> None:
    assert Pattern.of(f"{text}: for a reason") == Pattern(text, "for a reason")
    assert Pattern.of(text).matches(name) is meant


def test_only_the_rows_that_are_asked_for_are_run(fresh: room.Rows) -> None:
    assert sorted(fresh) == sorted([HOLD, BELT])
    assert sorted(room.fresh_rows(SOME(skip=("*/belt",)))) == [HOLD]
    with pytest.raises(InputError, match=r"no row is left\. Try: -k mujoco@4\.0\.0/joint/"):
        room.fresh_rows(SOME(skip=("mujoco",)))


def test_what_is_known_to_fail_does_not(fresh: room.Rows, baseline: Path) -> None:
    plain = room.compared(baseline, fresh, SOME())
    assert [(moved.name, moved.verdict, moved.expected) for moved in plain.moved] == [(HOLD, "worse", None)]
    assert plain.regressions == 1
    known = room.compared(baseline, fresh, SOME(xfail=("*/hold-*: soft", "*/belt: once", "nosuch")))
    assert [(moved.name, moved.expected) for moved in known.moved] == [(HOLD, "soft")]
    assert known.regressions == 0
    assert known.passed == {BELT: "once"}
    assert known.unused == ["nosuch"]


def test_what_is_skipped_is_not_missing(fresh: room.Rows, baseline: Path) -> None:
    without = {name: row for name, row in fresh.items() if name != HOLD}
    whole = SweepOptions(("mujoco",), jobs=1)
    assert room.compared(baseline, without, whole).regressions == 1
    skipped = room.compared(baseline, without, SweepOptions(("mujoco",), jobs=1, skip=(f"{HOLD}: slow",)))
    assert skipped.regressions == 0
    assert skipped.skipped == {HOLD: "slow"}


def test_an_update_of_some_rows_keeps_the_others(fresh: room.Rows, baseline: Path) -> None:
    before = room.load_baseline(baseline).rows
    room.update(baseline, {BELT: fresh[BELT] | {"metrics": {}}}, SweepOptions(("mujoco",), only=(BELT,)))
    after = room.load_baseline(baseline).rows
    assert after[HOLD] == before[HOLD]
    assert after[BELT].metrics == {}


def test_junit_has_them_as_pytest_writes_them(fresh: room.Rows, baseline: Path) -> None:
    result = room.compared(baseline, {HOLD: fresh[HOLD]}, SOME(skip=("*/belt: slow",), xfail=("*/hold-*: soft",)))
    suite = etree.fromstring(room.junit(result, [HOLD]).encode()).find("testsuite")
    assert [suite.get(name) for name in ("tests", "failures", "skipped")] == ["2", "0", "2"]
    said = {case.get("name").rpartition("/")[2]: dict(case.find("skipped").attrib) for case in suite}
    assert said == {
        "hold-97": {"type": "pytest.xfail", "message": "soft"},
        "belt": {"type": "pytest.skip", "message": "slow"},
    }


def read(lines: list[str]) -> list[tuple[str, str, str]]:
    """Kind, title and text of workflow commands, as a runner of GitHub reads them."""

    def plain(text: str) -> str:
        return re.sub("%([0-9A-F]{2})", lambda found: chr(int(found[1], 16)), text)

    found = [re.fullmatch(r"::(error|warning|notice) title=([^:,]*)::([^\r\n]*)", line) for line in lines]
    assert all(found)
    return [(one[1], plain(one[2]), plain(one[3])) for one in found if one is not None]


def test_annotations_name_what_got_worse(fresh: room.Rows, baseline: Path) -> None:
    result = room.compared(baseline, fresh, SOME(xfail=("*/belt: 100 %\nsure", "nosuch")))
    error, warning, notice = read(room.annotations(result))
    assert error[:2] == ("error", f"friction {HOLD}")
    assert "creep_m_s worse" in error[2]
    assert warning[:2] == ("warning", "friction nosuch")
    assert notice[:2] == ("notice", f"friction {BELT}")
    assert "100 %\nsure" in notice[2]


def test_no_more_annotations_than_are_shown(fresh: room.Rows, baseline: Path) -> None:
    result = room.compared(baseline, fresh, SOME())
    moved = [result.moved[0].model_copy(update={"name": f"row {number}"}) for number in range(25)]
    lines = read(room.annotations(result.model_copy(update={"moved": moved})))
    assert len(lines) == room.MOST
    assert lines[-1][1] == "friction 16 more"


@pytest.mark.parametrize(
    ("there", "option", "shown"),
    [(None, [], 0), (None, ["--github"], 1), ("true", [], 1), ("true", ["--no-github"], 0)],
)
def test_the_command_writes_them_where_github_runs_it(
    there: str | None, option: list[str], shown: int, baseline: Path
) -> None:
    line = ["--baseline", str(baseline), "--engine", "mujoco", "--short", "--jobs", "1", "-k", HOLD, *option]
    for to_json in ([], ["--json", "-"]):
        done = CliRunner(env={"GITHUB_ACTIONS": there}).invoke(command, [*line, *to_json], standalone_mode=False)
        assert done.return_value == 1
        where = done.stderr if to_json else done.stdout
        assert len(re.findall("^::error title=", where, re.MULTILINE)) == shown
        if to_json:  # standard output is JSON and nothing else
            RegressResult.model_validate(json.loads(done.stdout))


def workflow() -> dict[str, Any]:
    """The file to copy, as it stands in the document."""
    yaml = pytest.importorskip("yaml")
    (text,) = re.findall(r"^```yaml\n(.*?)^```$", (DOCS / "fidelity-ci.md").read_text(), re.MULTILINE | re.DOTALL)
    found: dict[str, Any] = yaml.safe_load(text)
    return found


def test_the_workflow_to_copy_is_one() -> None:
    found = workflow()
    assert {"name", True, "permissions", "jobs"} <= set(found)  # YAML reads the word on as true
    (job,) = found["jobs"].values()
    assert job["runs-on"].startswith("ubuntu-")
    assert all(("uses" in step) != ("run" in step) for step in job["steps"])
    assert all(re.fullmatch(r"[\w-]+/[\w-]+@v\d+", step["uses"]) for step in job["steps"] if "uses" in step)
    assert job["steps"][-1]["if"] == "always()"


@pytest.mark.full
def test_the_workflow_runs_but_for_its_installation(tmp_path: Path) -> None:
    """Each step as the runner does it: bash, in the folder of the checkout."""
    (job,) = workflow()["jobs"].values()
    (tmp_path / "bin").mkdir()
    # an installation of before the plugin has no entry point of it
    for name, module in (("harness", "harness"), ("pytest", "pytest -p harness.app.pytest_friction")):
        shim = tmp_path / "bin" / name
        shim.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m {module} "$@"\n')
        shim.chmod(shim.stat().st_mode | stat.S_IEXEC)
    known = job["env"] | {"ENGINE": "mujoco", "GITHUB_ACTIONS": "true"}
    there = environment(**known, PATH=f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}")
    (tmp_path / "friction.json").write_bytes((DOCS.parent / "reports" / "fidelity" / "baseline.json").read_bytes())
    steps = [step["run"] for step in job["steps"] if "run" in step]
    assert steps[0].startswith("pip install")
    for step in steps[1:]:
        line = ["bash", "-e", "-c", step]
        done = subprocess.run(line, cwd=tmp_path, env=there, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    assert len(etree.parse(str(tmp_path / "friction.xml")).findall(".//testcase")) == 30
