"""Sealing: any change is seen."""

import json
import secrets
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from harness.core.errors import InputError
from harness.proof.seal import (
    Ledger,
    Sealed,
    open_all,
    seal_recordings,
    seal_seed,
    seal_verdicts,
)
from harness.proof.verify import check_transcript, check_verdicts

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


def change_answer(said: Any) -> None:
    answers = said["entries"][3]["content"]["answers"]
    next(iter(answers.values()))["value"] = {"mechanisms": ["impulse"]}


def change_answer_and_rehash(said: Any) -> None:
    change_answer(said)
    ledger = Ledger(said["entries"][:3])
    ledger.add("opened", said["entries"][3]["content"])
    said["entries"] = ledger.entries


def change_seed_and_rehash(said: Any) -> None:
    said["entries"][3]["content"]["seed"]["value"] += 1
    ledger = Ledger(said["entries"][:3])
    ledger.add("opened", said["entries"][3]["content"])
    said["entries"] = ledger.entries


def drop_a_case_and_rehash(said: Any) -> None:
    answers = said["entries"][3]["content"]["answers"]
    del answers[next(iter(answers))]
    ledger = Ledger(said["entries"][:3])
    ledger.add("opened", said["entries"][3]["content"])
    said["entries"] = ledger.entries


def open_before_the_verdicts(said: Any) -> None:
    ledger = Ledger(said["entries"][:2])
    ledger.add("opened", said["entries"][3]["content"])
    ledger.add("verdicts sealed", said["entries"][2]["content"])
    said["entries"] = ledger.entries


def test_an_honest_proof_is_accepted(tmp_path: Path) -> None:
    assert check_transcript(Ledger.load(published(tmp_path))) == []


@pytest.mark.parametrize(
    ("tamper", "found"),
    [
        (change_answer, "entry 4 of the transcript was changed"),
        (change_answer_and_rehash, "the answer is not the one that was sealed"),
        (change_seed_and_rehash, "the seed is not the one that was committed to"),
        (drop_a_case_and_rehash, "recordings, verdicts and answers are not of the same cases"),
        (open_before_the_verdicts, "the steps of the transcript are not in their order"),
    ],
)
def test_a_changed_transcript_is_rejected(tmp_path: Path, tamper: Callable[[Any], None], found: str) -> None:
    path = published(tmp_path) / "transcript.json"
    said = json.loads(path.read_text())
    tamper(said)
    path.write_text(json.dumps(said))
    assert any(found in line for line in check_transcript(Ledger.load(tmp_path)))


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


def test_no_transcript_is_an_input_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no transcript of a proof"):
        Ledger.load(tmp_path)


def test_a_commitment_tells_nothing_without_its_salt() -> None:
    # the same answer is sealed differently every time, so a list of all answers does not open it
    assert Sealed({"mechanisms": []}).commitment != Sealed({"mechanisms": []}).commitment
