"""Several recordings in one call: each in a folder of its own, in processes; a bad one does not stop the rest."""

import logging
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

from pydantic import ValidationError

from harness.app.diagnose.fleet import Conditions, fleet_of
from harness.app.diagnose.one import FILES, STEPS, deliver
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.show import write_index
from harness.app.shared.completed import completed
from harness.app.shared.deliver import to_json
from harness.app.shared.machine import cores, package_version
from harness.app.shared.pool import Cluster, LocalPool
from harness.app.shared.progress import SILENT, Progress
from harness.app.shared.reading import read_as
from harness.app.sweep.sweep import InterruptionError
from harness.core.errors import HarnessError, InputError, StoreError
from harness.core.writing import sweep
from harness.io.logs.read import source_of
from harness.io.recording import sha256
from harness.io.store import growing_folder, held, write_text
from harness.results.diagnosis import DiagnosisResult, FailedDiagnosis, UnreadRecording
from harness.results.fleet import FleetResult

LOGGER = logging.getLogger(__name__)
Answer = DiagnosisResult | FailedDiagnosis
RESULT, PAGE, FLEET = "result.json", "index.html", "fleet.json"


@dataclass(frozen=True, slots=True)
class Work:
    """One file of several: where it is, what it is called, the folder its files go to."""

    path: Path
    label: str
    folder: Path
    options: DiagnoseOptions = field(default_factory=DiagnoseOptions)
    command: str = ""

    @property
    def key(self) -> str:
        """Its own among all files of a call."""
        return self.folder.name


@dataclass(frozen=True, slots=True)
class Many:
    """Answers in the order of the files. folder : where everything is. fleet : of logs of one robot, compared."""

    answers: tuple[Answer, ...]
    folder: Path
    fleet: FleetResult | None = None

    @property
    def failed(self) -> int:
        """Files without a diagnosis."""
        return sum(isinstance(answer, FailedDiagnosis) for answer in self.answers)

    def json(self) -> str:
        """The array, as files hold it."""
        return json_array(self.answers)


def diagnose(
    path: Path,
    options: DiagnoseOptions,
    out: Path | None = None,
    progress: Progress = SILENT,
    command: str = "",
    label: str | None = None,
) -> DiagnosisResult:
    """Diagnose a file, and leave result, report, trace, models and the log in a folder.

    out : new or empty folder, None for reports/NAME-TIME here. label : what to call the file, where it stands in for
    another ("-"). Raises InputError, SimulationError, StoreError.
    """
    if options.robot is not None:
        from harness.app.diagnose.joint import diagnose_joint

        return diagnose_joint(path, options.robot, options, out, progress, command, label)
    label = str(path) if label is None else label
    progress("reading", 0, STEPS)
    recording = read_as(label, path, options.reading, options.trace)
    name = "stdin" if label == "-" else path.name.split(".")[0]
    return deliver(recording, options, out, name, progress, command)


def json_array(answers: Sequence[Answer]) -> str:
    """Entries as a JSON array."""
    return "[\n" + ",\n".join(to_json(answer).rstrip("\n") for answer in answers) + "\n]\n"


def failed(label: str, reason: str) -> FailedDiagnosis:
    """The entry of a file that failed."""
    return FailedDiagnosis(recording=UnreadRecording(file=label), error=reason)


def compute(work: Work) -> Answer:
    """Diagnose one file; what goes wrong with it becomes its entry. Runs in a worker process.

    Raises StoreError: where this one cannot be written, neither can the next.
    """
    try:
        return diagnose(work.path, work.options, work.folder, command=work.command, label=work.label)
    except StoreError:
        raise
    except HarnessError as error:
        return failed(work.label, str(error))
    except Exception as error:
        LOGGER.exception("%s", work.label)
        return failed(work.label, f"internal error, {type(error).__name__}: {' '.join(str(error).split())}")


def compute_keyed(work: Work) -> tuple[str, Answer]:
    """The same with the work's key; what cannot be written by a machine of a cluster is an entry."""
    try:
        return work.key, compute(work)
    except StoreError as error:
        return work.key, failed(work.label, str(error))


def diagnose_all(
    named: Sequence[tuple[Path, str]],
    options: DiagnoseOptions,
    out: Path | None = None,
    jobs: int | None = None,
    resume: bool = False,
    progress: Progress = SILENT,
    command: str = "",
    function: Callable[[Work], Answer] = compute,
    cluster: str | None = None,
    conditions: Conditions | None = None,
) -> Many:
    """Diagnose files, each into DIR/NAME, and leave result.json with all of them and index.html.

    named : path and label of each. jobs : processes, None for one a core. resume : keep what ``out`` holds of the same
    files under the same options. cluster : address of a dask scheduler whose workers see the same files, in place of
    processes here. conditions : of logs of one robot. Of those fleet.json is left too. Raises InputError, StoreError;
    InterruptionError keeps what was done.
    """
    folder = _folder(out, resume)
    with held(folder):
        works = [
            Work(path, label, folder / name, options, command)
            for (path, label), name in zip(named, folder_names([label for _, label in named]), strict=True)
        ]
        answers: dict[int, Answer] = {}
        if resume:
            for i, work in enumerate(works):
                kept = _kept(work)
                if kept is not None:
                    answers[i] = kept
        progress("recordings", len(answers), len(works))
        left = {i: work for i, work in enumerate(works) if i not in answers}
        try:
            done_here = computed(left, min(jobs or cores(), max(len(left), 1)), function)
            for i, answer in done_here if cluster is None else on_cluster(left, cluster):
                answers[i] = answer
                progress("recordings", len(answers), len(works))
        except (KeyboardInterrupt, StoreError) as error:
            kind, what = (
                (StoreError, str(error)) if isinstance(error, StoreError) else (InterruptionError, "interrupted")
            )
            done = f"{len(answers)} of {len(works)} recordings are kept"
            raise kind(f"{what}; {done}, the same command with --resume --out {folder} goes on") from None
        many = Many(tuple(answers[i] for i in range(len(works))), folder)
        write_text(folder / RESULT, many.json())
        good = [answer for answer in many.answers if isinstance(answer, DiagnosisResult)]
        if options.robot is not None and len(good) > 1:
            fleet = fleet_of(good, options.robot.file, conditions, command)
            many = replace(many, fleet=fleet)
            write_text(folder / FLEET, to_json(fleet))
        write_index(folder / PAGE, many.answers, command, many.fleet)
        return many


