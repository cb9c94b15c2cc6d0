"""Several recordings in one call: order, failures, processes that die, resumption."""

import json
import os
import time
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from diagnose_examples import example

from harness.app.diagnose import one
from harness.app.diagnose.many import Answer, Work, compute, diagnose, diagnose_all, failed, folder_names
from harness.app.diagnose.one import FILES
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.shared.reading import ReadOptions
from harness.core.errors import InputError, SimulationError, StoreError
from harness.io.recording import sha256
from harness.results import generate
from harness.results.diagnosis import DiagnosisResult, FailedDiagnosis

NAMES = ("a.csv", "b.csv", "bad.csv", "c.csv", "d.csv")


def stand_in(work: Work) -> Answer:
    """A worker that reads the file instead of diagnosing it, dies of one, is long at one, and fails with another."""
    text = work.path.read_text()
    if "die" in text:
        os._exit(3)
    if "full" in text:
        raise StoreError("a.csv: no space left on the device")
    if "long" in text:
        time.sleep(600)
    if "bad" in text:
        return failed(work.label, "bad.csv: 0 rows; at least 50 are accepted")
    work.folder.mkdir(exist_ok=True)
    report = work.folder / FILES["report"]
    report.write_text("")
    result = example(
        work.label, sha256(work.path), settings=work.options.settings(), files={"report": str(report)}, warnings=[text]
    )
    (work.folder / FILES["result"]).write_text(result.model_dump_json(by_alias=True))
    return result


def write(folder: Path, **content: str) -> list[tuple[Path, str]]:
    for name in NAMES:
        (folder / name).write_text(content.get(name.split(".")[0], name))
    return [(folder / name, str(folder / name)) for name in NAMES]


def test_answers_keep_the_order_and_a_bad_file_does_not_stop_the_rest(tmp_path: Path) -> None:
    many = diagnose_all(write(tmp_path), DiagnoseOptions(), tmp_path / "out", 1, function=stand_in)
    assert [Path(answer.recording.file).name for answer in many.answers] == list(NAMES)
    assert [type(answer) for answer in many.answers].count(FailedDiagnosis) == many.failed == 1
    data = json.loads((tmp_path / "out" / "result.json").read_text())
    jsonschema.validate(data, json.loads((generate.FOLDER / "harness.diagnosis-2.json").read_text()))
    assert data[2] == {
        "schema": "harness.diagnosis/2",
        "recording": {"file": str(tmp_path / "bad.csv")},
        "verdict": "error",
        "error": "bad.csv: 0 rows; at least 50 are accepted",
        "mechanisms": [],
    }
    page = (tmp_path / "out" / "index.html").read_text()
    assert '<a href="a/report.html">a.csv</a>' in page
    assert "could not be diagnosed" in page


def test_a_process_that_dies_costs_one_file(tmp_path: Path) -> None:
    # two: one dies, and the other, whose pool breaks with it, is tried again; every new process costs an import of all
    named = write(tmp_path, b="die")[:2]
    many = diagnose_all(named, DiagnoseOptions(), tmp_path / "out", 2, function=stand_in)
    errors = {Path(a.recording.file).name: a.error for a in many.answers if isinstance(a, FailedDiagnosis)}
    assert [Path(a.recording.file).name for a in many.answers] == ["a.csv", "b.csv"]
    assert set(errors) == {"b.csv"}
    assert errors["b.csv"] == "the process that worked on it ended early (BrokenProcessPool)"


def test_resumption_computes_what_is_not_there_and_refuses_what_is_of_other_options(tmp_path: Path) -> None:
    named = write(tmp_path)
    diagnose_all(named[:3], DiagnoseOptions(), tmp_path / "out", 1, function=stand_in)
    computed: list[str] = []

    def counting(work: Work) -> Answer:
        computed.append(work.path.name)
        return stand_in(work)

    many = diagnose_all(named, DiagnoseOptions(), tmp_path / "out", 1, True, function=counting)
    # what failed is tried again
    assert computed == ["bad.csv", "c.csv", "d.csv"]
    assert len(many.answers) == len(NAMES)
    other = DiagnoseOptions.chosen(ReadOptions(rate=100.0), mass=2.0)
    with pytest.raises(InputError, match="--resume: a was made with another rate_hz, mass_kg; "):
        diagnose_all(named, other, tmp_path / "out", 1, True, function=counting)
    named[0][0].write_text("changed")
    with pytest.raises(InputError, match=r"--resume: a was made of another file than .*a\.csv; "):
        diagnose_all(named, DiagnoseOptions(), tmp_path / "out", 1, True, function=counting)
    with pytest.raises(InputError, match="--resume: given without --out; "):
        diagnose_all(named, DiagnoseOptions(), None, 1, True)


@pytest.mark.parametrize("jobs", [2])
def test_a_full_disk_ends_the_call_and_not_one_file_after_the_other(jobs: int, tmp_path: Path) -> None:
    # what is in work beside it is not waited for
    named = write(tmp_path, c="full", d="long")
    with pytest.raises(StoreError, match=r"no space left on the device; [23] of 5 recordings are kept, the same comm"):
        diagnose_all(named, DiagnoseOptions(), tmp_path / "out", jobs, function=stand_in)
    named = write(tmp_path)
    assert len(diagnose_all(named, DiagnoseOptions(), tmp_path / "out", 1, True, function=stand_in).answers) == len(
        NAMES
    )


def test_files_of_one_name_get_folders_of_their_own() -> None:
    assert folder_names(["x/a.csv", "y/a.csv.gz", "-", "b.csv"]) == ["a", "a-2", "stdin", "b"]


def test_a_file_that_cannot_be_read_is_an_entry(tmp_path: Path) -> None:
    (tmp_path / "two.csv").write_text("t,x\n0,1\n1,2\n")
    answer = compute(Work(tmp_path / "two.csv", "two.csv", tmp_path / "out"))
    assert not isinstance(answer, DiagnosisResult)
    assert answer.error == "two.csv: 2 samples; at least 50 are accepted"
    assert not (tmp_path / "out").exists()


def test_the_file_and_what_may_be_asked_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def unfollowed(*_: object) -> None:
        raise SimulationError("the model could not be followed beyond t = 0.3 s: it diverged")

    monkeypatch.setattr(one, "conclude", unfollowed)
    t = np.arange(400.0) / 200.0
    file = tmp_path / "a.csv"
    file.write_text("t,x\n" + "".join(f"{s},{0.1 * np.exp(-0.5 * s) * np.cos(10.0 * s)}\n" for s in t))
    with pytest.raises(SimulationError) as caught:
        diagnose(file, DiagnoseOptions(), tmp_path / "out")
    assert str(caught.value) == (
        f"{file}: the model could not be followed beyond t = 0.3 s: it diverged; a part of it (--from, --to), or"
        " another --restoring or --zero, may be accepted"
    )
    assert not (tmp_path / "out").exists()
