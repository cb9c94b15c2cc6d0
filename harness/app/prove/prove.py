"""The sealed blind proof: draw, seal, diagnose blind, seal the verdicts, open, score.

What must stay secret (seed and answers) is in no file while anything is diagnosed: see harness.app.prove.keeper.
"""

import hashlib
import json
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from harness.app.prove.keeper import keeping
from harness.app.prove.store import Store, check_sealed, finish, measured_in
from harness.app.prove.worker import COMMAND, BlindTask, DrawTask, answer_failed, answer_one, draw_failed, draw_one
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import NAME as LOG
from harness.app.shared.progress import SILENT, Progress, journal
from harness.app.shared.rows import folder_of, resumable, worked
from harness.core.errors import HarnessError, InputError
from harness.io.store import held
from harness.proof.beside import BASELINES
from harness.proof.drawing import probes_of, sealed_answers
from harness.proof.plan import (
    FULL,
    MACHINES,
    REAL,
    SHORT,
    SHORT_MACHINES,
    SHORT_PATHS,
    SHORT_REAL,
    Sizes,
    on_ways,
    plan,
)
from harness.proof.seal import (
    LEDGER,
    PUBLISHED,
    RESUMED,
    STEPS,
    Ledger,
    Sealed,
    open_all,
    seal_recordings,
    seal_seed,
    seal_verdicts,
)
from harness.proof.tally import OURS
from harness.proof.verify import sealed_rigs
from harness.results.prove import ProofResult

CODE = Path(__file__).resolve().parents[2]


@dataclass(frozen=True, slots=True)
class ProveOptions:
    """How to prove.

    sizes : how many recordings. jobs : local processes, None for one a core. cluster : address of a dask scheduler,
    None for the local pool. resume : go on with what the folder holds. baselines : who answers besides us.
    blind : what runs in the sealed processes. folder : of recordings of real machines.
    """

    sizes: Sizes = field(default_factory=Sizes)
    jobs: int | None = None
    cluster: str | None = None
    resume: bool = False
    baselines: tuple[str, ...] = BASELINES
    blind: tuple[str, ...] = COMMAND
    folder: Path | None = None

    @classmethod
    def chosen(
        cls,
        given: Mapping[str, int],
        short: bool = False,
        machines: bool = False,
        paths: int = 0,
        real: int = 0,
        **rest: Any,
    ) -> "ProveOptions":
        """As somebody chose: sizes by name, else the full ones, or the short ones; of machines, or of ``paths``
        recordings on all ways, or ``real`` effects on the recordings of a folder, without baselines."""
        if real:
            return cls(Sizes(0, 0, 0, 0, real=SHORT_REAL if short else real), baselines=(), **rest)
        if paths:
            return cls(SHORT_PATHS if short else on_ways(paths), baselines=(), **rest)
        if machines:
            return cls(SHORT_MACHINES if short else MACHINES, baselines=(), **rest)
        return cls(SHORT if short else replace(FULL, **given), **rest)


def prove(
    options: ProveOptions, out: Path | None = None, progress: Progress = SILENT, command: str = ""
) -> ProofResult:
    """Run a proof, or go on with one, into a folder.

    out : folder, None for reports/proof-TIME here. Raises InputError for what cannot be resumed, StoreError for a
    folder that cannot be written, is taken or in use, InterruptionError after an interruption; what was done is kept.
    """
    if options.folder is not None:
        # before a folder is made for nothing
        measured_in(options.folder)
    folder = folder_of("proof", out, options.resume, "proof", LEDGER)
    with held(folder) as mark, journal(folder / LOG):
        return _Proof(options, folder, progress, command, mark).run()


