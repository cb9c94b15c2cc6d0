"""The benchmark runner: its JSON, its exit codes, its arithmetic. No time is asserted."""

import json
from pathlib import Path

import pytest

from benchmarks.__main__ import main

KEYS = {"name", "ours_s", "peer", "peer_s", "ratio", "target", "met", "timed"}


def test_standard_output_is_json_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--only", "exact.sensitivities", "--json", "-"]) == 0
    (row,) = json.loads(capsys.readouterr().out)["rows"]
    assert set(row) == KEYS
    assert row["ratio"] == row["ours_s"] / row["peer_s"]
    assert row["target"] is None
    assert row["met"] is True


def test_a_file_and_a_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "rows.json"
    assert main(["--only", "exact.sensitivities", "--json", str(file)]) == 0
    assert "exact.sensitivities" in capsys.readouterr().out
    assert [row["name"] for row in json.loads(file.read_text())["rows"]] == ["exact.sensitivities"]
    assert [path.name for path in tmp_path.iterdir()] == ["rows.json"]


def test_an_unknown_row_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--only", "nonsense"]) == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert "exact.samples" in err
