"""A proof from end to end: published, verified, changed and rejected, interrupted and resumed, cheated in vain."""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import jsonschema
import prove_cheater
import prove_stub
import pytest
from dask_cluster import two_workers
from interruptible import listening

from harness.app import prove as room
from harness.app.prove import ProveOptions, prove
from harness.app.prove_publish import PAGE, RESULT
from harness.app.prove_store import Store, published_verdicts
from harness.app.prove_verify import verify_proof
from harness.core.errors import InputError, StoreError
from harness.proof.blind import BlindProcess
from harness.proof.plan import Sizes
from harness.proof.seal import LEDGER, Ledger
from harness.results.generate import FOLDER

STUB = (sys.executable, str(Path(prove_stub.__file__)))
SIZES = Sizes(2, 3, 0, 1)
VERDICTS = "verdicts/harness.jsonl.gz"
BASELINE = "verdicts/pysindy.jsonl.gz"
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module", autouse=True)
def _one_version() -> Iterator[None]:
    """Somebody may be working on the sources while this runs."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(room, "code_digest", lambda: "the same")
        yield


@pytest.fixture(scope="module")
def published(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small proof of a diagnosis that says of everything that nothing is left out."""
    folder = tmp_path_factory.mktemp("proof") / "done"
    prove(ProveOptions(SIZES, jobs=1, blind=STUB), folder)
    return folder


@pytest.fixture
def proof(published: Path, tmp_path: Path) -> Path:
    """A copy to change."""
    shutil.copytree(published, tmp_path / "proof")
    return tmp_path / "proof"


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


def test_a_cluster_makes_a_proof_like_the_local_pool(tmp_path: Path) -> None:
    with two_workers() as (address, _):
        result = prove(ProveOptions(SIZES, cluster=address, blind=STUB), tmp_path / "out")
    assert len(result.cases) == SIZES.total
    assert all(case.said == "nothing" for case in result.cases)
    assert verify_proof(tmp_path / "out").accepted


def test_recordings_need_not_be_published(proof: Path) -> None:
    shutil.rmtree(proof / "recordings")
    assert verify_proof(proof, short=True, jobs=1).accepted


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
    first(entries[3]["content"]["answers"])["value"]["mechanisms"] = ["stribeck"]


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
    from harness.proof.seal import digest

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
    "a forged result": (forged_result, "result.json: figures does not follow from answers and verdicts"),
}


@pytest.mark.parametrize("what", TAMPERED)
def test_any_change_is_rejected_and_named(proof: Path, what: str) -> None:
    tamper, message = TAMPERED[what]
    tamper(proof)
    check = verify_proof(proof, jobs=1)
    assert not check.accepted
    assert any(message in line for line in check.wrong), check.wrong


def test_a_folder_without_a_proof_is_bad_input(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no transcript of a proof"):
        verify_proof(tmp_path)


def test_a_folder_that_is_taken_and_a_proof_that_is_not_there_are_refused(published: Path, tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="holds files already"):
        prove(ProveOptions(SIZES, blind=STUB), published)
    with pytest.raises(InputError, match="--resume: given without --out"):
        prove(ProveOptions(SIZES, resume=True))
    with pytest.raises(InputError, match="holds no proof to resume"):
        prove(ProveOptions(SIZES, resume=True), tmp_path)


def test_a_finished_proof_resumed_is_scored_again_and_stays_what_it_was(proof: Path) -> None:
    before = json.loads((proof / RESULT).read_text())
    prove(ProveOptions(Sizes(1, 0, 0, 0), resume=True, blind=STUB), proof)
    after = json.loads((proof / RESULT).read_text())
    assert after == {**before, "command": after["command"]}
    assert verify_proof(proof, jobs=1).accepted


PROGRAM = """
import sys
from pathlib import Path
from harness.app import prove as room
from harness.app.prove import ProveOptions, prove
from harness.core.errors import HarnessError
from harness.proof.plan import Sizes
if __name__ == "__main__":
    # somebody may be working on the sources while this runs
    room.code_digest = lambda: "the same"
    try:
        options = ProveOptions(Sizes(1, 3, 0, 0), 1, None, "resume" in sys.argv, ("r2",), {blind!r})
        prove(options, Path({out!r}))
    except HarnessError as error:
        print(error)
        sys.exit(error.exit_code)
"""


def waited(condition: Callable[[], bool], seconds: float = 60.0) -> None:
    limit = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < limit, "waited in vain"
        time.sleep(0.05)


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_an_interrupted_proof_is_resumed(tmp_path: Path, how: signal.Signals) -> None:
    out, program = tmp_path / "out", tmp_path / "program.py"
    program.write_text(PROGRAM.format(blind=(*STUB, "slow"), out=str(out)))
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "TMPDIR": str(tmp_path)}

    def run(*arguments: str) -> "subprocess.Popen[str]":
        command = [sys.executable, str(program), *arguments]
        return subprocess.Popen(
            command,
            env=environment,
            stdout=subprocess.PIPE,
            text=True,
            preexec_fn=listening,  # noqa: PLW1509  (no threads here)
        )

    answers, secret = out / "working" / "answers.jsonl", out / "secret" / "seed.json"
    with run() as first_run:
        waited(lambda: answers.is_file() and answers.read_text().count("\n") >= 2)
        # while anything is diagnosed no secret is on disk
        assert not secret.parent.exists()
        first_run.send_signal(how)
        said = first_run.communicate(timeout=60)[0]
    if how is signal.SIGINT:
        assert first_run.returncode == 130
        assert said == (f"interrupted; what is done is kept, the same command with --resume --out {out} goes on\n")
    waited(secret.is_file, 10.0)
    assert secret.stat().st_mode & 0o777 == 0o600
    assert secret.parent.stat().st_mode & 0o777 == 0o700
    kept = answers.read_text()
    # a line that was cut in two is no answer
    answers.write_text(kept + '{"name": "cut')
    with run("resume") as second_run:
        assert second_run.wait(timeout=120) == 0
    assert not secret.parent.exists()
    assert not (out / "working").exists()
    ledger = Ledger.load(out)
    assert [entry["step"] for entry in ledger.entries].count("resumed") == 1
    assert ledger.content("resumed")["kept"] == kept.count("\n")
    assert "readable by the owner alone" in ledger.content("resumed")["secrets"]
    assert verify_proof(out, jobs=1).accepted


