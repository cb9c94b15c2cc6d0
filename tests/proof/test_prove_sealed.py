"""A proof from end to end: published, verified, refused where it cannot be."""

import json
import shutil
from pathlib import Path

import jsonschema
import pytest
from small_proof import SIZES, STUB, VERDICTS

from harness.app.prove.prove import ProveOptions, prove
from harness.app.prove.store import PAGE, RESULT
from harness.app.prove.verify import verify_proof
from harness.core.errors import InputError, StoreError
from harness.proof.seal import LEDGER
from harness.results.generate import FOLDER

pytestmark = pytest.mark.usefixtures("one_version")


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