def _folder(out: Path | None, resume: bool) -> Path:
    if not resume:
        return growing_folder("diagnose", out)
    if out is None:
        raise InputError("--resume", "given without --out", "the folder of the diagnoses to go on with is accepted")
    if not out.is_dir():
        raise InputError(f"--out {out}", "no such folder to resume", "the folder of one, or no --resume, is accepted")
    return out.absolute()


def folder_names(labels: Sequence[str]) -> list[str]:
    """A folder for each file, named after it; the second of a name has -2."""
    seen: dict[str, int] = {}
    names = []
    for label in labels:
        stem = (Path(label).name.split(".")[0] if label != "-" else "stdin") or "recording"
        seen[stem] = seen.get(stem, 0) + 1
        names.append(stem if seen[stem] == 1 else f"{stem}-{seen[stem]}")
    return names


def _kept(work: Work) -> DiagnosisResult | None:
    """What an earlier call has left for this file; None when there is nothing.

    Raises InputError when it was made of another file, with other options or by another version.
    """
    path = work.folder / FILES["result"]
    if not path.is_file():
        return None
    accepted = "the same file, options and version, or a new --out, are accepted"
    try:
        kept = DiagnosisResult.model_validate_json(path.read_text(encoding="utf-8"))
    except (ValidationError, OSError, UnicodeDecodeError):
        raise InputError(str(path), "no diagnosis that this version can read", accepted) from None
    if kept.settings != work.options.settings():
        changed = [name for name, value in work.options.settings().items() if kept.settings.get(name) != value]
        raise InputError("--resume", f"{work.folder.name} was made with another {', '.join(changed)}", accepted)
    try:
        own = sha256(work.path) if work.options.robot is None else source_of(work.path).sha256
        same = kept.recording.sha256 == own
    except (OSError, InputError):
        same = False
    if not same:
        raise InputError("--resume", f"{work.folder.name} was made of another file than {work.label}", accepted)
    if kept.machine.packages.get("friction-harness") != package_version("friction-harness"):
        raise InputError("--resume", f"{work.folder.name} was made by another version", accepted)
    return kept


def computed(left: dict[int, Work], jobs: int, function: Callable[[Work], Answer]) -> Iterator[tuple[int, Answer]]:
    """Answers as they come, by the keys of ``left``."""
    if jobs == 1:
        yield from ((i, function(work)) for i, work in left.items())
        return
    pool = LocalPool(jobs)
    try:
        suspects: list[int] = []
        waiting = list(left)
        running: dict[Future[Answer], int] = {}
        while waiting or running:
            while waiting and len(running) < jobs:
                i = waiting.pop(0)
                running[pool.executor.submit(function, left[i])] = i
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            dead = [running.pop(future) for future in done if _died(pool, future)]
            # what has ended with an error ends the call: those that are good count before it
            for future in sorted(done & running.keys(), key=lambda future: future.exception() is not None):
                i = running.pop(future)
                yield i, _answer(left[i], future)
            if dead:
                # a death breaks the pool for all that ran beside it: each is tried again by itself
                suspects += [*dead, *running.values()]
                running.clear()
                pool.renew()
        for i in suspects:
            _clear(left[i])
            kept = _kept(left[i])
            if kept is not None:
                yield i, kept
                continue
            future = pool.executor.submit(function, left[i])
            wait([future])
            yield i, _answer(left[i], future)
            if _died(pool, future):
                _clear(left[i])
                pool.renew()
    finally:
        pool.close()


def on_cluster(left: dict[int, Work], address: str) -> Iterator[tuple[int, Answer]]:
    """The same from a cluster's workers, which write into the same folders."""
    numbers = {work.key: i for i, work in left.items()}
    workers = Cluster(address)
    try:
        for key, answer in completed(left.values(), workers, compute_keyed, _lost):
            yield numbers[key], answer
    finally:
        workers.close()


def _lost(work: Work, reason: str) -> tuple[str, Answer]:
    _clear(work)
    return work.key, failed(work.label, reason)


def _clear(work: Work) -> None:
    """Remove what a process that died has left half-written."""
    sweep(work.folder.parent, work.folder.name)
    with suppress(OSError):
        work.folder.rmdir()


def _died(pool: LocalPool, future: "Future[Answer]") -> bool:
    error = future.exception()
    return error is not None and pool.died(error)


def _answer(work: Work, future: "Future[Answer]") -> Answer:
    error = future.exception()
    if error is None or isinstance(error, StoreError):
        return future.result()
    return failed(work.label, f"the process that worked on it ended early ({type(error).__name__})")
