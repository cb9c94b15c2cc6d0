"""harness dataset emps: where its two files come from, and what is refused."""

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from harness.app.dataset import dataset_machines, download_emps, listed
from harness.cli.main import run
from harness.core.errors import InputError


def test_a_download_goes_where_it_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fetch(data_file_locations: bool, dir_placement: str) -> list[str]:
        assert data_file_locations
        return [f"{dir_placement}/EMPS/DATA_EMPS.mat", f"{dir_placement}/EMPS/DATA_EMPS_PULSES.mat"]

    monkeypatch.setitem(sys.modules, "nonlinear_benchmarks", SimpleNamespace(EMPS=fetch))
    assert download_emps(tmp_path / "into") == tmp_path / "into" / "EMPS"
    assert (tmp_path / "into").is_dir()


def test_a_failed_download_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def fetch(**_: object) -> list[str]:
        raise OSError("no route\nto host")

    monkeypatch.setitem(sys.modules, "nonlinear_benchmarks", SimpleNamespace(EMPS=fetch))
    into = tmp_path / "into"
    assert run(["dataset", "emps", "--download", str(into)]) == 1
    assert capfd.readouterr().err == f"harness: the download into {into} failed: no route to host\n"


def test_machines_of_a_folder_are_diagnosed_as_its_own_list_says(tmp_path: Path) -> None:
    """A damped swing with cubic stiffness, listed in a machines.toml; what is not there is said, a bad one is a row."""
    t = np.arange(1200) / 200.0
    x = 0.05 * np.exp(-0.3 * t) * np.cos(2.0 * np.pi * 2.0 * t)
    np.savetxt(tmp_path / "swing.csv", np.column_stack((t, x)), delimiter=",", header="t,x", comments="")
    (tmp_path / "bad.csv").write_text("t,x\n0,1\n")
    entries = "".join(f'[[machine]]\nname = "{n}"\nfile = "{n}.csv"\nothers = "?"\n' for n in ("swing", "bad"))
    (tmp_path / "machines.toml").write_text(f"{entries}options = {{ to = 5.0 }}\n")
    found = dataset_machines(tmp_path, tmp_path / "out", jobs=1)
    assert [row.verdict for row in found.rows] == ["adequate", "error"]
    assert "jlefebvre_q2.csv" in found.absent
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "2 recordings of real machines" in page


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[[machine]", "no TOML"),
        ('[[machine]]\nname = "a"\n', "machine 1: unknown or missing words"),
        ('[[machine]]\nname = "a"\nfile = "a.csv"\noptions = { colums = "x" }\n', "the option colums"),
        ('[[machine]]\nname = "a"\nfile = "a.csv"\noptions = { restoring = "sprung" }\n', "--restoring"),
    ],
)
def test_a_bad_list_is_one_line(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "machines.toml").write_text(text)
    with pytest.raises(InputError) as error:
        listed(tmp_path)
    assert message in str(error.value)
    assert "\n" not in str(error.value)
