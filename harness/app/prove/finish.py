"""What is made of an opened proof: packed verdicts, result.json, the page, and their hashes in the transcript."""

from pathlib import Path
from typing import Any

from harness.app.prove.store import VERDICTS, Store, published_verdicts
from harness.app.shared.deliver import to_json
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.proof.plan import Sizes
from harness.proof.plant.effects import KINDS
from harness.proof.seal import LEDGER, PUBLISHED, STEPS, Ledger, digest, file_of
from harness.proof.tally import OURS, tally
from harness.results.prove import ProofResult
from harness.show.report.proof import write_proof_page

RESULT, PAGE = "result.json", "report.html"


def finish(store: Store, ledger: Ledger, command: str = "", progress: Progress = SILENT) -> ProofResult:
    """Score an opened proof and write everything that is published; raises StoreError."""
    progress("scores and page", 0, 0)
    seconds = _pack(store, ledger)
    opened = ledger.content(STEPS[3])
    answers = {name: one["value"] for name, one in opened["answers"].items()}
    verdicts = all_verdicts(store.folder, ledger)
    sizes = Sizes.of(ledger.content(STEPS[0])["sizes"])
    seed = int(opened["seed"]["value"])
    packed = [f"{VERDICTS}/{who}.jsonl.gz" for who in verdicts]
    result = ProofResult(
        evidence=sizes.is_evidence,
        sizes=ledger.content(STEPS[0])["sizes"],
        given_up=opened.get("given_up", []),
        seed=f"{seed:032x}",
        **tally(answers, verdicts, seed),
        diagnosis_s=seconds,
        machine=this_machine(),
        command=command,
        files={"transcript": LEDGER, "result": RESULT, "report": PAGE, "verdicts": VERDICTS},
    )
    store.write(RESULT, to_json(result))
    write_proof_page(store.folder / PAGE, page_data(result, ledger))
    files = {name: digest((store.folder / name).read_bytes()) for name in (RESULT, PAGE, *packed)}
    ledger.add(PUBLISHED, {"files": files})
    ledger.save(store.folder)
    store.finish()
    return result


def page_data(result: ProofResult, ledger: Ledger) -> dict[str, Any]:
    """What the page shows: the result, the transcript entry by entry, and the names in the catalogue's order."""
    entries = [
        {"step": entry["step"], "hash": entry["hash"], "at": entry["content"].get("at", "")} for entry in ledger.entries
    ]
    return {**result.model_dump(mode="json", by_alias=True), "transcript": entries, "order": list(KINDS)}


def all_verdicts(folder: Path, ledger: Ledger) -> dict[str, dict[str, bytes]]:
    """Published verdicts by diagnoser; raises InputError for a file that is missing or none."""
    names = [OURS, *ledger.content(STEPS[2]).get("baselines", {})]
    return {who: published_verdicts(file_of(folder, f"{VERDICTS}/{who}.jsonl.gz")) for who in names}


def _pack(store: Store, ledger: Ledger) -> float:
    """Write the verdicts as they are published, if that was not done; the time they took, s."""
    said = store.answers()
    if not said:
        return float(ProofResult.model_validate_json((store.folder / RESULT).read_text()).diagnosis_s)
    for who, verdicts in said.items():
        store.pack(who, {name: text.encode() for name, text in verdicts.items()})
    return store.seconds()
