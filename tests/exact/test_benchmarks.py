"""The benchmark runner: its JSON, its exit codes, its arithmetic. No time is asserted."""

import json
import os
import subprocess
import sys
from pathlib import Path

CHECKOUT = Path(__file__).resolve().parents[2]
KEYS = {"name", "ours_s", "peer", "peer_s", "ratio", "target", "met", "timed"}


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(CHECKOUT)}
    command = [sys.executable, "-m", "benchmarks", *arguments]
    return subprocess.run(command, cwd=CHECKOUT, env=environment, capture_output=True, text=True, check=False)


def test_standard_output_is_json_alone() -> None:
    done = run("--only", "exact.sensitivities", "--json", "-")
    assert done.returncode == 0, done.stderr
    (row,) = json.loads(done.stdout)["rows"]
    assert set(row) == KEYS
    assert row["ratio"] == row["ours_s"] / row["peer_s"]
    assert row["target"] is None
    assert row["met"] is True


def test_a_file_and_a_table(tmp_path: Path) -> None:
    file = tmp_path / "rows.json"
    done = run("--only", "exact.sensitivities", "--json", str(file))
    assert "exact.sensitivities" in done.stdout
    assert [row["name"] for row in json.loads(file.read_text())["rows"]] == ["exact.sensitivities"]
    assert [path.name for path in tmp_path.iterdir()] == ["rows.json"]


def test_an_unknown_row_is_one_line() -> None:
    done = run("--only", "nonsense")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert "exact.samples" in done.stderr
