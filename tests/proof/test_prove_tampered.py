"""A proof from end to end: published, verified, refused where it cannot be; any change is seen and named."""

import json
import secrets
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from small_proof import BASELINE, SIZES, STUB, VERDICTS

from harness.app.prove.prove import ProveOptions, prove
from harness.app.prove.store import PAGE, RESULT, Store, published_verdicts
from harness.app.prove.verify import verify_proof
from harness.core.errors import InputError, StoreError
from harness.proof.seal import LEDGER, Ledger, Sealed, digest, open_all, seal_recordings, seal_seed, seal_verdicts
from harness.proof.verify import check_verdicts
from harness.results.generate import FOLDER

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
    "a file elsewhere": (forge(file_elsewhere), "the file name '../../../etc/passwd'; expected a name"),
    "an absolute file": (forge(absolute_file), "the file name '/etc/passwd'; expected a name"),
    "a diagnoser elsewhere": (forge(diagnoser_elsewhere), "the file name 'verdicts/../../secret.jsonl.gz'; expected"),
    "a link": (page_is_a_link, "the file name 'report.html'; expected a name inside the folder of the proof"),
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


def test_what_is_published_is_whole_and_valid(published: Path) -> None:
    found = {str(file.relative_to(published)) for file in published.rglob("*") if file.is_file()}
    recordings = {name for name in found if name.startswith("recordings/")}
    assert len(recordings) == 6
    others = {f"verdicts/{name}.jsonl.gz" for name in ("r2", "pysindy", "mujoco.sysid")}
    assert found - recordings == {LEDGER, RESULT, PAGE, VERDICTS, "log.txt"} | others
    data = json.loads((published / RESULT).read_text())
    jsonschema.validate(data, json.loads((FOLDER / "harness.proof-1.json").read_text()))
    assert not data["evidence"]
    figures = {figure["key"]: figure for figure in data["figures"]}
    assert (figures["named"]["hits"], figures["named"]["cases"]) == (0, 2)
    assert (figures["false_alarms"]["hits"], figures["false_alarms"]["cases"]) == (0, 3)
    assert data["forced"]["worst"] == 1.0
    assert len(data["not_tested"]) == 25
    assert len(data["cases"]) == 6
    # both say that nothing is left out, and the baseline of the stub predicts worse by two
    margins = {(one["name"], one["what"].split(",")[0]): one for one in data["baselines"]}
    assert all(one["value"] == 0.0 and not one["beaten"] for one in data["baselines"] if one["share"] and one["cases"])
    assert ("mujoco.sysid", "held-out rmse where an effect is hidden") in margins or not figures["holdout"]["cases"]
    assert {one["name"] for one in data["must_fail"]} >= {"answers at random", "always says stribeck"}
    page = (published / PAGE).read_text()
    assert "No evidence: 6 recordings are too few" in page
    assert len(page) < 5_000_000


def test_an_honest_proof_is_accepted(published: Path) -> None:
    check = verify_proof(published, jobs=1)
    assert (check.accepted, check.wrong, check.recordings, check.drawn_again, check.identical) == (True, [], 6, 6, 6)
    data = json.loads(check.model_dump_json(by_alias=True))
    jsonschema.validate(data, json.loads((FOLDER / "harness.proof-check-1.json").read_text()))


def test_recordings_need_not_be_published(proof: Path) -> None:
    shutil.rmtree(proof / "recordings")
    assert verify_proof(proof, short=True, jobs=1).accepted


def test_a_folder_that_is_taken_and_a_proof_that_is_not_there_are_refused(published: Path, tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="holds files already"):
        prove(ProveOptions(SIZES, blind=STUB), published)
    with pytest.raises(InputError, match="--resume: given without --out"):
        prove(ProveOptions(SIZES, resume=True))
    with pytest.raises(InputError, match="holds no proof to resume"):
        prove(ProveOptions(SIZES, resume=True), tmp_path)


SAID = b'{"verdict": "adequate"}'


def published(folder: Path) -> Path:
    """The transcript of a small proof."""
    ledger = Ledger()
    seed = seal_seed(ledger, {"harness": "0"})
    names = [secrets.token_hex(8) for _ in range(3)]
    recordings = {name: f"t,x\n0,{i}\n".encode() for i, name in enumerate(names)}
    answers = {name: Sealed({"mechanisms": ["stribeck"] if i else []}) for i, name in enumerate(names)}
    seal_recordings(ledger, recordings, answers)
    seal_verdicts(ledger, dict.fromkeys(names, SAID))
    open_all(ledger, seed, answers)
    ledger.save(folder)
    return folder


def test_a_changed_a_missing_and_an_added_verdict_are_named(tmp_path: Path) -> None:
    ledger = Ledger.load(published(tmp_path))
    first, second, third = sorted(ledger.content("verdicts sealed")["cases"])
    assert check_verdicts(ledger, None, dict.fromkeys((first, second, third), SAID)) == []
    found = check_verdicts(ledger, None, {first: SAID + b" ", third: SAID, "other": SAID})
    assert found == [
        f"{second}: the verdict is missing",
        "other: a verdict that was not sealed",
        f"{first}: the verdict was changed",
    ]


def test_a_commitment_tells_nothing_without_its_salt() -> None:
    # the same answer is sealed differently every time, so a list of all answers does not open it
    assert Sealed({"mechanisms": []}).commitment != Sealed({"mechanisms": []}).commitment
