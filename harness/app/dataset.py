"""Published recordings that lie in a folder, each diagnosed, beside what others said of them: harness dataset.

The drive axis with its cross-validation, published figures beside ours; real machines, beside what other fits said.
"""

import shlex
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module, resources
from pathlib import Path
from typing import Any

from harness.app.diagnose.many import Answer, Work, computed
from harness.app.diagnose.one import deliver
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.shared.deliver import to_json
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.app.shared.reading import read
from harness.core.checks import finite
from harness.core.errors import HarnessError, InputError
from harness.core.recording import Recording
from harness.diagnosis.inverse_dynamics.protocol import DIRECTED, PUBLISHED, SYMMETRIC, find_ripple
from harness.diagnosis.inverse_dynamics.validate import Judge, without_ripple
from harness.io.options import ReadOptions
from harness.io.recording import sha256
from harness.io.store import growing_folder, write_text
from harness.model.document import from_document
from harness.model.model import Restoring
from harness.results.dataset import DatasetResult, FigureRow, FoundResult, MachineRow, MachinesResult, RippleResult
from harness.results.diagnosis import DiagnosisResult
from harness.show.report.dataset import dataset_page, machines_page
from harness.show.report.page import write_report

LIST = "machines.toml"
FILES = {"result": "result.json", "page": "report.html"}
_READ = {"columns": "columns", "skip_rows": "skip_rows", "rate": "rate", "from": "start", "to": "stop"}
_CHOSEN = {"restoring": "restoring", "zero": "zero", "mass": "mass", "covariate": "covariates", "horizon": "horizon"}
_WORDS = ("name", "file", "source", "options", "others", "machine", "condition", "moves")


@dataclass(frozen=True, slots=True)
class Listed:
    """A recording of a machine: what it is called, its file's name, where it comes from, how it is read.

    options : as of ``harness diagnose``. others : what other fits said. machine : which it is, where several files are
    of one. condition : how far the one cause is turned in which its files differ. moves : the number, or the law, that
    grows with it.
    """

    name: str
    file: str
    source: str
    options: Mapping[str, Any] = field(default_factory=dict)
    others: str = ""
    machine: str = ""
    condition: float | None = None
    moves: str = ""

    def asked(self, where: str) -> DiagnoseOptions:
        """Its options, without engines: what is compared is the physics. Raises InputError for one that is none."""
        unknown = sorted(set(self.options) - _READ.keys() - _CHOSEN.keys())
        if unknown:
            accepted = ", ".join([*_READ, *_CHOSEN])
            raise InputError(f"{where}: {self.name}", f"the option {unknown[0]}", f"one of {accepted}")
        read = ReadOptions(**{_READ[name]: value for name, value in self.options.items() if name in _READ})
        chosen = {_CHOSEN[name]: value for name, value in self.options.items() if name in _CHOSEN}
        return DiagnoseOptions.chosen(read, engines=(), **chosen)


