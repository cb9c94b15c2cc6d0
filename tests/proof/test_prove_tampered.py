"""Any change of a published proof is rejected and named."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from small_proof import BASELINE, VERDICTS

from harness.app.prove.store import PAGE, RESULT, Store, published_verdicts
from harness.app.prove.verify import verify_proof
from harness.proof.seal import LEDGER, Ledger, digest

pytestmark = pytest.mark.usefixtures("one_version")


def rehashed(folder: Path, change: Callable[[list[dict[str, Any]]], None]) -> None:
    """A forger's change of the transcript, with every hash after it made to fit."""
    entries = json.loads((folder / LEDGER).read_text())["entries"]
    change(entries)
    ledger = Ledger()
    for entry in entries:
        ledger.add(entry["step"], entry["content"])
    ledger.save(folder)


def first(said: dict[str, Any]) -> Any:
    return said[min(said)]


def change_text(name: str, old: str, new: str) -> Callable[[Path], None]:
    def change(folder: Path) -> None:
        text = (folder / name).read_text()
        assert old in text
        (folder / name).write_text(text.replace(old, new, 1))

    return change


def change_verdict(folder: Path) -> None:
    verdicts = published_verdicts(folder / VERDICTS)
    name = min(verdicts)
    verdicts[name] = verdicts[name].replace(b"adequate", b"unexplained")
    Store(folder).pack("harness", verdicts)


def change_baseline(folder: Path) -> None:
    verdicts = published_verdicts(folder / BASELINE)
    name = min(verdicts)
    verdicts[name] = verdicts[name].replace(b"adequate", b"unexplained")
    Store(folder).pack("pysindy", verdicts)
    rehash_files(folder)


def forge(change: Callable[[list[dict[str, Any]]], None]) -> Callable[[Path], None]:
    return lambda folder: rehashed(folder, change)


def forged_answer(entries: list[dict[str, Any]]) -> None:
    answer = first(entries[3]["content"]["answers"])["value"]
    answer["mechanisms"] = ["cubic stiffness" if answer["mechanisms"] == ["stribeck"] else "stribeck"]


def forged_seed(entries: list[dict[str, Any]]) -> None:
    entries[3]["content"]["seed"]["value"] += 1


def forged_recording(entries: list[dict[str, Any]]) -> None:
    case = first(entries[1]["content"]["cases"])
    case["recording"] = "0" * 64
    case["lines"][1] = case["lines"][2]


def forged_sizes(entries: list[dict[str, Any]]) -> None:
    entries[0]["content"]["sizes"]["controls"] += 1


def dropped_case(entries: list[dict[str, Any]]) -> None:
    name = min(entries[1]["content"]["cases"])
    del entries[1]["content"]["cases"][name], entries[2]["content"]["cases"][name]
    del entries[3]["content"]["answers"][name]
    for said in entries[2]["content"]["baselines"].values():
        del said[name]


def swapped(entries: list[dict[str, Any]]) -> None:
    entries[2], entries[3] = entries[3], entries[2]


def forged_result(folder: Path) -> None:
    """A better score, with the hash of the file made to fit."""
    change_text(RESULT, '"hits": 0,', '"hits": 1,')(folder)
    rehash_files(folder)


def rehash_files(folder: Path) -> None:
    def change(entries: list[dict[str, Any]]) -> None:
        files = entries[4]["content"]["files"]
        entries[4]["content"]["files"] = {name: digest((folder / name).read_bytes()) for name in files}

    rehashed(folder, change)


def forged_verdict(folder: Path) -> None:
    change_verdict(folder)
    rehash_files(folder)


def forged_recording_alone(folder: Path) -> None:
    shutil.rmtree(folder / "recordings")
    rehashed(folder, forged_recording)


def emptied(entries: list[dict[str, Any]]) -> None:
    entries[3]["content"].clear()


def change_recording(folder: Path) -> None:
    with next((folder / "recordings").iterdir()).open("a") as file:
        file.write("0,0\n")


def no_verdicts(folder: Path) -> None:
    (folder / VERDICTS).write_bytes(b"none")


