"""Several recordings of one machine as one: what they share, what each has of its own, and the physics left out."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from harness.app.diagnose.attribution import Configured
from harness.app.diagnose.conditions import Conditions, in_order, refuse_conditions
from harness.app.diagnose.files import simulated
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.problem import prepared_together, validation
from harness.app.diagnose.result import STEPS, Diagnosed, read_of, result_of, with_laws
from harness.app.shared.progress import SILENT, Progress
from harness.app.shared.reading import recording_info, refuse_twice, thinned
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.core.recording import Recording
from harness.core.telling import listening
from harness.diagnosis.fit.rmse import rmse
from harness.diagnosis.fit.standard_errors import numbers_of
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.pipeline import diagnose as conclude
from harness.diagnosis.pooling.pooled import differences
from harness.diagnosis.pooling.repeated import alone_under, parameters_of
from harness.diagnosis.problems.forces_together import ForcesTogether
from harness.diagnosis.problems.together import Together
from harness.diagnosis.rules import CHANCE
from harness.estimate.repeated import repeated, trends
from harness.model.elsewhere import named
from harness.results.common import FleetTrend, P, RepeatedResult
from harness.results.diagnosis import OwnResult

COVERAGE = 2.0
"""k of an expanded uncertainty: about 95 %, as laboratories report it (GUM)."""


def own_results(recordings: Sequence[Recording], outcome: Outcome) -> list[OwnResult]:
    """Start, zero, noise and errors of each recording, and in what it differs from the first."""
    problem, refined, pooled = outcome.problem, outcome.refined, outcome.pooled
    assert isinstance(problem, Together | ForcesTogether)
    assert pooled is not None
    explained = outcome.verdict in ("adequate", "missing_physics")
    length = "rad" if problem.angular else "m"
    numbers = numbers_of(refined, problem, outcome.scales.omega, explained)
    differ = differences(refined, problem, outcome.scales.omega, explained)
    first = recordings[0].name
    errors = _of_starts(problem)
    found = []
    runs = problem.runs(refined.model)
    for r, (one, at, alone) in enumerate(zip(recordings, problem.places, problem.alone, strict=True)):
        inside = np.zeros(problem.t.size, dtype=bool)
        inside[at] = True
        own, clock = runs[r].model, runs[r].clock
        values = {"x0": (own.x0, length), "v0": (own.v0, f"{length}/s"), "offset": (own.offset, length)}
        said = {}
        for name, (value, unit) in values.items():
            error = numbers.get(named(name, r), errors[r].get(name))
            why = None if error else "given, not fitted" if name != "v0" else "released from rest"
            said[name] = Quantity(value, error, unit, why)
        found.append(
            OwnResult.taken_from(
                one,
                begins_s=clock + (0.0 if isinstance(problem, Together) else runs[r].model.t0),
                start={name: said[name] for name in ("x0", "v0")},
                zero=said["offset"] if problem.zero_free and "x" in problem.channels else None,
                noise={c: n.said for c, n in alone.noise.items()},
                baseline_rmse=rmse(outcome.base.shown.y, problem, inside),
                rmse=rmse(refined.shown.y, problem, inside),
                alone=pooled.compared.alone[r].parameters,
                differs=[d.said(first) for d in differ[r] if d.clearly],
                unshared=list(problem.starts.own),
            )
        )
    return found


def _of_starts(problem: Together | ForcesTogether) -> list[dict[str, float]]:
    """Standard errors of the starts of recordings that are not fitted but smoothed, by name."""
    if isinstance(problem, Together):
        return [{} for _ in problem.alone]
    firsts = [one.starts.windows[0] for one in problem.each]
    return [{"x0": w.x_sd, "v0": w.v_sd} for w in firsts]


def repeated_results(
    files: Sequence[str],
    each: Sequence[Mapping[str, Quantity]],
    hidden: Mapping[str, float] = MappingProxyType({}),
    conditions: Conditions = MappingProxyType({}),
) -> dict[str, RepeatedResult]:
    """Every number by name that two recordings or more tell with an error; files and each in the same order.

    hidden : by name, what effects that could not be seen could shift it by. conditions : of the files.
    """
    told: dict[str, list[tuple[int, float, float, str]]] = {}
    for i, one in enumerate(each):
        for name, q in one.items():
            if q.value is not None and q.stderr:
                told.setdefault(name, []).append((i, q.value, q.stderr, q.unit))
    told = {name: known for name, known in told.items() if len(known) > 1}
    given = in_order(conditions, files)
    level = CHANCE.value / max(len(told) * len(given), 1)
    found = {}
    for name, known in told.items():
        at, values, errors, units = (list(column) for column in zip(*known, strict=True))
        seen, unit, systematic = repeated(values, errors), units[0], hidden.get(name)
        here = {what: [all_of_it[i] for i in at] for what, all_of_it in given.items()}
        found[name] = RepeatedResult(
            value=P(value=seen.value, stderr=seen.stderr, unit=unit, systematic=systematic),
            expanded=COVERAGE * math.hypot(seen.stderr, systematic or 0.0),
            within=seen.within,
            between=seen.between,
            outliers=[files[at[i]] for i in seen.outliers],
            trends=[FleetTrend.taken_from(t) for t in trends(here, np.array(values), np.array(errors), unit, level)],
        )
    return found


def _hidden(outcome: Outcome) -> dict[str, float]:
    """What effects that could not be seen could shift each number of the refined model by, by name."""
    found = {name: q.systematic for name, q in outcome.refined_parameters.items()}
    return {name: shift for name, shift in found.items() if shift is not None}


def investigate_together(
    recordings: Sequence[Recording], options: DiagnoseOptions, progress: Progress = SILENT, command: str = ""
) -> Diagnosed:
    """Diagnose recordings of one machine, laid one behind the other.

    Raises InputError when they cannot be diagnosed together, with the reason, and where one is given twice;
    SimulationError.
    """
    _refuse_options(options)
    refuse_twice(recordings, command)
    refuse_conditions(options.conditions, [one.file for one in recordings])
    progress("base fit and search", 1, STEPS)
    recordings = [thinned(one) for one in recordings]
    ready = prepared_together(recordings, options)
    problem = ready.problem
    assert isinstance(problem, Together | ForcesTogether)
    with np.errstate(over="ignore", invalid="ignore"), listening(progress):
        outcome = conclude(problem, seconds=options.seconds)
    progress("engines", 2, STEPS)
    assert outcome.pooled is not None
    files = [one.file for one in recordings]
    each = alone_under(outcome.refined, problem, outcome.scales, outcome.pooled.compared.alone)
    more = {
        "recordings": [recording_info(one, alone.noise) for one, alone in zip(recordings, problem.alone, strict=True)],
        "own": own_results(recordings, outcome),
        "together": repeated_results(files, [parameters_of(one) for one in each], _hidden(outcome), options.conditions),
    }
    laid, other = _laid(recordings, problem, outcome), validation(recordings[0], options)
    result = result_of(laid, ready, outcome, options, Configured(), other, command, **more)
    result = result.model_copy(update={"read": read_of(recordings, options)})
    result, left = with_laws(result, outcome)
    return Diagnosed(laid, outcome, simulated(laid, outcome), result, left)


def _refuse_options(options: DiagnoseOptions) -> None:
    """Raise InputError for what belongs to one recording."""
    for name in ("model", "sim", "horizon"):
        if getattr(options, name) is not None:
            one = "recording, whose mismatch is divided" if name in ("model", "sim") else "driven recording"
            found = f"given with --{name}"
            raise InputError("--together", found, f"it goes with one {one}")


def _laid(recordings: Sequence[Recording], problem: Together | ForcesTogether, outcome: Outcome) -> Recording:
    """What was fitted, on the common axis of time, as one recording; each from where the models start."""
    names = ", ".join(one.name for one in recordings)
    notes = tuple(f"{one.name}: {note}" for one in recordings for note in one.notes)
    fitted = np.zeros(problem.t.size, dtype=bool)
    for at, one in zip(problem.places, outcome.problem.runs(outcome.refined.model), strict=True):
        fitted[at] = problem.t[at] - one.clock >= one.model.t0
    channels = {c: y[fitted] for c, y in problem.channels.items()}
    if problem.drive is not None:
        channels["u"] = problem.drive.at(problem.t[fitted])
    return replace(
        recordings[0],
        t=problem.t[fitted],
        channels=channels,
        file=names,
        sha256="",
        notes=notes,
        extra={},
        covariates={},
    )
