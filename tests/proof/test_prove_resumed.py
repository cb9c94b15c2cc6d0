"""A proof that was stopped or interrupted goes on to what it would have been, or says why it cannot."""

import json
import os
from pathlib import Path
from typing import Any

import pytest
from small_proof import SIZES, STUB

from harness.app.prove.prove import ProveOptions, prove
from harness.app.prove.store import RESULT, Store
from harness.app.prove.verify import verify_proof
from harness.core.errors import InputError, StoreError
from harness.io.store import held
from harness.proof.plan import Sizes
from harness.proof.seal import LEDGER, STEPS, Ledger

pytestmark = pytest.mark.usefixtures("one_version")


def test_a_finished_proof_resumed_is_scored_again_and_stays_what_it_was(proof: Path) -> None:
    before = json.loads((proof / RESULT).read_text())
    prove(ProveOptions(Sizes(1, 0, 0, 0), resume=True, blind=STUB), proof)
    after = json.loads((proof / RESULT).read_text())
    assert after == {**before, "command": after["command"]}
    assert verify_proof(proof, jobs=1).accepted


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


SMALL = Sizes(1, 1, 0, 0)
VERDICTS_SEALED = 6
"""Which of the files it is: seed, transcript, two recordings, seed and answers, transcript, and this one after them."""
FILES = 12


class StoppedError(BaseException):
    """What nobody catches."""


def options(resume: bool = False) -> ProveOptions:
    return ProveOptions(SMALL, 1, None, resume, ("r2",), STUB)


def stopped_after(count: int, out: Path) -> list[str]:
    """Stop a proof when it has written so many files; the steps that its transcript then has."""
    written = 0
    replace = os.replace

    def counting(source: Any, target: Any) -> None:
        nonlocal written
        replace(source, target)
        written += 1
        if written > count:
            raise StoppedError

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "replace", counting)
        with pytest.raises(StoppedError):
            prove(options(), out)
    return [entry["step"] for entry in Ledger.load(out).entries] if (out / LEDGER).exists() else []


def goes_on(out: Path) -> None:
    prove(options(resume=True), out)
    assert verify_proof(out, jobs=1).accepted
    steps = [entry["step"] for entry in Ledger.load(out).entries if entry["step"] != "resumed"]
    assert steps == [*STEPS, "published"]
    assert not (out / "secret").exists()
    assert not (out / "working").exists()


def test_verdicts_that_are_sealed_are_opened_and_not_sealed_again(tmp_path: Path) -> None:
    assert stopped_after(VERDICTS_SEALED, tmp_path / "out") == list(STEPS[:3])
    goes_on(tmp_path / "out")


@pytest.mark.full
@pytest.mark.parametrize("count", range(1, FILES))
def test_it_goes_on_from_every_file(count: int, tmp_path: Path) -> None:
    assert stopped_after(count, tmp_path / "out")
    goes_on(tmp_path / "out")


def test_a_first_answer_that_was_cut_in_two_does_no_harm(tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.keep_answer({"name": "a", "who": "harness", "said": "{}", "seconds": 0.1})
    answers = tmp_path / "working" / "answers.jsonl"
    answers.write_text(answers.read_text()[:20])
    store.mend()
    store.keep_answer({"name": "b", "who": "harness", "said": "{}", "seconds": 0.1})
    assert store.answers() == {"harness": {"b": "{}"}}


def test_two_calls_do_not_share_a_proof(proof: Path) -> None:
    with held(proof), pytest.raises(StoreError, match="another process works in it"), held(proof, 0.1):
        pass


def test_a_proof_in_which_nothing_was_begun_is_begun_and_not_resumed(tmp_path: Path) -> None:
    (tmp_path / "log.txt").write_text("what the killed one had said\n")
    with pytest.raises(InputError, match="holds no proof to resume"):
        prove(options(resume=True), tmp_path)
    prove(options(), tmp_path)
    assert (tmp_path / "log.txt").read_text().startswith("what the killed one had said\n")
    assert verify_proof(tmp_path, jobs=1).accepted


@pytest.mark.parametrize("count", range(5))
def test_a_proof_that_was_stopped_is_not_called_changed(count: int, proof: Path) -> None:
    Ledger(Ledger.load(proof).entries[:count]).save(proof)
    with pytest.raises(InputError, match="a proof that was not finished"):
        verify_proof(proof, jobs=1)