class _Proof:
    """One call: each phase is left out when the transcript says that it is done."""

    def __init__(self, options: ProveOptions, folder: Path, progress: Progress, command: str, mark: int) -> None:
        self._options, self._folder, self._progress, self._command = options, folder, progress, command
        self._mark = mark
        self._store = Store(folder)
        self._ledger = Ledger.load(folder) if options.resume else Ledger()
        self._sizes = options.sizes
        self._beside = options.baselines
        self._worked = partial(worked, progress=progress, jobs=options.jobs, cluster=options.cluster)

    def run(self) -> ProofResult:
        with resumable(self._folder, lambda: "what is done is kept"):
            if self._options.resume:
                self._check()
            if not self._done(STEPS[0]):
                self._begin()
            if not self._done(STEPS[1]):
                self._draw()
            if not self._done(STEPS[3]):
                self._diagnose()
        if self._done(PUBLISHED):
            self._ledger.entries = [entry for entry in self._ledger.entries if entry["step"] != PUBLISHED]
        return finish(self._store, self._ledger, self._command, self._progress)

    def _done(self, step: str) -> bool:
        return any(entry["step"] == step for entry in self._ledger.entries)

    def _check(self) -> None:
        """Whether what the folder holds can be gone on with by this program."""
        if self._ledger.broken_at() is not None:
            raise InputError(str(self._folder / LEDGER), "was changed", "the transcript as it was written")
        about = self._ledger.content(STEPS[0])
        self._sizes = Sizes.of(about["sizes"])
        self._beside = tuple(about.get("beside", self._beside))
        if not self._done(STEPS[3]) and about["code"] != code_digest():
            accepted = "the same version, or a new proof"
            raise InputError("--resume", f"{self._folder.name} was begun by another version of the program", accepted)

    def _begin(self) -> None:
        folder, real = self._options.folder, {}
        if folder is not None:
            at_hand, absent = measured_in(folder)
            real = {"rigs": [asdict(rig) for rig in at_hand.rigs.values()], "absent": list(absent)}
        about = {
            "at": now(),
            **real,
            "sizes": asdict(self._sizes),
            "beside": list(self._beside),
            "code": code_digest(),
            "versions": {"python": this_machine().python, **this_machine().packages},
        }
        seed = seal_seed(self._ledger, about)
        self._store.keep_secret({"seed": asdict(seed)})
        self._ledger.save(self._folder)

    def _draw(self) -> None:
        """Draw what is not drawn yet, then seal it; secrets are on disk, since nothing is diagnosed meanwhile."""
        secret = self._secret()
        seed = int(secret["seed"]["value"])
        have = self._store.drawn()
        jobs = plan(self._sizes, seed, sealed_rigs(self._ledger))
        tasks = [DrawTask(seed, job, self._options.folder) for job in jobs if job.index not in have]
        if any(task.job.source == REAL for task in tasks):
            if self._options.folder is None:
                raise InputError("--resume", "given without --from", "--from DIR, the folder of the recordings")
            check_sealed(self._options.folder, sealed_rigs(self._ledger))
        with self._worked("recordings drawn", tasks, draw_one, draw_failed, count=(len(have), len(jobs))) as rows:
            for one in rows:
                self._store.keep_drawn(one)
        found = self._store.drawn().values()
        drawn = [one for one in found if one["error"] is None]
        if not drawn:
            raise HarnessError("no recording could be drawn")
        given_up = [one["error"] for one in found if one["error"] is not None]
        recordings = {one["name"]: one["recording"].encode() for one in drawn}
        answers = {one["name"]: one["answer"] for one in drawn}
        salts = sealed_answers(seed, answers)
        self._store.write_recordings(recordings)
        seal_recordings(self._ledger, recordings, salts, {name: probes_of(data) for name, data in recordings.items()})
        self._store.keep_secret({"seed": secret["seed"], "answers": answers, "given_up": given_up})
        self._ledger.save(self._folder)

    def _diagnose(self) -> None:
        """Every diagnoser on every recording, blind; then the verdicts are sealed and the answers opened."""
        secret = self._secret()
        with keeping(self._store.secret, secret, self._mark) as release:
            if self._options.resume:
                self._store.mend()
                about = {"at": now(), "kept": len(self._store.lines()), "secrets": SECRETS}
                self._ledger.add(RESUMED, about)
                self._ledger.save(self._folder)
            self._store.forget()
            if not self._done(STEPS[2]):
                said = self._answers(secret["answers"])
                seal_verdicts(self._ledger, said[OURS], {who: one for who, one in said.items() if who != OURS})
                self._ledger.save(self._folder)
            seed = Sealed(**secret["seed"])
            open_all(self._ledger, seed, sealed_answers(int(seed.value), secret["answers"]), secret["given_up"])
            self._ledger.save(self._folder)
            release()

    def _answers(self, answers: Mapping[str, Any]) -> dict[str, dict[str, bytes]]:
        """What every diagnoser says, ours first; what has been said before is kept."""
        names = self._store.names()
        with tempfile.TemporaryDirectory(prefix="blind-") as place:

            def ask(diagnosers: Sequence[str], arguments: Callable[[str], tuple[str, ...]]) -> None:
                said = self._store.answers()
                tasks = [
                    BlindTask(name, who, arguments(name), self._store.recording(name), place, self._options.blind)
                    for who in diagnosers
                    for name in names
                    if name not in said.get(who, {})
                ]
                count = sum(map(len, said.values())), len(names) * (1 + len(self._beside))
                with self._worked("answers", tasks, answer_one, answer_failed, count=count) as lines:
                    for line in lines:
                        self._store.keep_answer(line)

            ask([OURS], lambda name: tuple(answers[name]["arguments"]))
            ours = self._store.answers()[OURS]
            # baselines predict the spans that our verdict was not fitted to
            ask(self._beside, lambda name: (spans_left_out(ours[name]),))
        said = self._store.answers()
        return {who: {name: said[who][name].encode() for name in names} for who in (OURS, *self._beside)}

    def _secret(self) -> dict[str, Any]:
        found = self._store.take_secret()
        if found is None:
            accepted = "a new proof"
            raise InputError("--resume", f"the seed of {self._folder.name} is lost, it was stopped too hard", accepted)
        return found


SECRETS = (
    "seed and answers lay on disk, readable by the owner alone, from the interruption until now; "
    "no diagnosing process ran meanwhile"
)


def spans_left_out(verdict: str) -> str:
    """The spans that our verdict was not fitted to, as JSON: others predict the same."""
    said: dict[str, Any] = json.loads(verdict) if verdict else {}
    return json.dumps((said.get("holdout") or {}).get("spans_s", []))


def now() -> str:
    """The time as transcripts hold it, UTC."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def code_digest() -> str:
    found = hashlib.sha256()
    for file in sorted(CODE.rglob("*.py")):
        found.update(file.relative_to(CODE).as_posix().encode() + b"\0" + file.read_bytes())
    return found.hexdigest()
