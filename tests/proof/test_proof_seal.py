"""Sealing: any change is seen."""

import secrets
from pathlib import Path

from harness.proof.seal import Ledger, Sealed, open_all, seal_recordings, seal_seed, seal_verdicts
from harness.proof.verify import check_verdicts

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
