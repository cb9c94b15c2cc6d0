"""Several logs of one robot: what differs is named with its joint, what does not is not, and a slope comes back."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from harness.app.diagnose.conditions import read_conditions
from harness.cli.main import run
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.diagnosis.rules import CHANCE
from harness.engines.models import folder
from harness.results.fleet import FleetResult
from harness.results.generate import schema_text
from harness.robot.arm import load_arm
from harness.robot.example import FRICTION, Friction, excited, write
from harness.robot.fleet import Values, compared

FILE = folder() / "arm" / "arm.xml"
JOINTS, LOGS, ERROR = 7, 5, 0.01


def _drawn(random: np.random.Generator, means: Sequence[Sequence[float]]) -> list[Values]:
    """A log each for the rows of means (logs, joints), with errors of 0.01."""
    return [
        {f"joint{j}": {"f_k": Quantity(float(random.normal(m, ERROR)), ERROR, "N m")} for j, m in enumerate(row)}
        for row in means
    ]


def test_fleets_that_are_the_same_are_said_to_differ_in_one_of_a_hundred() -> None:
    """400 fleets, two conditions: what is expected is below four, and twelve would be beyond three deviations."""
    random = np.random.default_rng(3)
    conditions: dict[str, list[float | None]] = {
        "temperature": [10.0, 20.0, 25.0, 30.0, 50.0],
        "day": [1.0, 2.0, 3.0, 4.0, None],
    }
    said = 0
    for _ in range(400):
        found = compared(_drawn(random, np.ones((LOGS, JOINTS)).tolist()), conditions)
        said += any(one.differs or any(trend.differs for trend in one.trends) for one in found)
    assert said <= 3.0 * 400 * CHANCE.value


def test_the_joint_and_the_log_that_differ_are_found() -> None:
    means = np.ones((LOGS, JOINTS))
    means[3, 2] += 8.0 * ERROR
    found = {one.joint: one for one in compared(_drawn(np.random.default_rng(1), means.tolist()))}
    assert [name for name, one in found.items() if one.differs] == ["joint2"]
    assert found["joint2"].apart == 3
    assert found["joint2"].freedom == LOGS - 1


def test_a_change_with_temperature_comes_back() -> None:
    warm = [10.0, 20.0, 30.0, 40.0, 50.0]
    means = np.ones((LOGS, JOINTS))
    means[:, 4] += 0.008 * np.array(warm)
    found = compared(_drawn(np.random.default_rng(2), means.tolist()), {"temperature": warm})
    (trend,) = next(one for one in found if one.joint == "joint4").trends
    assert trend.differs
    assert trend.slope.value == pytest.approx(0.008, abs=4.0 * (trend.slope.stderr or 0.0))
    assert not any(t.differs for one in found if one.joint != "joint4" for t in one.trends)


def test_a_spread_between_logs_comes_back() -> None:
    """Of 200 logs that scatter by 5 errors beyond these, and in the error of their mean."""
    random = np.random.default_rng(6)
    means = 1.0 + 5.0 * ERROR * random.standard_normal((200, 1))
    (found,) = compared(_drawn(random, means.tolist()))
    assert found.between == pytest.approx(5.0 * ERROR, rel=0.15)
    assert found.mean.stderr == pytest.approx(np.hypot(5.0, 1.0) * ERROR / np.sqrt(200), rel=0.15)
    (same,) = compared(_drawn(random, np.ones((200, 1)).tolist()))
    assert same.between < 0.5 * ERROR


def test_two_logs_have_no_trend_and_a_joint_of_one_log_alone_no_comparison() -> None:
    logs = _drawn(np.random.default_rng(4), np.ones((2, 2)).tolist())
    only: Values = {"joint0": logs[1]["joint0"]}
    found = compared([logs[0], only], {"temperature": [1.0, 2.0]})
    assert [(one.joint, one.trends) for one in found] == [("joint0", ())]


def test_the_command_compares_logs_of_an_arm(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The elbow's friction is 8 % higher in the last log; a second call takes up what is there."""
    arm = load_arm(FILE)
    for i, more in enumerate((1.0, 1.0, 1.08)):
        elbow = Friction(FRICTION["elbow"].f_k * more, FRICTION["elbow"].c)
        write(excited(arm, {**FRICTION, "elbow": elbow}, arm.joints, 8.0, seed=20 + i), tmp_path / f"log{i}.csv")
    (tmp_path / "days.csv").write_text("file,day\nlog0.csv,1\nlog1.csv,2\nlog2.csv,9\n")
    out = tmp_path / "out"
    logs = [str(tmp_path / f"log{i}.csv") for i in range(3)]
    options = ["--robot", str(FILE), "--conditions", str(tmp_path / "days.csv"), "--engine", "mujoco", "--jobs", "1"]
    assert run(["diagnose", *logs, *options, "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    assert "elbow: friction at" in printed
    assert "differs between logs" in printed
    data: dict[str, Any] = json.loads((out / "fleet.json").read_text())
    Draft202012Validator(json.loads(schema_text("harness.fleet/1", FleetResult))).validate(data)
    rows = {(row["joint"], row["parameter"]): row for row in data["rows"]}
    slow = rows["elbow", "slow"]
    assert slow["differs"]
    assert slow["apart"].endswith("log2.csv")
    # two logs alike and one 8 % higher: a standard deviation of 4.6 % of dry friction, less of all friction
    assert 0.02 < slow["between"] / slow["mean"]["value"] < 0.06
    assert {joint for (joint, _), row in rows.items() if row["differs"]} == {"elbow"}
    assert [log["conditions"] for log in data["logs"]] == [{"day": 1.0}, {"day": 2.0}, {"day": 9.0}]
    verdicts = [json.loads((out / f"log{i}" / "result.json").read_text())["verdict"] for i in range(3)]
    assert verdicts == ["adequate"] * 3
    page = (out / "index.html").read_text()
    assert "Joints over logs" in page
    stamps = [(out / f"log{i}" / "result.json").stat().st_mtime_ns for i in range(3)]
    assert run(["diagnose", *logs, *options, "--out", str(out), "--resume", "--quiet"]) == 0
    assert stamps == [(out / f"log{i}" / "result.json").stat().st_mtime_ns for i in range(3)]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("name,day\na.csv,1\n", "a CSV with a column file"),
        ("", "a CSV with a column file"),
        ("file,day\na.csv,monday\n", "line 2, column day: 'monday'"),
    ],
)
def test_conditions_that_are_none_are_refused_in_one_line(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "days.csv").write_text(text)
    with pytest.raises(InputError, match=said):
        read_conditions(tmp_path / "days.csv")