def listed(folder: Path) -> list[tuple[Listed, DiagnoseOptions]]:
    """The published machines, then those of a machines.toml in the folder itself. Raises InputError for a bad one."""
    own = resources.files("harness.app").joinpath(LIST).read_text(encoding="utf-8")
    found = _parsed(LIST, own)
    given = folder / LIST
    if given.is_file():
        try:
            found += _parsed(str(given), given.read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(str(given), str(error), "a readable file in UTF-8") from None
    return found


def at_hand(folder: Path, every: Sequence[tuple[Listed, DiagnoseOptions]]) -> dict[str, Path]:
    """The listed files that lie anywhere in a folder, by name. Raises InputError where none does."""
    if not folder.is_dir():
        raise InputError(f"--from {folder}", "no such folder", "one with recordings of machines")
    names = {one.file for one, _ in every}
    there: dict[str, Path] = {}
    for path in sorted(folder.rglob("*")):
        if path.name in names:
            there.setdefault(path.name, path)
    if not there:
        raise InputError(f"--from {folder}", "none of the listed recordings", f"any of {', '.join(sorted(names))}")
    return there


def _parsed(where: str, text: str) -> list[tuple[Listed, DiagnoseOptions]]:
    try:
        entries = tomllib.loads(text).get("machine", [])
    except tomllib.TOMLDecodeError as error:
        raise InputError(where, f"no TOML: {error}", "[[machine]] with name, file, source") from None
    found = []
    for i, entry in enumerate(entries if isinstance(entries, list) else [entries]):
        known = isinstance(entry, dict) and set(entry) <= set(_WORDS) and {"name", "file"} <= set(entry)
        if not known or not isinstance(entry.get("options", {}), dict):
            raise InputError(f"{where}: machine {i + 1}", "unknown or missing words", f"{', '.join(_WORDS)}")
        if "condition" in entry:
            finite(f"{where}: machine {i + 1}: condition", entry["condition"])
        one = Listed(**{"source": "", **entry})
        found.append((one, one.asked(where)))
    return found


def dataset_machines(
    folder: Path, out: Path | None = None, progress: Progress = SILENT, command: str = "", jobs: int | None = None
) -> MachinesResult:
    """Diagnose every listed recording that lies in a folder, and leave a page, a result and each diagnosis.

    Raises InputError when there is no such folder, none of the listed files is in it, or its list is bad; StoreError.
    """
    every = listed(folder)
    there = at_hand(folder, every)
    kept = [(one, options) for one, options in every if one.file in there]
    home = growing_folder("dataset-machines", out)
    works = [Work(there[one.file], one.file, home / Path(one.file).stem, options, command) for one, options in kept]
    answers: dict[str, Answer] = dict(computed(works, jobs, progress))
    result = MachinesResult(
        rows=[_row(one, answers[work.key]) for (one, _), work in zip(kept, works, strict=True)],
        absent=[one.file for one, _ in every if one.file not in there],
        machine=this_machine(),
        command=command,
        files={name: str((home / file).absolute()) for name, file in FILES.items()},
    )
    write_text(home / FILES["result"], to_json(result))
    write_report(home / FILES["page"], machines_page(result))
    return result


def _row(one: Listed, answer: Answer) -> MachineRow:
    if not isinstance(answer, DiagnosisResult):
        return MachineRow.taken_from(one, verdict="error", said=answer.error, found=[])
    fit, rest = answer.fit_percent, answer.remainder
    return MachineRow.taken_from(
        one,
        verdict=answer.verdict,
        said=answer.statement,
        found=[
            FoundResult.taken_from(m, holdout=m.holdout and m.holdout.ratio, forward=m.forward and m.forward.ratio)
            for m in answer.mechanisms
        ],
        fit_percent_before=fit and fit.baseline,
        fit_percent_after=fit and fit.refined,
        over_noise=rest and rest.over_noise,
        given=answer.holdout.given,
    )


class DownloadError(HarnessError):
    """Nothing could be downloaded."""


def download_emps(into: Path) -> Path:
    """Download both files below ``into``, which is made; returns their folder. What is there is not fetched again.

    Raises InputError without the extra, DownloadError when the download fails. Nothing is checked here: the reader
    compares the files with the published ones.
    """
    try:
        fetch = import_module("nonlinear_benchmarks").EMPS
    except ModuleNotFoundError:
        accepted = "try: pip install 'friction-harness[emps]'"
        raise InputError(
            "--download", "the package nonlinear_benchmarks is not installed (--from DIR needs none)", accepted
        ) from None
    try:
        into.mkdir(parents=True, exist_ok=True)
        files = [Path(file) for file in fetch(data_file_locations=True, dir_placement=str(into))]
    except Exception as error:  # whatever a network, an archive or a disk may raise
        said = " ".join(str(error).split()) or type(error).__name__
        raise DownloadError(f"the download into {into} failed: {said}") from None
    return files[0].parent


_LEFT = {"result": "result.json", "page": "report.html", "diagnosis": "diagnosis"}
FITTED, OTHER = "DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"
SHA256 = {
    FITTED: "6cf6814ae14618795da0101aae2bb97ff0c6351b0501b5492751b02b07facf7e",
    OTHER: "0eab75bb1f6b16228ee78791343a88bf9bfd9a51036ac9807d7b5fc11c0e1704",
}
COLUMNS = "t=t,x=qm,u=vir*gtau[N]"
SOURCE = "Janot, Gautier and Brunot 2019, nonlinearbenchmark.org"
# mass, viscous, dry friction, offset, error on the fitted recording and on the other, as published
PUBLISHED_SYMMETRIC = (95.11, 203.5, 20.39, -3.16, 4.0834, 5.9824)
PUBLISHED_DIRECTED_ERROR = 3.1117
PUBLISHED_SPEEDS = (166.7, 240.4)


@dataclass(frozen=True, slots=True)
class Emps:
    """Both recordings of the benchmark, checked to be the published files."""

    fitted: Recording
    other: Recording

    @classmethod
    def from_folder(cls, folder: Path) -> "Emps":
        """Read them; raises InputError for a file that is not there or not the published one."""
        found = []
        for name, digest in SHA256.items():
            path = folder / name
            if not path.is_file():
                raise InputError(
                    str(path), "no such file", f"try: harness dataset emps --download {shlex.quote(str(folder))}"
                )
            seen = sha256(path)
            if seen != digest:
                raise InputError(str(path), f"sha256 {seen[:12]}...", f"the published file, {digest[:12]}...")
            found.append(read(path, ReadOptions(COLUMNS)))
        return cls(*found)


def dataset_emps(
    folder: Path, out: Path | None = None, progress: Progress = SILENT, command: str = ""
) -> DatasetResult:
    """Diagnose the benchmark and leave page, result and the diagnosis in a folder.

    Raises InputError, SimulationError, StoreError.
    """
    emps = Emps.from_folder(folder)
    options = DiagnoseOptions(ReadOptions(COLUMNS), validate=folder / OTHER, restoring=Restoring.NONE)
    home = growing_folder("dataset-emps", out)
    diagnosis = deliver(emps.fitted, options, home / "diagnosis", "emps", progress, command)
    files = {name: str((home / file).absolute()) for name, file in _LEFT.items()}
    result = _result(emps, diagnosis, command, files)
    write_text(home / _LEFT["result"], to_json(result))
    write_report(home / _LEFT["page"], dataset_page(result))
    return result


def _result(emps: Emps, diagnosis: DiagnosisResult, command: str, files: dict[str, str]) -> DatasetResult:
    judge = Judge.of(emps.fitted, emps.other)
    assert judge is not None
    refined = without_ripple(from_document(diagnosis.refined_model.model_dump(by_alias=True, exclude_none=True)))
    ripples = []
    for name, recording in ((FITTED, judge.fitted), (OTHER, judge.other)):
        r = find_ripple(refined, recording)
        ripples.append(
            RippleResult(file=name, period_m=r.period, amplitude_n=r.amplitude, phase_rad=r.phase, contrast=r.contrast)
        )
    fit, cross = judge.errors(refined)
    along = " and ".join(f"{1e3 * r.period_m:.4g} mm with {r.amplitude_n:.2g} N in {r.file}" for r in ripples)
    return DatasetResult(
        name="emps",
        source=SOURCE,
        rows=[*_published(judge), _ours(diagnosis, fit, cross)],
        found=[m.statement for m in diagnosis.mechanisms],
        verdict=diagnosis.verdict,
        ripples=ripples,
        unexplained=(
            f"{fit:.3g} % of the force on the fitted recording and {cross:.3g} % on the other are not explained. Part"
            f" of it repeats along the screw: {along}; its phase differs between the files, so that it is no part of"
            " the model."
        ),
        diagnosis=diagnosis,
        command=command,
        files=files,
    )


def _published(judge: Judge) -> list[FigureRow]:
    """What was published, and the same by the protocol as it stands here."""
    mass, viscous, dry, offset, fit, cross = PUBLISHED_SYMMETRIC
    rows = [
        FigureRow(
            label="published, symmetric friction", mass_kg=mass, viscous=[viscous], dry_n=dry, offset_n=offset,
            fit_error_percent=fit, cross_error_percent=cross,
        ),
        FigureRow(
            label="published, direction-dependent friction", viscous=list(PUBLISHED_SPEEDS),
            fit_error_percent=PUBLISHED_DIRECTED_ERROR,
        ),
    ]  # fmt: skip
    for label, names in (("symmetric", SYMMETRIC), ("direction-dependent", DIRECTED)):
        value, errors = PUBLISHED.least_squares(names, judge.fitted, judge.other)
        rows.append(
            FigureRow(
                label=f"inverse model by the protocol, {label}", mass_kg=value["M"],
                viscous=_each_way(value["Fv"], value.get("Fv_diff")), dry_n=value["Fc"], offset_n=value["offset"],
                fit_error_percent=errors[0], cross_error_percent=errors[1],
            )
        )  # fmt: skip
    return rows


def _each_way(viscous: float, difference: float | None) -> list[float]:
    """Viscous friction, N s/m: to and fro where the two differ."""
    return [viscous] if difference is None else [viscous + difference, viscous - difference]


def _ours(diagnosis: DiagnosisResult, fit: float, cross: float) -> FigureRow:
    found = diagnosis.refined.parameters
    difference = next((m.parameters["c_diff"].value for m in diagnosis.mechanisms if "c_diff" in m.parameters), None)
    return FigureRow(
        label="ours, by simulation: " + (" and ".join(m.name for m in diagnosis.mechanisms) or "nothing named"),
        mass_kg=found["mass"].value,
        mass_stderr_kg=found["mass"].stderr,
        viscous=_each_way(found["c"].value or 0.0, difference),
        dry_n=found["f_k"].value,
        fit_error_percent=fit,
        cross_error_percent=cross,
    )
