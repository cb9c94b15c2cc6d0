"""Real machines: published recordings that lie in a folder, each diagnosed, beside what other fits of them said."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import Any

from harness.app.diagnose.many import Answer, Work, computed
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.shared.deliver import to_json
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.core.checks import finite
from harness.core.errors import InputError
from harness.io.options import ReadOptions
from harness.io.store import growing_folder, write_text
from harness.results.dataset import FoundResult, MachineRow, MachinesResult
from harness.results.diagnosis import DiagnosisResult
from harness.show.report.dataset import machines_page
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
    own = resources.files("harness.app.dataset").joinpath(LIST).read_text(encoding="utf-8")
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
