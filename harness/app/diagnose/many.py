"""Several recordings in one call: each in a folder of its own, in processes; a bad one does not stop the rest."""

import logging
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from pydantic import ValidationError

from harness.app.diagnose.conditions import read_conditions
from harness.app.diagnose.fleet import fleet_of
from harness.app.diagnose.one import FILES, deliver
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.result import STEPS
from harness.app.diagnose.siblings import advice_on
from harness.app.shared.deliver import to_json
from harness.app.shared.machine import cores, package_version
from harness.app.shared.progress import SILENT, Progress
from harness.app.shared.reading import read_as, read_runs
from harness.app.shared.rows import folder_of, resumable, worked
from harness.core.errors import HarnessError, InputError, StoreError
from harness.diagnosis.moves.classify import classify
from harness.diagnosis.moves.kinds import decays_of
from harness.io.logs.read import source_of
from harness.io.recording import sha256
from harness.io.store import clear, held, write_text
from harness.results.diagnosis import DiagnosisResult, FailedDiagnosis, UnreadRecording
from harness.results.fleet import FleetResult
from harness.show.report.diagnosis import index_page
from harness.show.report.page import write_report

LOGGER = logging.getLogger(__name__)
Answer = DiagnosisResult | FailedDiagnosis
RESULT, PAGE, FLEET = "result.json", "index.html", "fleet.json"
_DIED = "the process that worked on it ended early (BrokenProcessPool)"


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
    """Answers in the order of the files. folder : where everything is. fleet : of logs of one robot, compared.

    advice : what to try next with recordings that look like one machine, "" for nothing.
    """

    answers: tuple[Answer, ...]
    folder: Path
    fleet: FleetResult | None = None
    advice: str = ""

    @property
    def failed(self) -> int:
        """Files without a diagnosis."""
        return sum(isinstance(answer, FailedDiagnosis) for answer in self.answers)

    def json(self) -> str:
        return "[\n" + ",\n".join(to_json(answer).rstrip("\n") for answer in self.answers) + "\n]\n"


def check_folder(path: Path) -> None:
    """Raise InputError for a folder that is no log of joints."""
    source_of(path, several=True)


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
    if options.servo is not None:
        return _servo([(path, label or str(path))], options, out, progress, command)
    if options.robot is not None:
        from harness.app.diagnose.joint import diagnose_joint

        return diagnose_joint(path, options.robot, options, out, progress, command, label)
    label = str(path) if label is None else label
    progress("reading", 0, STEPS)
    try:
        recording = read_as(label, path, options.reading, options.trace)
    except InputError:
        if _of_servo(path, options):
            return _servo([(path, label)], options, out, progress, command)
        raise
    if recording.extra.get("commanded") and _of_servo(path, options):
        return _servo([(path, label)], options, out, progress, command)
    name = "stdin" if label == "-" else path.name.split(".")[0]
    return deliver(recording, options, out, name, progress, command)


def diagnose_together(
    named: Sequence[tuple[Path, str]],
    options: DiagnoseOptions,
    out: Path | None = None,
    progress: Progress = SILENT,
    command: str = "",
    turned: Sequence[str] = (),
) -> DiagnosisResult:
    """Diagnose files as recordings of one machine, and leave in a folder what one recording leaves.

    named : path and label of each. turned : labels, or names, of files that went the other way and say no sign. Raises
    InputError, SimulationError, StoreError.
    """
    names = {name for _, label in named for name in (label, Path(label).name)}
    if unknown := [one for one in turned if one not in names]:
        accepted = f"{', '.join(Path(label).name for _, label in named)}"
        raise InputError("--flip", f"{unknown[0]}, which is none of the recordings", accepted)
    if options.servo is not None:
        return _servo(named, options, out, progress, command)
    progress("reading", 0, STEPS)
    recordings = []
    for path, label in named:
        for run in read_runs(label, path, options.reading, options.trace):
            parts = decays_of(run, classify(run, options.restoring))
            recordings += [one.turned() for one in parts] if {label, path.name} & {*turned} else parts
    return deliver(recordings, options, out, "together", progress, command)


def _of_servo(path: Path, options: DiagnoseOptions) -> bool:
    """Whether nothing else is asked and a file is of joints that follow goals."""
    from harness.app.diagnose.servo import follows_goals

    asked = (options.model, options.sim, options.validate, options.trace, options.restoring)
    return all(one is None for one in asked) and follows_goals(path, options)


