"""A published proof recomputed: whatever was changed is named."""

import random
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from harness.app.prove.store import PAGE, RESULT, all_verdicts, check_sealed
from harness.app.prove.worker import DrawTask, draw_failed, draw_one
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.app.shared.rows import worked
from harness.core.bounded import MOST_DOCUMENT_BYTES, read_bytes
from harness.core.errors import InputError, visible
from harness.io.recording import sha256
from harness.proof.drawing import Drawn
from harness.proof.plan import REAL, SHORT, Job, Sizes
from harness.proof.seal import PUBLISHED, STEPS, Ledger, digest, file_of
from harness.proof.tally import OURS, tally
from harness.proof.verify import (
    Redrawn,
    agrees,
    check_plan,
    check_recording,
    check_transcript,
    check_verdicts,
    is_unfinished,
    planned_jobs,
    sealed_rigs,
    too_many_elsewhere,
)
from harness.results.prove import ProofCheck, ProofResult
from harness.show.report.page import whole

SAMPLE = SHORT.total
"""Recordings that are drawn again by a short verification."""


def verify_proof(
    folder: Path,
    short: bool = False,
    jobs: int | None = None,
    progress: Progress = SILENT,
    source: Path | None = None,
) -> ProofCheck:
    """Recompute a proof from its folder: chain, commitments, verdicts, scores, files, recordings.

    short : draw a random sample of the recordings again and not all of them. source : folder of recordings of real
    machines, without which what was made from them is not drawn again. Raises InputError when there is no transcript or
    the proof was not finished.
    """
    ledger = Ledger.load(folder)
    if is_unfinished(ledger):
        raise InputError(str(folder), "a proof that was not finished", "a finished one")
    wrong = check_transcript(ledger)
    if wrong:
        return _said(folder, ledger, wrong)
    wrong = check_plan(ledger) + _files(folder, ledger) + _verdicts(folder, ledger)
    if wrong:
        return _said(folder, ledger, wrong)
    wrong = _scores(folder, ledger)
    chosen = [job for job in planned_jobs(ledger) if source is not None or job.source != REAL]
    if short:
        chosen = random.SystemRandom().sample(chosen, min(SAMPLE, len(chosen)))
    if source is not None:
        check_sealed(source, sealed_rigs(ledger))
    left = sum(job.source == REAL for job in planned_jobs(ledger)) if source is None else 0
    found = [check_recording(ledger, *one) for one in _drawn(ledger, chosen, jobs, progress, source)]
    wrong += [one.wrong for one in found if one.wrong] + too_many_elsewhere(found)
    return _said(folder, ledger, sorted(wrong), found, left)


def _said(folder: Path, ledger: Ledger, wrong: list[str], found: Sequence[Redrawn] = (), left: int = 0) -> ProofCheck:
    notes = []
    if left:
        line = f"try: harness prove --verify {folder} --from DIR"
        notes.append(f"{left} recordings of real machines were not made again; {line}")
    again, identical = len(found), sum(one.identical for one in found)
    if identical < again:
        made: dict[str, str] = dict(ledger.content(STEPS[0])["versions"])
        here = {"python": this_machine().python, **this_machine().packages}
        other = ", ".join(f"{name} {made[name]}" for name in made if made[name] != here.get(name))
        why = f"made with other versions ({other})" if other else "another processor rounds otherwise"
        notes.append(f"{again - identical} recordings are not the same to the last bit: {why}")
    elsewhere = sum(one.elsewhere for one in found)
    if elsewhere:
        notes.append(f"{elsewhere} of these but for what fits decide (how strong, how noisy), which end elsewhere here")
    cases: dict[str, Any] = next((e["content"].get("cases", {}) for e in ledger.entries if e["step"] == STEPS[1]), {})
    return ProofCheck(
        folder=str(folder.absolute()),
        accepted=not wrong,
        wrong=wrong,
        recordings=len(cases),
        drawn_again=again,
        identical=identical,
        notes=notes,
    )


def _files(folder: Path, ledger: Ledger) -> list[str]:
    """Published files that are missing or changed."""
    wrong = []
    for name, known in sorted(ledger.content(PUBLISHED)["files"].items()):
        try:
            file = file_of(folder, name)
            if not file.is_file():
                wrong.append(f"{name} is missing")
            elif (digest(whole(file)) if name == PAGE else sha256(file)) != known:
                wrong.append(f"{name} was changed")
        except InputError as error:
            wrong.append(str(error))
    for file in sorted((folder / "recordings").glob("*.csv")):
        case = ledger.content(STEPS[1])["cases"].get(file.stem)
        if case is None or file.is_symlink() or sha256(file) != case["recording"]:
            wrong.append(visible(f"recordings/{file.name} was changed"))
    return wrong


def _verdicts(folder: Path, ledger: Ledger) -> list[str]:
    try:
        verdicts = all_verdicts(folder, ledger)
    except InputError as error:
        return [str(error)]
    return [
        line for who, said in verdicts.items() for line in check_verdicts(ledger, None if who == OURS else who, said)
    ]


def _scores(folder: Path, ledger: Ledger) -> list[str]:
    """Whether the result says what follows from answers and verdicts."""
    opened = ledger.content(STEPS[3])
    answers = {name: one["value"] for name, one in opened["answers"].items()}
    seed = int(opened["seed"]["value"])
    try:
        said = ProofResult.model_validate_json(read_bytes(file_of(folder, RESULT), MOST_DOCUMENT_BYTES))
    except (InputError, ValueError):
        return [f"{RESULT} is not a result of a proof"]
    known = said.model_dump(mode="json", by_alias=True)
    try:
        counted = tally(answers, all_verdicts(folder, ledger), seed)
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        return [f"answers and verdicts are not those of a proof ({type(error).__name__}: {error})"]
    again = ProofResult.model_validate({**known, **counted, "seed": f"{seed:032x}"})
    new = again.model_dump(mode="json", by_alias=True)
    wrong = [
        f"{RESULT}: {name} does not follow from answers and verdicts"
        for name in known
        if not agrees(known[name], new[name], 1e-9)
    ]
    sizes = Sizes.of(ledger.content(STEPS[0])["sizes"])
    if Sizes.of(known["sizes"]) != sizes or known["evidence"] != sizes.is_evidence:
        wrong.append(f"{RESULT}: sizes are not those of the transcript")
    return wrong


def _drawn(
    ledger: Ledger, chosen: list[Job], jobs: int | None, progress: Progress, source: Path | None
) -> list[tuple[Drawn, Job]]:
    """Recordings drawn again from the revealed seed, with their jobs; those that were given up are left out."""
    seed = int(ledger.content(STEPS[3])["seed"]["value"])
    of = {job.index: job for job in chosen}
    tasks = [DrawTask(seed, job, source) for job in chosen]
    count = 0, len(tasks)
    with worked("recordings drawn again", tasks, draw_one, draw_failed, progress, count, jobs=jobs) as rows:
        drawn = [one for one in rows if one["error"] is None]
    return [(Drawn(one["name"], one["recording"].encode(), one["answer"]), of[one["index"]]) for one in drawn]
