"""What a proof has on disk: recordings, verdicts line by line, and, while nothing is diagnosed, its secrets.

And recordings of real machines that lie in a folder, as its list and the published one name them."""

import gzip
import json
import os
import shutil
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any

from harness.app.dataset import Listed, at_hand, listed
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.prove.keeper import write_private
from harness.app.shared.deliver import to_json
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.app.shared.reading import read
from harness.core.bounded import parse_json, unpacked
from harness.core.errors import InputError
from harness.core.writing import explained, replacing
from harness.io.store import write_text
from harness.proof.drawing import AtHand
from harness.proof.plan import Sizes
from harness.proof.plant.effects import KINDS
from harness.proof.real.made import Measured, Rig
from harness.proof.seal import LEDGER, PUBLISHED, STEPS, Ledger, canonical, digest, file_of
from harness.proof.tally import OURS, tally
from harness.results.prove import ProofResult
from harness.show.report.page import write_report
from harness.show.report.proof import proof_page

RECORDINGS, VERDICTS, SECRET, WORKING = "recordings", "verdicts", "secret", "working"
ANSWERS = "answers.jsonl"


class Store:
    """The folder of a proof."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.secret = folder / SECRET / "seed.json"

    def keep_secret(self, value: Mapping[str, Any]) -> None:
        """Write the secrets down for the owner alone: only while nothing is diagnosed."""
        with explained(self.secret):
            write_private(self.secret, value)

    def take_secret(self) -> dict[str, Any] | None:
        """The secrets that an earlier call has left, or None; they stay until ``forget``."""
        try:
            return dict(json.loads(self.secret.read_text(encoding="utf-8")))
        except FileNotFoundError:
            return None
        except (OSError, ValueError):
            accepted = "the file as it was written, or a new proof"
            raise InputError(str(self.secret), "cannot be read", accepted) from None

    def forget(self) -> None:
        """Take everything secret off the disk."""
        with suppress(FileNotFoundError):
            shutil.rmtree(self.secret.parent)

    def keep_drawn(self, drawn: Mapping[str, Any]) -> None:
        with explained(self.folder):
            write_private(self.secret.parent / f"{drawn['index']:05d}.json", drawn)

    def drawn(self) -> dict[int, dict[str, Any]]:
        found = {}
        for file in sorted(self.secret.parent.glob("[0-9]*.json")):
            with suppress(OSError, ValueError):
                one = json.loads(file.read_text(encoding="utf-8"))
                found[int(one["index"])] = one
        return found

    def write_recordings(self, recordings: Mapping[str, bytes]) -> None:
        """All recordings at once, in the order of their names: neither order nor time of a file tells anything."""
        with explained(self.folder / RECORDINGS):
            (self.folder / RECORDINGS).mkdir(exist_ok=True)
            for name in sorted(recordings):
                path = self.folder / RECORDINGS / f"{name}.csv"
                path.write_bytes(recordings[name])
                os.utime(path, (0, 0))

    def names(self) -> list[str]:
        return sorted(file.stem for file in (self.folder / RECORDINGS).glob("*.csv"))

    def recording(self, name: str) -> bytes:
        return (self.folder / RECORDINGS / f"{name}.csv").read_bytes()

    def keep_answer(self, line: Mapping[str, Any]) -> None:
        with explained(self.folder):
            (self.folder / WORKING).mkdir(exist_ok=True)
            with (self.folder / WORKING / ANSWERS).open("a", encoding="utf-8") as file:
                file.write(json.dumps(line) + "\n")

    def mend(self) -> None:
        """Take off a line that was cut in two when an earlier call ended."""
        if (self.folder / WORKING / ANSWERS).exists():
            self.write(f"{WORKING}/{ANSWERS}", "".join(json.dumps(line) + "\n" for line in self.lines()))

    def answers(self) -> dict[str, dict[str, str]]:
        """Answers so far: diagnoser -> recording -> what it said."""
        found: dict[str, dict[str, str]] = {}
        for line in self.lines():
            found.setdefault(line["who"], {})[line["name"]] = line["said"]
        return found

    def lines(self) -> list[dict[str, Any]]:
        """Answers so far as they were kept; a line that was cut off is left out."""
        found = []
        with suppress(FileNotFoundError):
            for line in (self.folder / WORKING / ANSWERS).read_text(encoding="utf-8").splitlines():
                with suppress(ValueError):
                    found.append(json.loads(line))
        return found

    def pack(self, who: str, verdicts: Mapping[str, bytes]) -> None:
        """Write all verdicts of one diagnoser as they are published."""
        said = {name: json.loads(verdicts[name]) if verdicts[name] else None for name in sorted(verdicts)}
        lines = [canonical({"name": name, "said": one}) for name, one in said.items()]
        path = self.folder / VERDICTS / f"{who}.jsonl.gz"
        with explained(path):
            path.parent.mkdir(exist_ok=True)
        with replacing(path) as beside:
            beside.write_bytes(gzip.compress(b"\n".join(lines) + b"\n", mtime=0))

    def finish(self) -> None:
        """Remove what was kept for resuming."""
        self.forget()
        with suppress(FileNotFoundError):
            shutil.rmtree(self.folder / WORKING)

    def write(self, name: str, text: str) -> None:
        write_text(self.folder / name, text)


def published_verdicts(path: Path) -> dict[str, bytes]:
    """Verdicts of a packed file by recording, each as it was hashed; raises InputError when it is not one."""
    try:
        found = {}
        with path.open("rb") as file:
            text = unpacked(path, file)
        for line in text.splitlines():
            one = parse_json(line)
            found[str(one["name"])] = b"" if one["said"] is None else canonical(one["said"])
    except (InputError, OSError, ValueError, KeyError, TypeError):
        raise InputError(str(path), "no verdicts of a proof", "the file as it was published") from None
    return found


RESULT, PAGE = "result.json", "report.html"


def finish(store: Store, ledger: Ledger, command: str = "", progress: Progress = SILENT) -> ProofResult:
    """Score an opened proof and write everything that is published; raises StoreError."""
    progress("scores and page", 0, 0)
    said, lines = store.answers(), store.lines()
    for who, verdicts_of in said.items():
        store.pack(who, {name: text.encode() for name, text in verdicts_of.items()})
    # of a proof that was scored before, the time is what its result says; that of other diagnosers does not count
    seconds = sum(float(line["seconds"]) for line in lines if line["who"] == OURS)
    if not said:
        seconds = ProofResult.model_validate_json((store.folder / RESULT).read_text()).diagnosis_s
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
        absent=ledger.content(STEPS[0]).get("absent", []),
        seed=f"{seed:032x}",
        **tally(answers, verdicts, seed),
        diagnosis_s=seconds,
        machine=this_machine(),
        command=command,
        files={"transcript": LEDGER, "result": RESULT, "report": PAGE, "verdicts": VERDICTS},
    )
    store.write(RESULT, to_json(result))
    entries = [
        {"step": entry["step"], "hash": entry["hash"], "at": entry["content"].get("at", "")} for entry in ledger.entries
    ]
    page = proof_page(result, list(KINDS), entries)
    write_report(store.folder / PAGE, page)
    files = {name: digest((store.folder / name).read_bytes()) for name in (RESULT, PAGE, *packed)}
    ledger.add(PUBLISHED, {"files": files})
    ledger.save(store.folder)
    store.finish()
    return result.drawn(page)


def all_verdicts(folder: Path, ledger: Ledger) -> dict[str, dict[str, bytes]]:
    """Published verdicts by diagnoser; raises InputError for a file that is missing or none."""
    names = [OURS, *ledger.content(STEPS[2]).get("baselines", {})]
    return {who: published_verdicts(file_of(folder, f"{VERDICTS}/{who}.jsonl.gz")) for who in names}


_TOLD = ("restoring", "zero", "mass", "horizon")
"""Options that are the diagnosis's; all others are the reader's."""


@lru_cache(maxsize=1)
def measured_in(folder: Path) -> tuple[AtHand, tuple[str, ...]]:
    """What lies in a folder, and the names of listed files that do not. Raises InputError."""
    # the last to list a file has its word
    every = {one.file: (one, options) for one, options in listed(folder)}
    there = at_hand(folder, list(every.values()))
    measured = {file: _read(there[file], *every[file]) for file in there}
    rigs = {
        file: one.rig(
            file, every[file][0].machine or every[file][0].name, every[file][0].condition, every[file][0].moves
        )
        for file, one in measured.items()
    }
    return AtHand(rigs, measured), tuple(file for file in every if file not in there)


def check_sealed(folder: Path, rigs: Sequence[Rig]) -> None:
    """Raises InputError for a recording that is not there as a transcript has it."""
    found = measured_in(folder)[0].rigs
    for rig in rigs:
        if rig.file not in found or found[rig.file].sha256 != rig.sha256:
            accepted = "the folder that the proof was begun with"
            raise InputError(f"--from {folder}", f"{rig.file} is not there, or not as it was sealed", accepted)


def _read(path: Path, one: Listed, options: DiagnoseOptions) -> Measured:
    found = read(path, options.reading)
    chosen = {name: str(one.options[name]) for name in _TOLD if name in one.options}
    if one.options.get("covariate"):
        chosen["covariate"] = ",".join(one.options["covariate"])
    return Measured(found.t, dict(found.channels), dict(found.covariates), found.angular, chosen)