def test_a_proof_begun_by_another_version_is_not_gone_on_with(proof: Path) -> None:
    ledger = Ledger.load(proof)
    half = Ledger()
    half.add("seed committed", {**ledger.content("seed committed"), "code": "0" * 64})
    half.save(proof)
    with pytest.raises(InputError, match="was begun by another version of the program"):
        prove(ProveOptions(SIZES, resume=True, blind=STUB), proof)


def test_a_seed_that_is_lost_is_said(proof: Path) -> None:
    ledger = Ledger.load(proof)
    Ledger(ledger.entries[:2]).save(proof)
    with pytest.raises(InputError, match="the seed of proof is lost"):
        prove(ProveOptions(SIZES, resume=True, blind=STUB), proof)


def cheater(tmp_path: Path, out: Path) -> tuple[str, ...]:
    """The cheater with the places to look in."""
    places = [str(out), tempfile.gettempdir(), os.path.expanduser("~")]
    text = Path(prove_cheater.__file__).read_text().replace("PLACES: list[str] = []", f"PLACES = {places!r}")
    program = tmp_path / "diagnosis.py"
    program.write_text(text)
    return sys.executable, str(program)


def test_a_cheater_that_looks_everywhere_finds_no_answer(tmp_path: Path) -> None:
    out = tmp_path / "out"
    blind = cheater(tmp_path, out)
    prove(ProveOptions(Sizes(1, 0, 0, 0), jobs=1, baselines=(), blind=blind), out)
    verdicts = [json.loads(said) for said in published_verdicts(out / VERDICTS).values()]
    assert [verdict["mechanisms"] for verdict in verdicts] == [[]]
    assert all(int(verdict["statement"]) > 10 for verdict in verdicts)
    # the same cheater finds them as soon as they are opened: it can read
    answers = Ledger.load(out).content("opened")["answers"]
    process = BlindProcess(blind, {})
    try:
        for name, answer in answers.items():
            said = process.ask("harness", [], (out / "recordings" / f"{name}.csv").read_bytes(), 60.0)
            found = [guess["name"] for guess in json.loads(said)["mechanisms"]]
            assert {answer["value"]["mechanisms"][0], "seed"} <= set(found)
    finally:
        process.close()


@pytest.mark.parametrize(
    ("code", "why"),
    [
        ("raise SystemExit(1)", "it ends"),
        ("import sys; sys.stdin.buffer.readline(); print('no number', flush=True)", "it does not keep to the form"),
        ("import time; time.sleep(60)", "it takes too long"),
    ],
)
def test_a_process_that_does_not_answer_has_said_nothing(code: str, why: str) -> None:
    process = BlindProcess([sys.executable, "-c", code], {})
    try:
        assert process.ask("harness", [], b"t,x\n", 1.0 if "sleep" in code else 30.0) == b"", why
    finally:
        process.close()


def test_the_sealed_process_sees_an_empty_folder_and_nothing_that_tells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ANSWER", "stribeck")
    code = (
        "import json, os, sys\n"
        "while line := sys.stdin.buffer.readline():\n"
        "    sys.stdin.buffer.read(json.loads(line)['bytes'])\n"
        "    said = json.dumps([os.listdir('.'), sorted(os.environ), len(os.listdir('/proc/self/fd')), os.getpid()])\n"
        "    open('left-behind', 'w').close()\n"
        "    print(len(said), said, sep='\\n', end='', flush=True)\n"
    )
    process = BlindProcess([sys.executable, "-c", code], {"CODE": "here"})
    try:
        first_said, second_said = (json.loads(process.ask("harness", [], b"t,x\n", 30.0)) for _ in range(2))
    finally:
        process.close()
    # what the first left behind is gone, and the process is the same
    assert first_said == second_said
    folder, names, descriptors, _ = first_said
    assert folder == []
    assert "ANSWER" not in names
    assert {"CODE", "HOME", "TMPDIR", "OMP_NUM_THREADS"} <= set(names)
    # the three standard ones and the one that lists them
    assert descriptors == 4
