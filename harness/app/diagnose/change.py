"""What changed of a machine between two conditions: harness diagnose --before ... --after ..."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.problem import prepared, prepared_together
from harness.app.shared.leaving import FILES, leave, leaving
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.app.shared.reading import read_as, recording_info, thinned
from harness.core.errors import InputError, SimulationError
from harness.core.quantity import Quantity
from harness.core.recording import Recording
from harness.core.telling import listening
from harness.core.wording import capitalised
from harness.diagnosis.change import INERTIA, Compared, Number, compared, laws_of
from harness.diagnosis.moves.classify import classify
from harness.diagnosis.moves.kinds import MotionKind
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.pipeline import diagnose as conclude
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.forces_together import ForcesTogether
from harness.diagnosis.problems.together import Together
from harness.diagnosis.rules import MOVED
from harness.results.common import P
from harness.results.compare import ChangedCovariate, ChangedNumber, ChangeResult
from harness.show.report.compare import change_page

STEPS = 4
NEW = P.of(Quantity.refused("1", "there was none to be seen before"))
AS_FAR = (
    "No model explains these decays, so that they are compared from where all swing alike: what differs further up goes"
    " with the amplitude, and not with the condition."
)
UNLIKE = (
    " It may go with the amplitude, and not with the condition: no model explains these decays, and too little of them"
    " swings alike. Record both from as far."
)
EXPLAINED = ("adequate", "missing_physics")
_LAST = 5
"""Share of a decay over whose middle it comes to rest: one part of so many."""
_SWITCHED = 0.05
"""Share of a covariate by which it was another condition, and did not only vary."""
_SEEN = 3.0
"""Standard errors from which there was something of a number before."""
_OPTIONS = ("model", "sim", "horizon", "robot", "validate")
ONE_EACH = (
    "One recording per condition: repeats are taken to differ by 1 % (a spring by 0.3 %); two of each measure it."
)


def change(
    before: Sequence[tuple[Path, str]],
    after: Sequence[tuple[Path, str]],
    options: DiagnoseOptions,
    out: Path | None = None,
    progress: Progress = SILENT,
    command: str = "",
) -> ChangeResult:
    """Compare files of two conditions, path and label of each, and leave result.json and report.html in a folder.

    Raises InputError, SimulationError, StoreError.
    """
    progress("reading", 0, STEPS)

    def read(group: Sequence[tuple[Path, str]]) -> list[Recording]:
        return [read_as(label, path, options.reading, options.trace) for path, label in group]

    return deliver(read(before), read(after), options, out, progress, command)


def deliver(
    before: Sequence[Recording],
    after: Sequence[Recording],
    options: DiagnoseOptions,
    out: Path | None = None,
    progress: Progress = SILENT,
    command: str = "",
) -> ChangeResult:
    """Compare recordings of two conditions, and leave what was found in a folder."""
    with leaving("change", out) as output:
        files = {name: output.at(file) for name, file in FILES.items() if name != "rrd"}
        result = result_of(before, after, options, progress, command, files)
        leave(output, result, change_page(result))
    return result


@dataclass(frozen=True, slots=True)
class _Ready:
    """Recordings of both conditions, prepared alike. laid : what is to be diagnosed of some of them."""

    each: Sequence[Problem]
    laid: Callable[[Sequence[Problem]], Sequence[Problem]]
    warnings: tuple[str, ...]
    notes: tuple[str, ...]

    @property
    def decays(self) -> bool:
        """Whether they swing freely."""
        return all(one.returns and one.moves and one.drive is None for one in self.each)

    @classmethod
    def of(cls, recordings: Sequence[Recording], options: DiagnoseOptions) -> "_Ready":
        """Decays, and driven recordings, laid one behind the other; run-downs and tables one by one.

        Raises InputError for recordings of several kinds.
        """
        alone = (MotionKind.RUN_DOWN, MotionKind.FRICTION_CURVE)
        one_by_one = [classify(one, options.restoring).kind in alone for one in recordings]
        if any(one_by_one):
            found = [prepared(one, options) for one in recordings]
            kinds = {type(one.problem) for one in found}
            if len(kinds) > 1:
                other = recordings[one_by_one.index(True)].file
                raise InputError("--before", f"{other} is no motion of the kind of all others", "one kind")
            said = [line for one in found for line in one.warnings], [line for one in found for line in one.notes]
            return cls([one.problem for one in found], lambda group: group, tuple(said[0]), tuple(said[1]))
        ready = prepared_together(recordings, options)
        whole = ready.problem
        assert isinstance(whole, Together | ForcesTogether)

        def laid(group: Sequence[Problem]) -> Sequence[Problem]:
            return group if len(group) == 1 else [type(whole).laid(group)]  # type: ignore[arg-type]

        if not isinstance(whole, ForcesTogether):
            return cls(whole.alone, laid, ready.warnings, ready.notes)
        # dry and viscous friction are those under the load that each was recorded at
        each = [replace(one, first=one.first.recentred(one.covariates)) for one in whole.each]
        return cls(each, laid, ready.warnings, (*ready.notes, *whole.enters))


def result_of(
    before: Sequence[Recording],
    after: Sequence[Recording],
    options: DiagnoseOptions,
    progress: Progress = SILENT,
    command: str = "",
    files: Mapping[str, str] | None = None,
) -> ChangeResult:
    """What changed. Raises InputError for recordings that are not of one machine, SimulationError."""
    for name in _OPTIONS:
        if getattr(options, name) is not None:
            raise InputError(f"--{name}", "given with --before", "it goes with one recording")
    recordings = [thinned(one) for one in (*before, *after)]
    ready, count = _Ready.of(recordings, options), len(before)
    groups = ready.each[:count], ready.each[count:]
    outcomes: list[list[Outcome]] = []
    with np.errstate(over="ignore", invalid="ignore"), listening(progress):
        for i, group in enumerate(groups):
            progress(("before", "after")[i], 1 + i, STEPS)
            outcomes.append([conclude(whole, seconds=options.seconds) for whole in ready.laid(group)])
        progress("what changed", 3, STEPS)
        laws, alike, doubt = laws_of([one for group in outcomes for one in group]), list[str](), ""
        found = compared(*groups, laws)
        explained = all(one.verdict in EXPLAINED for group in outcomes for one in group)
        if found.found.directions and not explained and ready.decays:
            try:
                each = _Ready.of(swinging_alike(recordings), options).each
                found, alike = compared(each[:count], each[count:], laws), [AS_FAR]
            except (InputError, SimulationError):
                doubt = UNLIKE
    alone = (ONE_EACH,) if max(len(before), len(after)) == 1 else ()
    unknown = [
        f"{name}: no model explains the recordings, so that errors allow for what is left over"
        for name, group in zip(("before", "after"), outcomes, strict=True)
        if any(one.verdict not in EXPLAINED for one in group)
    ]
    read = [note for one in recordings for note in one.notes]
    infos = [recording_info(one, problem.noise) for one, problem in zip(recordings, ready.each, strict=True)]
    given = _given(ready.each, count)
    result = ChangeResult(
        statement=f"{_switched(given)}{_statement(found)}{doubt}",
        changed=list(found.found.directions),
        chance=found.found.chance,
        left=found.found.left,
        numbers=_numbers(found),
        laws=list(found.laws),
        given=given,
        before=infos[:count],
        after=infos[count:],
        warnings=list(dict.fromkeys([*ready.warnings, *alone, *unknown, *alike, *read, *ready.notes])),
        command=command,
        machine=this_machine(),
        files=dict(files or {}),
    )
    return result.drawn(change_page)


def swinging_alike(recordings: Sequence[Recording]) -> list[Recording]:
    """Decays from where each swings no further than the least of them, about where they come to rest."""
    channel = next(c for c in ("x", "v", "a") if all(c in one for one in recordings))
    swings = [np.abs(one[channel] - np.median(one[channel][-(len(one) // _LAST) :])) for one in recordings]
    least = min(float(np.max(y)) for y in swings)
    begins = [int(np.max(np.flatnonzero(y > least), initial=-1)) + 1 for y in swings]
    return [one.cut(slice(begin, None)) for one, begin in zip(recordings, begins, strict=True)]


def _given(each: Sequence[Problem], count: int) -> list[ChangedCovariate]:
    """What covariates were in both conditions; count : recordings before."""
    found = []
    for name in each[0].covariates:
        before, after = (
            float(np.mean(np.concatenate([one.covariates[name] for one in side])))
            for side in (each[:count], each[count:])
        )
        found.append(ChangedCovariate(name=name, before=before, after=after))
    return found


def _switched(given: Sequence[ChangedCovariate]) -> str:
    """Which covariates are not what they were."""
    moved = [one for one in given if abs(one.after - one.before) > _SWITCHED * abs(one.before)]
    said = [f"{one.name} went from {one.before:.3g} to {one.after:.3g}, whose push is accounted for" for one in moved]
    return f"{capitalised('; '.join(said))}. " if said else ""


def _numbers(compared: Compared) -> list[ChangedNumber]:
    found, rows = compared.found, []
    moved = INERTIA in found.directions
    for i, one in enumerate(compared.numbers):
        values = [Quantity(float(y[i, 0]), float(y[i, 1]), one.unit) for y in (found.before, found.after)]
        rows.append(
            ChangedNumber(
                name=one.name,
                said=one.said,
                before=P.of(values[0]),
                after=P.of(values[1]),
                ratio=_ratio(compared, one.name) if _seen(found.before[i]) else NEW,
                changed=one.name in found.directions,
                repeats=float(found.between[i]),
            )
        )
    if INERTIA in found.moves:
        inertia = ChangedNumber(name=INERTIA, said=INERTIA, ratio=_ratio(compared, INERTIA), changed=moved)
        rows.append(inertia)
    return rows


def _seen(number: tuple[float, float]) -> bool:
    """Whether a value with its standard error is anything but 0."""
    value, error = number
    return abs(value) >= _SEEN * error


def _ratio(compared: Compared, name: str) -> P:
    """After over before; of an inertia over which all forces are known, its own."""
    one = compared.found.moves[name]
    value, error = one.ratio, one.stderr
    if name == INERTIA:
        value, error = 1.0 / value, error / value**2
    if not math.isfinite(value) or not math.isfinite(error):
        return P.of(Quantity.refused("1", "the recordings do not tell it"))
    return P.of(Quantity(value, error, "1"))


def _statement(compared: Compared) -> str:
    """What changed, by how much, and what did not."""
    found = compared.found
    said = {one.name: one for one in compared.numbers}
    changed = [_changed(name, said.get(name), compared) for name in found.directions]
    moved = {INERTIA: set(said)}.get(next(iter(found.directions), ""), set[str]()) | set(found.directions)
    same = [f"{one.said} (within {_within(compared, one.name)})" for one in compared.numbers if one.name not in moved]
    if not changed:
        return f"Nothing changed beyond what repeats differ by: {_listed(same)} stayed."
    more = ""
    if found.left < MOVED.value:
        more = " More differs than these numbers say: a law is missing, or it is another machine."
    stayed = f" {capitalised(_listed(same))} stayed." if same else ""
    return f"{capitalised('; '.join(changed))}.{stayed}{more}"


def _changed(name: str, one: Number | None, compared: Compared) -> str:
    ratio = _ratio(compared, name)
    if one is not None:
        i = compared.numbers.index(one)
        (was, error), (now, spread) = compared.found.before[i], compared.found.after[i]
        if not _seen((was, error)):
            return f"{one.said} is {Quantity(float(now), float(spread), one.unit)}, where there was none to be seen"
        if not _seen((now, spread)):
            return f"{one.said} is gone: it was {Quantity(float(was), float(error), one.unit)}"
    times = Quantity(ratio.value, ratio.stderr, "1", ratio.why)
    return f"{INERTIA if one is None else one.said} is {times} times what it was"


def _within(compared: Compared, name: str) -> str:
    # two figures, and no power of ten however little is known
    return f"{float(f'{200.0 * compared.found.moves[name].stderr:.2g}'):.12g} %"


def _listed(parts: Sequence[str]) -> str:
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}" if parts else "all"
