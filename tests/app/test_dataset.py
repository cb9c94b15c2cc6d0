"""harness dataset emps: where its two files come from, and what is refused."""

import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from bad_input import refuses

from harness.app.dataset.download import download_emps
from harness.cli.main import run

BAD = [
    ("dataset emps", "--from, --download: neither; one of the two is accepted"),
    ("dataset emps --from a --download b", "--from, --download: both; one of the two is accepted"),
    ("dataset emps --from nowhere", "nowhere/DATA_EMPS.mat: no such file; a folder with DATA_EMPS.mat and"),
    ("dataset emps --from .", "DATA_EMPS.mat: sha256 2c26b46b68ff...; the published file, 6cf6814ae146..., is"),
    ("dataset emps --download new", "--download: the package nonlinear_benchmarks is not installed; the extra is"),
]


@pytest.mark.parametrize(("line", "message"), BAD, ids=[line for line, _ in BAD])
def test_bad_input_is_one_line(
    line: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "nonlinear_benchmarks", None)
    (tmp_path / "DATA_EMPS.mat").write_text("foo")
    refuses(line, message, capfd)
    assert [entry.name for entry in tmp_path.iterdir()] == ["DATA_EMPS.mat"]


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
