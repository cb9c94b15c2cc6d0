"""What the estimators say of several recordings of one machine: each by itself, what all say, who stands out."""

import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from harness.app.diagnose.conditions import Conditions, refuse_conditions
from harness.app.diagnose.together import repeated_results
from harness.app.identify import result_of
from harness.app.shared.estimates import WHOLE
from harness.app.shared.leaving import FILES, curves_of, leave, leaving
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.app.shared.reading import read, refuse_twice
from harness.core.errors import HarnessError, InputError, SimulationError, short_names
from harness.core.quantity import Quantity
from harness.core.recording import Recording
from harness.io.options import ReadOptions
from harness.results.common import P, RepeatedResult, Swing
from harness.results.diagnosis import UnreadRecording
from harness.results.identify import QUANTITIES, SLOWING, FailedIdentify, IdentifyResult, RepeatedIdentifyResult
from harness.results.run import Estimates
from harness.show.numbers import sentence_quantity, shown_value
from harness.show.report.identify_together import repeated_page, repeated_scene

_DROPPED = frozenset({"--out", "--json", "--conditions"})
"""Options of a command for several that a line for one of them goes without: what they name is written already, or is
of several.
"""
_NONE: Conditions = MappingProxyType({})

Given = Recording | FailedIdentify


def identify_together(
    paths: Sequence[Path],
    options: ReadOptions,
    trace: str | None = None,
    out: Path | None = None,
    progress: Progress = SILENT,
    command: str = "",
    restoring: Swing = "spring",
    conditions: Conditions = _NONE,
) -> RepeatedIdentifyResult:
    """Read recordings of one machine, estimate from each, and leave one folder as ``identify`` does for one.

    Arguments as there; conditions : of the files, over which trends are told. A file that cannot be read, or shows no
    free decay, is an entry that says so; the rest go on.
    Raises InputError where none of them can be used, where one is given twice, and where units differ; StoreError.
    """
    given, errors = list[Given](), list[InputError]()
    for i, path in enumerate(paths):
        progress("reading", i, len(paths))
        try:
            given.append(read(path, options, trace))
        except InputError as error:
            errors.append(error)
            given.append(_failed(str(path), error))
    if len(errors) == len(paths):
        raise errors[0]
    return deliver_together(given, out, progress, command, restoring, conditions)


def deliver_together(
    given: Sequence[Given],
    out: Path | None = None,
    progress: Progress = SILENT,
    command: str = "",
    restoring: Swing = "spring",
    conditions: Conditions = _NONE,
) -> RepeatedIdentifyResult:
    """Estimate, and leave everything in a folder, as ``identify_together`` does."""
    with leaving("identify-together", out) as output:
        files = {name: output.at(file) for name, file in FILES.items()}
        result, recordings = result_of_together(given, command, files, restoring, progress, conditions)
        leave(output, result, repeated_page(result), repeated_scene(result, recordings))
    return result


def result_of_together(
    given: Sequence[Given],
    command: str = "",
    files: Mapping[str, str] | None = None,
    restoring: Swing = "spring",
    progress: Progress = SILENT,
    conditions: Conditions = _NONE,
) -> tuple[RepeatedIdentifyResult, list[Recording]]:
    """The estimates from recordings of one machine as a result, with those from which something was estimated.

    given : recordings, or why one was not read. Raises InputError where none can be used, where two are the same
    samples, where their units differ, and where conditions are of none of them.
    """
    refuse_twice([one for one in given if isinstance(one, Recording)], command)
    names = [_file(one) for one in given]
    refuse_conditions(conditions, names)
    entries: list[IdentifyResult | FailedIdentify] = []
    used, errors = list[Recording](), list[HarnessError]()
    for i, one in enumerate(given):
        progress("estimating", i, len(given))
        if isinstance(one, FailedIdentify):
            entries.append(one)
            continue
        line = _line_of(command, one.file, [name for name in names if name != one.file])
        try:
            entries.append(result_of(one, line, restoring=restoring)[0])
        except (InputError, SimulationError) as error:
            errors.append(error)
            entries.append(_failed(one.file, error))
        else:
            used.append(one)
    found = [one for one in entries if isinstance(one, IdentifyResult)]
    if not found:
        raise errors[0] if errors else InputError("identify", "no recording", "one or more")
    _refuse_mixed(found)
    of_files = [one.recording.file for one in found]
    together = repeated_results(of_files, [dict(_numbers(one)) for one in found], conditions=conditions)
    shared = _shared(found, together)
    method = _method_of(shared, together)
    result = RepeatedIdentifyResult(
        method=method,
        statement=_statement(method, shared, together, len(found)),
        estimates=shared,
        recordings=entries,
        together=together,
        conditions={file: dict(known) for file, known in conditions.items()},
        warnings=[*_differing(method, together, of_files), *_of_each(entries)],
        command=command,
        machine=this_machine(),
        files=dict(files or {}),
    )
    names_of = short_names([one.file for one in used])
    curves = curves_of({names_of[one.file]: one for one in used})
    return result.drawn(repeated_page, curves), used


