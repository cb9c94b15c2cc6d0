"""Sealing: nobody, we included, can change seed, recordings, answers or verdicts afterwards without it being seen.

Every step is an entry of a ledger, each with the hash of the one before. What must stay secret until the verdicts are
in (seed, answers) goes in as a salted hash first and is opened at the end. Secrets live in memory alone until then.
"""

import hashlib
import json
import re
import secrets
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from harness.core.bounded import MOST_DOCUMENT_BYTES, parse_json, read_bytes
from harness.core.errors import InputError
from harness.core.writing import replacing

LEDGER = "transcript.json"
SCHEMA = "harness.proof-transcript/1"


def digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def canonical(value: Any) -> bytes:
    """The one way in which a value is written down to be hashed."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


@dataclass(frozen=True, slots=True)
class Sealed:
    """A secret and the salt it was sealed with."""

    value: Any
    salt: str = field(default_factory=lambda: secrets.token_hex(16))

    @property
    def commitment(self) -> str:
        """What is published before the secret is."""
        return digest(self.salt.encode() + canonical(self.value))

    def opened(self) -> dict[str, Any]:
        """What is published after."""
        return {"value": self.value, "salt": self.salt}


class Ledger:
    """Entries in order, each chained to the one before by its hash."""

    def __init__(self, entries: Sequence[Mapping[str, Any]] = ()) -> None:
        self.entries: list[dict[str, Any]] = [dict(entry) for entry in entries]

    def add(self, step: str, content: Mapping[str, Any]) -> str:
        """Append an entry; its hash."""
        before = self.entries[-1]["hash"] if self.entries else ""
        entry = {"step": step, "content": dict(content), "before": before}
        self.entries.append({**entry, "hash": digest(canonical(entry))})
        return str(self.entries[-1]["hash"])

    def save(self, folder: Path) -> None:
        """Write the ledger; beside first, then renamed."""
        with replacing(folder / LEDGER) as part:
            part.write_text(json.dumps({"schema": SCHEMA, "entries": self.entries}, indent=1))

    @classmethod
    def load(cls, folder: Path) -> "Ledger":
        """Read a ledger; InputError when there is none or it is not one."""
        path = folder / LEDGER
        try:
            said = parse_json(read_bytes(path, MOST_DOCUMENT_BYTES))
            if said["schema"] != SCHEMA:
                raise KeyError("schema")
            return cls(said["entries"])
        except (InputError, ValueError, KeyError, TypeError):
            raise InputError(str(path), "no transcript of a proof", f"a file of schema {SCHEMA}") from None

    def broken_at(self) -> int | None:
        """Index of the first entry whose hash or chain does not hold, or None."""
        before = ""
        for i, entry in enumerate(self.entries):
            body = {key: entry.get(key) for key in ("step", "content", "before")}
            if entry.get("before") != before or entry.get("hash") != digest(canonical(body)) or len(entry) != 4:
                return i
            before = entry["hash"]
        return None

    def content(self, step: str) -> dict[str, Any]:
        """The content of the one entry of this step; InputError when there is not exactly one."""
        found = [entry["content"] for entry in self.entries if entry.get("step") == step]
        if len(found) != 1 or not isinstance(found[0], dict):
            raise InputError(LEDGER, f"{len(found)} entries of step {step}", "exactly one")
        return dict(found[0])


_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9 ._-]{0,99}")


def file_of(folder: Path, name: str) -> Path:
    """A file of a proof by the name that its transcript has for it.

    Raises InputError for a name that leads out of the folder, by its parts or by a link: a transcript may come from
    anybody, and says nothing about other files of this machine.
    """
    path = folder / name
    parts_hold = all(_NAME.fullmatch(part) for part in name.split("/"))
    if not parts_hold or not path.resolve().is_relative_to(folder.resolve()):
        raise InputError(LEDGER, f"the file name '{name}'", "a name inside the folder of the proof")
    return path


STEPS = ("seed committed", "recordings sealed", "verdicts sealed", "opened")


RESUMED, PUBLISHED = "resumed", "published"
"""Steps that may stand between the others, and the last one."""


def seal_seed(ledger: Ledger, about: Mapping[str, Any]) -> Sealed:
    """Take a seed from the operating system and commit to it before anything else happens.

    about : what the proof is made with, versions among it.
    """
    seed = Sealed(int.from_bytes(secrets.token_bytes(16), "big"))
    ledger.add(STEPS[0], {"commitment": seed.commitment, **about})
    return seed


def seal_recordings(
    ledger: Ledger,
    recordings: Mapping[str, bytes],
    answers: Mapping[str, Sealed],
    probes: Mapping[str, Sequence[str]] | None = None,
) -> None:
    """Commit to every recording, and to its answer without telling it; probes : lines of each, to be published."""
    cases = {
        name: {
            "recording": digest(data),
            "answer": answers[name].commitment,
            **({} if probes is None else {"lines": list(probes[name])}),
        }
        for name, data in sorted(recordings.items())
    }
    ledger.add(STEPS[1], {"cases": cases})


def seal_verdicts(
    ledger: Ledger, verdicts: Mapping[str, bytes], others: Mapping[str, Mapping[str, bytes]] | None = None
) -> None:
    """Commit to every verdict before any answer is opened; others : those of other diagnosers, by their name."""
    baselines = {who: _digests(said) for who, said in sorted((others or {}).items())}
    ledger.add(STEPS[2], {"cases": _digests(verdicts), **({"baselines": baselines} if baselines else {})})


def _digests(verdicts: Mapping[str, bytes]) -> dict[str, str]:
    return {name: digest(data) for name, data in sorted(verdicts.items())}


def open_all(ledger: Ledger, seed: Sealed, answers: Mapping[str, Sealed], given_up: Sequence[str] = ()) -> None:
    """Reveal seed and answers; given_up : recordings that were planned and could not be made."""
    opened = {name: answer.opened() for name, answer in sorted(answers.items())}
    ledger.add(
        STEPS[3], {"seed": seed.opened(), "answers": opened, **({"given_up": list(given_up)} if given_up else {})}
    )