def _servo(
    named: Sequence[tuple[Path, str]], options: DiagnoseOptions, out: Path | None, progress: Progress, command: str
) -> DiagnosisResult:
    from harness.app.diagnose.servo import diagnose_servo

    return diagnose_servo(named, options, out, progress, command)


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
    conditions: Path | None = None,
) -> Many:
    """Diagnose files, each into DIR/NAME, and leave result.json with all of them and index.html.

    named : path and label of each. jobs : processes, None for one a core. resume : keep what ``out`` holds of the same
    files under the same options. cluster : address of a dask scheduler whose workers see the same files, in place of
    processes here. conditions : a table, of
    logs of one robot, of which fleet.json is left too. Raises InputError, StoreError;
    InterruptionError keeps what was done.
    """
    known = {} if conditions is None else read_conditions(conditions)
    folder = folder_of("diagnose", out, resume, "diagnoses")
    names = folder_names([label for _, label in named])
    works = [
        Work(path, label, folder / name, options, command) for (path, label), name in zip(named, names, strict=True)
    ]
    answers: dict[str, Answer] = {}
    with held(folder):
        if resume:
            answers = {work.key: kept for work in works if (kept := _kept(work)) is not None}
        left = [work for work in works if work.key not in answers]
        with resumable(folder, lambda: f"{len(answers)} of {len(works)} recordings are kept"):
            for key, answer in computed(left, jobs, progress, len(answers), function, cluster):
                answers[key] = answer
        many = Many(tuple(answers[work.key] for work in works), folder)
        write_text(folder / RESULT, many.json())
        good = [answer for answer in many.answers if isinstance(answer, DiagnosisResult)]
        if options.robot is not None and len(good) > 1:
            fleet = fleet_of(good, options.robot.file, known, command)
            many = replace(many, fleet=fleet)
            write_text(folder / FLEET, to_json(fleet))
        elif options.robot is None and options.servo is None and not many.failed:
            many = replace(many, advice=advice_on(good, command))
        write_report(folder / PAGE, index_page(many.answers, folder, command, many.fleet, many.advice))
        return many


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
    accepted = "the same file, options and version, or a new --out"
    try:
        kept = DiagnosisResult.model_validate_json(path.read_text(encoding="utf-8"))
    except (ValidationError, OSError, UnicodeDecodeError):
        raise InputError(str(path), "no diagnosis that this version can read", accepted) from None
    settings, why = work.options.settings(), None
    if kept.settings != settings:
        why = f"with another {', '.join(name for name, value in settings.items() if kept.settings.get(name) != value)}"
    elif kept.recording.sha256 != _digest(work):
        why = f"of another file than {work.label}"
    elif kept.machine.packages.get("friction-harness") != package_version("friction-harness"):
        why = "by another version"
    if why is not None:
        raise InputError("--resume", f"{work.folder.name} was made {why}", accepted)
    return kept


def _digest(work: Work) -> str:
    """Of the file as it is now, "" where it cannot be read."""
    try:
        return sha256(work.path) if work.options.robot is None else source_of(work.path).sha256
    except (OSError, InputError):
        return ""


Keyed = tuple[str, Answer | StoreError]


def computed(
    left: Sequence[Work],
    jobs: int | None,
    progress: Progress = SILENT,
    had: int = 0,
    function: Callable[[Work], Answer] = compute,
    cluster: str | None = None,
) -> Iterator[tuple[str, Answer]]:
    """Answers by key, as they come. Raises StoreError; on a cluster, whose disks are its own, that is an entry."""
    total, what = had + len(left), "recordings"
    if cluster is None and min(jobs or cores(), len(left)) <= 1:
        progress(what, had, total)
        for done, work in enumerate(left, had + 1):
            yield work.key, function(work)
            progress(what, done, total)
        return
    one, lost = partial(_answer, function, cluster is not None), partial(_lost, cluster is not None)
    try:
        with worked(what, left, one, lost, progress, (had, total), jobs=jobs, cluster=cluster, chances=1) as answers:
            for key, answer in answers:
                if isinstance(answer, StoreError):
                    raise answer
                yield key, answer
    finally:
        for folder in {work.folder.parent for work in left}:
            clear(folder)  # of the workers that were ended within a row


def _answer(function: Callable[[Work], Answer], elsewhere: bool, work: Work) -> Keyed:
    """In a worker: what one that died has left is taken."""
    try:
        return work.key, _kept(work) or function(work)
    except StoreError as error:
        return work.key, failed(work.label, str(error)) if elsewhere else error


def _lost(elsewhere: bool, work: Work, reason: str) -> Keyed:
    """The entry of a file whose worker died, and nothing half-written."""
    clear(work.folder.parent)
    return work.key, failed(work.label, reason if elsewhere else _DIED)