def file_elsewhere(entries: list[dict[str, Any]]) -> None:
    entries[4]["content"]["files"]["../../../etc/passwd"] = "0" * 64


def absolute_file(entries: list[dict[str, Any]]) -> None:
    entries[4]["content"]["files"]["/etc/passwd"] = "0" * 64


def diagnoser_elsewhere(entries: list[dict[str, Any]]) -> None:
    said = entries[2]["content"]["baselines"]
    said["../../secret"] = said.pop("pysindy")


def page_is_a_link(folder: Path) -> None:
    (folder / PAGE).unlink()
    (folder / PAGE).symlink_to("/etc/passwd")


def recording_is_a_link(folder: Path) -> None:
    recording = min((folder / "recordings").iterdir())
    recording.rename(folder / "moved.csv")
    recording.symlink_to(folder / "moved.csv")


def endless(entries: list[dict[str, Any]]) -> None:
    entries[0]["content"]["sizes"]["controls"] = 10**12


def no_sizes(entries: list[dict[str, Any]]) -> None:
    entries[0]["content"]["sizes"] = None


TAMPERED: dict[str, tuple[Callable[[Path], None], str]] = {
    "the transcript": (change_text(LEDGER, '"index": 0', '"index": 1'), "entry 4 of the transcript was changed"),
    "a hash": (change_text(LEDGER, '"hash": "', '"hash": "0'), "entry 1 of the transcript was changed"),
    "the result": (change_text(RESULT, '"hits": 0,', '"hits": 1,'), "result.json was changed"),
    "the page": (change_text(PAGE, "No evidence", "Evidence"), "report.html was changed"),
    "a verdict": (change_verdict, f"{VERDICTS} was changed"),
    "the page is gone": (lambda folder: (folder / PAGE).unlink(), "report.html is missing"),
    "the verdicts are gone": (lambda folder: (folder / VERDICTS).unlink(), f"{VERDICTS} is missing"),
    "no verdicts": (no_verdicts, "no verdicts of a proof"),
    "a recording": (change_recording, ".csv was changed"),
    "a forged verdict": (forged_verdict, "the verdict was changed"),
    "a forged verdict of a baseline": (change_baseline, "the verdict of pysindy was changed"),
    "a forged answer": (forge(forged_answer), "the answer is not the one that was sealed"),
    "a forged seed": (forge(forged_seed), "the seed is not the one that was committed to"),
    "a forged recording": (forged_recording_alone, "the recording is not the one that follows from the seed"),
    "forged sizes": (forge(forged_sizes), "1 recordings of the plan are missing"),
    "a case dropped": (forge(dropped_case), "1 recordings of the plan are missing"),
    "opened too early": (forge(swapped), "the steps of the transcript are not in their order"),
    "an entry without content": (forge(emptied), "the transcript does not hold what one holds"),
    "a file elsewhere": (forge(file_elsewhere), "the file name '../../../etc/passwd'; a name inside the folder of"),
    "an absolute file": (forge(absolute_file), "the file name '/etc/passwd'; a name inside the folder of the proof"),
    "a diagnoser elsewhere": (forge(diagnoser_elsewhere), "the file name 'verdicts/../../secret.jsonl.gz'; a name"),
    "a link": (page_is_a_link, "the file name 'report.html'; a name inside the folder of the proof is accepted"),
    "a recording that is a link": (recording_is_a_link, ".csv was changed"),
    "sizes without end": (forge(endless), "recordings of the plan are missing"),
    "no sizes": (forge(no_sizes), "the transcript does not hold what one holds"),
    "a forged result": (forged_result, "result.json: figures does not follow from answers and verdicts"),
}


@pytest.mark.parametrize("what", TAMPERED)
def test_any_change_is_rejected_and_named(proof: Path, what: str) -> None:
    tamper, message = TAMPERED[what]
    tamper(proof)
    check = verify_proof(proof, jobs=1)
    assert not check.accepted
    assert any(message in line for line in check.wrong), check.wrong
