"""Several recordings of one machine as one: what they share, what each has of its own, and the physics left out."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from harness.app.diagnose.attribution import Configured
from harness.app.diagnose.files import simulated
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.problem import prepared_together, validation
from harness.app.diagnose.result import STEPS, Diagnosed, result_of, with_laws
from harness.app.shared.progress import SILENT, Progress
from harness.app.shared.reading import recording_info, thinned
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
from harness.estimate.repeated import repeated
from harness.model.elsewhere import named
from harness.results.common import P, RepeatedResult
from harness.results.diagnosis import OwnResult


def own_results(recordings: Sequence[Recording], outcome: Outcome) -> list[OwnResult]:
    """Start, zero, noise and errors of each recording, and in what it differs from the first."""
    problem, refined, pooled = outcome.problem, outcome.refined, outcome.pooled
    assert isinstance(problem, Together | ForcesTogether)
    assert pooled is not None
    explained = outcome.verdict in ("adequate", "missing_physics")
    length = "rad" if problem.angular else "m"
    numbers = numbers_of(refined, problem, outcome.scales.omega, explained)
    differ = differences(refined, problem, outcome.scales.omega, explained)
    first = recordings[0].file
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
            )
        )
    return found


def _of_starts(problem: Together | ForcesTogether) -> list[dict[str, float]]:
    """Standard errors of the starts of recordings that are not fitted but smoothed, by name."""
    if isinstance(problem, Together):
        return [{} for _ in problem.alone]
    firsts = [one.starts.windows[0] for one in problem.each]
    return [{"x0": w.x_sd, "v0": w.v_sd} for w in firsts]


def repeated_results(files: Sequence[str], each: Sequence[Mapping[str, Quantity]]) -> dict[str, RepeatedResult]:
    """Every number by name that two recordings or more tell with an error; files and each in the same order."""
    found = {}
    for name in dict.fromkeys(name for one in each for name in one):
        told = [(file, one[name]) for file, one in zip(files, each, strict=True) if name in one]
        known = [(f, q.value, q.stderr, q.unit) for f, q in told if q.value is not None and q.stderr is not None]
        known = [one for one in known if one[2] > 0.0]
        if len(known) < 2:
            continue
        seen = repeated([value for _, value, _, _ in known], [error for _, _, error, _ in known])
        found[name] = RepeatedResult(
            value=P(value=seen.value, stderr=seen.stderr, unit=known[0][3]),
            within=seen.within,
            between=seen.between,
            outliers=[known[i][0] for i in seen.outliers],
        )
    return found


def investigate_together(
    recordings: Sequence[Recording], options: DiagnoseOptions, progress: Progress = SILENT, command: str = ""
) -> Diagnosed:
    """Diagnose recordings of one machine, laid one behind the other.

    Raises InputError when they cannot be diagnosed together, with the reason; SimulationError.
    """
    _refuse_options(options)
    progress("base fit and search", 1, STEPS)
    recordings = [thinned(one) for one in recordings]
    ready = prepared_together(recordings, options)
    problem = ready.problem
    assert isinstance(problem, Together | ForcesTogether)
    with np.errstate(over="ignore", invalid="ignore"), listening(progress):
        outcome = conclude(problem, seconds=options.seconds)
    progress("engines", 2, STEPS)
    assert outcome.pooled is not None
    each = alone_under(outcome.refined, problem, outcome.scales, outcome.pooled.compared.alone)
    more = {
        "recordings": [recording_info(one, alone.noise) for one, alone in zip(recordings, problem.alone, strict=True)],
        "own": own_results(recordings, outcome),
        "together": repeated_results([one.file for one in recordings], [parameters_of(one) for one in each]),
    }
    laid, other = _laid(recordings, problem, outcome), validation(recordings[0], options)
    result = result_of(laid, ready, outcome, options, Configured(), other, command, **more)
    result, left = with_laws(result, outcome)
    return Diagnosed(laid, outcome, simulated(laid, outcome), result, left)


def _refuse_options(options: DiagnoseOptions) -> None:
    """Raise InputError for what belongs to one recording."""
    for name in ("model", "sim", "horizon", "covariates"):
        if getattr(options, name) not in (None, ()):
            one = "recording, whose mismatch is divided" if name in ("model", "sim") else "driven recording"
            found = f"given with --{name.removesuffix('s')}"
            raise InputError("--together", found, f"it goes with one {one}")


def _laid(recordings: Sequence[Recording], problem: Together | ForcesTogether, outcome: Outcome) -> Recording:
    """What was fitted, on the common axis of time, as one recording; each from where the models start."""
    names = ", ".join(one.file for one in recordings)
    notes = tuple(f"{one.file}: {note}" for one in recordings for note in one.notes)
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
