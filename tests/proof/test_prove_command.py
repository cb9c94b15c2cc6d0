"""harness prove: what it refuses, what it prints and hands back; the short form through the real diagnosis."""

import json
import re
import sys
from pathlib import Path

import pytest
from prove_stub import __file__ as stub

import harness
from benchmarks.controls import controls
from benchmarks.publish.proof import place_of, publish
from harness.app.prove import verify
from harness.app.prove.prove import ProveOptions, prove
from harness.core.errors import HarnessError
from harness.proof.plan import FULL, SHORT, Sizes
from harness.results.prove import ProofResult
from harness.show.report.page import render
from harness.show.report.proof import proof_page


def test_sizes_are_chosen_by_name() -> None:
    assert ProveOptions.chosen({}).sizes == FULL
    assert ProveOptions.chosen({}, short=True).sizes == SHORT
    assert ProveOptions.chosen({"pairs": 7}).sizes == Sizes(300, 300, 7, 60)


@pytest.fixture
def small(tmp_path: Path, one_version: None) -> Path:
    prove(ProveOptions(Sizes(1, 1, 0, 0), jobs=1, baselines=(), blind=(sys.executable, str(stub))), tmp_path / "small")
    return tmp_path / "small"


def test_only_evidence_is_published(small: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert place_of(small) == Path("reports/proof")
    with pytest.raises(HarnessError, match="holds no finished proof; expected the folder of one"):
        place_of(tmp_path)
    with pytest.raises(HarnessError, match="has too few recordings to be evidence; nothing was published"):
        publish(small, tmp_path / "into")
    assert not (tmp_path / "into").exists()
    (small / "report.html").unlink()
    with pytest.raises(HarnessError, match=r"is rejected: report\.html is missing; nothing was published"):
        publish(small, tmp_path / "into")


@pytest.fixture
def published_here() -> Path:
    proof = Path(__file__).resolve().parents[2] / "reports" / "proof"
    if not proof.is_dir():
        pytest.skip("no proof is published here")
    return proof


def test_controls_of_the_published_proof_are_counted_as_it_counts_them(published_here: Path) -> None:
    rates = controls(published_here)
    figures = {f["key"]: f for f in json.loads((published_here / "result.json").read_text())["figures"]}
    alarms = rates["false alarms"]
    assert (alarms.hits, alarms.cases) == (figures["false_alarms"]["hits"], figures["false_alarms"]["cases"])
    left = rates["mean square of what is left within 99 % of its scatter about the true noise's"]
    assert left.high is not None
    assert left.high > 0.99
    slider = rates["all three within two standard errors"]
    assert slider.value is not None
    assert 0.925 < slider.value < 0.98


@pytest.mark.parametrize("name", ["proof", "proof-machines", "proof-paths"])
def test_the_published_proof_is_accepted(name: str, published_here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(verify, "SAMPLE", 2)
    proof = published_here.with_name(name)
    check = harness.verify_proof(proof, short=True)
    assert (check.accepted, check.wrong) == (True, [])
    assert (proof / "report.html").stat().st_size < 5_000_000


def test_a_page_counts_what_was_drawn_and_its_last_level_has_no_end(published_here: Path) -> None:
    stored = ProofResult.model_validate_json((published_here.with_name("proof-paths") / "result.json").read_bytes())
    page = render(proof_page(stored, [], []))
    # of those that the published proof of ways asked for some could not be drawn
    assert stored.given_up
    assert f"The {len(stored.cases)} recordings are of 13 ways" in page
    assert re.findall(r">\s*(above \d+|\d+ to 30000)\s*<", page) == ["10000 to 30000", "above 31600"]