def _failed(file: str, error: HarnessError) -> FailedIdentify:
    return FailedIdentify(recording=UnreadRecording(file=file), error=str(error))


def _file(one: Given) -> str:
    return one.file if isinstance(one, Recording) else one.recording.file


def _line_of(command: str, file: str, others: Sequence[str]) -> str:
    """The line that estimates from one of the recordings alone, with the options of the line for all."""
    words = shlex.split(command)
    kept = [
        word
        for before, word in zip(["", *words], words, strict=False)
        if word not in others and not {before, word, word.partition("=")[0]} & _DROPPED
    ]
    return shlex.join(kept) if kept else f"harness identify {shlex.quote(file)}"


def _numbers(one: IdentifyResult) -> Iterator[tuple[str, Quantity]]:
    """Every number of one recording by "METHOD.NUMBER"."""
    for method in (*one.estimates, *one.slowing):
        for name, p in one.numbers(method).items():
            yield f"{method}.{name}", Quantity(p.value, p.stderr, p.unit, p.why)


def _refuse_mixed(found: Sequence[IdentifyResult]) -> None:
    """Raise InputError where a number of one recording has another unit than that of another."""
    seen: dict[str, tuple[str, str]] = {}
    for one in found:
        file = one.recording.file
        for name, q in _numbers(one):
            unit, first = seen.setdefault(name, (q.unit, file))
            if q.unit != unit:
                what = f"{name} is in {q.unit}, and in {unit} of {first}"
                raise InputError(file, what, f"try: harness identify {shlex.quote(file)}")


def _shared(found: Sequence[IdentifyResult], together: Mapping[str, RepeatedResult]) -> dict[str, Estimates]:
    """The estimates of all recordings by method; a number that one alone tells is that one's."""
    shared = {}
    for method in dict.fromkeys(method for one in found for method in one.estimates):
        each = [one.estimates[method] for one in found if method in one.estimates]
        omega_n, zeta, x_k = (
            _of_all(f"{method}.{name}", [getattr(one, name) for one in each], together)
            for name in ("omega_n", "zeta", "x_k")
        )
        shared[method] = Estimates(omega_n=omega_n, zeta=zeta, x_k=x_k, reversals=sum(one.reversals for one in each))
    return shared


def _of_all(name: str, each: Sequence[P], together: Mapping[str, RepeatedResult]) -> P:
    if name in together:
        return together[name].value
    return next((p for p in each if p.value is not None), each[0])


def _method_of(shared: Mapping[str, Estimates], together: Mapping[str, RepeatedResult]) -> str:
    """The method whose numbers are said: the first that knows both viscous and dry friction and has them of all."""
    known = [*WHOLE, *shared]
    full = (m for m in known if m in shared and all(getattr(shared[m], n).value is not None for n in QUANTITIES))
    return next(full, next(iter(shared), "both"))


def _statement(method: str, shared: Mapping[str, Estimates], together: Mapping[str, RepeatedResult], count: int) -> str:
    said = f"{count} recording{'s' * (count > 1)}"
    if method in shared:
        p = [(name, getattr(shared[method], name)) for name in QUANTITIES]
        end = f"read by method {method} from {said} ({shared[method].reversals} reversals)."
    else:
        p = [(name, together[f"{method}.{name}"].value) for name in SLOWING if f"{method}.{name}" in together]
        end = f"fitted together in each of {said}."
    told = [f"{name} = {sentence_quantity(one)}" for name, one in p if one.value is not None]
    return f"{', '.join(told)}, {end}" if told else f"No method gives a number from {said}."


def _differing(method: str, together: Mapping[str, RepeatedResult], files: Sequence[str]) -> list[str]:
    """Where the recordings differ by more than their errors, with which condition, and which stands out."""
    names, said = short_names(files), []
    for name in (*QUANTITIES, *SLOWING):
        one = together.get(f"{method}.{name}")
        if one is None:
            continue
        if one.between > one.within:
            between, within = (shown_value(value, one.value.unit, 2) for value in (one.between, one.within))
            said.append(
                f"{name} differs between the recordings by {between} (standard deviation) beyond the"
                f" {within} that one is known to."
            )
        said += [f"{name}: {trend.said}." for trend in one.trends if trend.differs]
        if one.outliers:
            verb = "stands" if len(one.outliers) == 1 else "stand"
            said.append(f"{name} of {', '.join(names[file] for file in one.outliers)} {verb} out from the others.")
    return said


def _of_each(entries: Sequence[IdentifyResult | FailedIdentify]) -> Iterator[str]:
    """Warnings behind the file that they are of."""
    names = short_names([one.recording.file for one in entries])
    for one in entries:
        name = names[one.recording.file]
        if isinstance(one, FailedIdentify):
            yield one.error if one.error.startswith(one.recording.file) else f"{name}: {one.error}"
        else:
            yield from (f"{name}: {warning}" for warning in one.warnings)
