"""A log in several files, each with one signal: as one file that has them all."""

from pathlib import Path

import numpy as np
import pytest

from harness.cli.main import run
from harness.core.errors import InputError
from harness.core.robot import JointLog
from harness.io.logs.read import read_joint_log

RATE = 250.0
T = np.arange(300) / RATE
Q = np.stack([np.sin(T), np.cos(2 * T)], axis=1)
U = np.stack([3.0 * np.cos(T), -2.0 * np.sin(3 * T)], axis=1)


def table(path: Path, values: np.ndarray, header: str = "") -> Path:
    np.savetxt(path, values, delimiter=",", header=header, comments="")
    return path


def log_of(folder: Path, q: str, tau: str, times: tuple[bool, bool] = (False, False)) -> JointLog:
    parts = [np.column_stack((T, y)) if timed else y for y, timed in zip((Q, U), times, strict=True)]
    first, other = table(folder / "q.csv", parts[0], q), table(folder / "tau_measured.csv", parts[1], tau)
    return read_joint_log(first, join=(other,), rate=None if any(times) else RATE)


@pytest.mark.parametrize(
    ("q", "tau", "times", "names"),
    [
        ("", "", (False, False), ("joint1", "joint2")),
        ("hip,knee", "", (False, False), ("hip", "knee")),
        ("t,hip,knee", "hip [N*mm],knee [N*mm]", (True, False), ("hip", "knee")),
        ("t [s],q0,q1", "t [s],tau0,tau1", (True, True), ("joint1", "joint2")),
    ],
)
def test_files_of_one_signal_are_a_log(
    tmp_path: Path, q: str, tau: str, times: tuple[bool, bool], names: tuple[str, str]
) -> None:
    log = log_of(tmp_path, q, tau, times)
    assert log.t == pytest.approx(T)
    for i, name in enumerate(names):
        assert log.position[name] == pytest.approx(Q[:, i])
        assert log.effort[name] == pytest.approx(U[:, i] * (1e-3 if "mm" in tau else 1.0))


def test_another_clock_is_read_at_the_times_of_the_first(tmp_path: Path) -> None:
    q = table(tmp_path / "q.csv", np.column_stack((T, Q)), "t,a,b")
    wide = np.column_stack((np.linspace(-0.1, 1.5, 4000), np.linspace(-0.2, 3.0, 4000), np.ones(4000)))
    log = read_joint_log(q, join=(table(tmp_path / "tau.csv", wide, "t,a,b"),))
    assert log.effort["a"] == pytest.approx(2.0 * T, abs=1e-9)
    assert any("times of its own" in note for note in log.notes)


@pytest.mark.parametrize(
    ("name", "values", "header", "said"),
    [
        ("second.csv", U, "", "neither its columns nor its name 'second' say what it holds"),
        ("tau.csv", U[:-1], "", "columns of 299 to 300 values"),
        ("q.csv", Q, "", "which another file has too"),
        ("tau.csv", np.column_stack((T, U)), "t [ms],a,b", "times in t"),
    ],
)
def test_what_is_no_part_of_the_log_is_refused(
    tmp_path: Path, name: str, values: np.ndarray, header: str, said: str
) -> None:
    (tmp_path / "other").mkdir()
    timed = header.startswith("t")
    first = table(tmp_path / "q.csv", np.column_stack((T, Q)) if timed else Q, "t,a,b" if timed else "")
    other = table(tmp_path / "other" / name, values, header)
    with pytest.raises(InputError, match=said):
        read_joint_log(first, join=(other,), rate=None if timed else RATE)


def test_the_command_takes_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log_of(tmp_path, "", "")
    files = [str(tmp_path / "q.csv"), "--join", str(tmp_path / "tau_measured.csv")]
    assert run(["log", *files, "--rate", "250"]) == 0
    assert "effort" in capsys.readouterr().out
    assert run(["log", *files]) == 2
    assert "--rate HZ" in capsys.readouterr().err
