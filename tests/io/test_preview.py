"""Before anything is fitted: what is proposed was tried and shows its rows; what was read can be looked at."""

import json
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from layouts import WRITERS, drawn, lines, rows

from harness.app.shared.reading import read_runs
from harness.cli.main import run
from harness.core.errors import InputError
from harness.io.options import ReadOptions
from harness.io.recording import read_recording

T = np.arange(400) / 200.0
X = np.exp(-0.5 * T) * np.cos(10.0 * T)


def table(path: Path, header: str, *columns: np.ndarray) -> Path:
    return lines(path, header, *rows(",", *columns, digits="%.9g"))


def test_a_proposal_is_a_whole_command_with_the_rows_it_reads(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = table(tmp_path / "two axes.csv", "time,left,right", T, X, 1.1 * X)
    line = ["identify", str(path), "--skip-rows", "0", "--json", "-"]
    assert run(line) == 2
    said = capsys.readouterr().err
    proposed = re.search(r"Try: (harness .*), which reads (.*)$", said)
    assert proposed is not None, said
    assert "t 0, 0.005, 0.01 s" in proposed[2]
    words = shlex.split(proposed[1])
    assert words[:2] == ["harness", "identify"]
    assert str(path) in words
    monkeypatch.chdir(tmp_path)
    assert run(words[1:]) == 0


@pytest.mark.parametrize("name", ["vernier_runs", "phyphox_german", "labx"])
def test_what_was_read_is_shown_and_plotted(tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    rng = np.random.default_rng(1)
    path, wanted = WRITERS[name](tmp_path, drawn(rng), rng)
    page, result = tmp_path / "page.html", tmp_path / "log.json"
    assert run(["log", str(path), "--page", str(page), "--json", str(result)]) == 0
    shown = capsys.readouterr().out
    assert any(0x2800 < ord(letter) < 0x2900 for letter in shown)
    found = json.loads(result.read_text())["recording"]
    (channel,) = set(wanted) - {"t"}
    np.testing.assert_allclose(found["first"][channel], wanted[channel][:3], atol=1e-6)
    np.testing.assert_allclose(found["ranges"][channel], [wanted[channel].min(), wanted[channel].max()], atol=1e-6)
    assert len(found["envelope"][channel]) <= 144
    assert "<html" in page.read_text(encoding="utf-8")


def test_of_a_pendulum_what_has_no_unit_is_an_angle(tmp_path: Path) -> None:
    asked = ReadOptions(angle=True)
    found = read_recording(table(tmp_path / "a.csv", "t,x,v", T, X, np.gradient(X, T)), asked)
    assert found.angular
    np.testing.assert_allclose(found["x"], X, rtol=1e-8)
    found = read_recording(table(tmp_path / "b.csv", "time,adc", T, 40.0 * X), asked)
    np.testing.assert_allclose(found["x"], np.deg2rad(40.0 * X), rtol=1e-8)
    with pytest.raises(InputError, match="holds no angle"):
        read_recording(table(tmp_path / "c.csv", "t,x [mm]", T, X), asked)
    with pytest.raises(InputError, match="counts of 4096 a turn"):
        read_recording(table(tmp_path / "d.csv", "t,x", T, 900.0 + 300.0 * X), asked)


CLOCKS = [("t", 0.0, 0.0), ("stamp", 1.7e9, 1.7e9), ("stamp", 1.7e9, 1.7e9 + 0.4)]


@pytest.mark.parametrize(("clock", "one", "other"), CLOCKS)
def test_one_signal_a_file_is_one_motion(tmp_path: Path, clock: str, one: float, other: float) -> None:
    fine = np.arange(1200) / 400.0
    shift = other - one
    v = np.cos(3.0 * (fine + shift))
    x = lines(tmp_path / "position.csv", f"{clock},value", *rows(",", one + T, np.sin(3.0 * T) / 3.0, digits="%.9f"))
    beside = lines(tmp_path / "velocity.csv", f"{clock},value", *rows(",", other + fine, v, digits="%.9f"))
    found = read_recording(x, ReadOptions(join=(beside,)))
    assert found.t[0] == pytest.approx(max(shift, 0.0), abs=0.006)
    np.testing.assert_allclose(found["x"], np.sin(3.0 * found.t) / 3.0, atol=1e-6)
    np.testing.assert_allclose(found["v"], np.cos(3.0 * found.t), atol=1e-3)
    assert any("velocity.csv, at the times of position.csv" in note for note in found.notes)
    with pytest.raises(InputError, match="both hold x"):
        read_recording(x, ReadOptions(join=(x,)))


@pytest.mark.parametrize("name", ["vernier_runs", "runs_below", "matlab_trials"])
def test_the_runs_of_one_file_are_so_many_recordings(tmp_path: Path, name: str) -> None:
    rng = np.random.default_rng(2)
    path, wanted = WRITERS[name](tmp_path, drawn(rng), rng)
    found = read_runs(str(path), path, ReadOptions())
    assert len(found) == (3 if name == "vernier_runs" else 2)
    np.testing.assert_allclose(found[0]["x"], wanted["x"], atol=1e-5)
    assert len({one.file for one in found}) == len(found)
    assert len(read_runs(str(path), path, ReadOptions(run=2))) == 1
