"""The published drive-axis case: the diagnosis with its cross-validation, published figures beside ours."""

from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from harness.app.diagnose.one import deliver
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.shared.deliver import to_json
from harness.app.shared.progress import SILENT, Progress
from harness.app.shared.reading import ReadOptions, read
from harness.core.errors import HarnessError, InputError
from harness.core.recording import Recording
from harness.diagnosis.inverse_dynamics.protocol import DIRECTED, PUBLISHED, SYMMETRIC, find_ripple
from harness.diagnosis.inverse_dynamics.validate import Judge, without_ripple
from harness.io.recording import sha256
from harness.io.store import growing_folder, write_text
from harness.model.document import from_document
from harness.model.model import Restoring
from harness.results.dataset import DatasetResult, FigureRow, RippleResult
from harness.results.diagnosis import DiagnosisResult
from harness.show.report.dataset import dataset_page
from harness.show.report.page import write_report


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


FILES = {"result": "result.json", "page": "report.html", "diagnosis": "diagnosis"}
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
                raise InputError(str(path), "no such file", f"a folder with {FITTED} and {OTHER} ({SOURCE})")
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
    files = {name: str((home / file).absolute()) for name, file in FILES.items()}
    result = _result(emps, diagnosis, command, files)
    write_text(home / FILES["result"], to_json(result))
    write_report(home / FILES["page"], dataset_page(result))
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
