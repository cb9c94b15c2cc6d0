"""Both models of a diagnosis on another recording, with nothing fitted but its start."""

from dataclasses import dataclass, replace

from harness.app.diagnose_options import DiagnoseOptions
from harness.app.diagnose_problem import prepared
from harness.app.reading import read
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.baseline import baseline
from harness.diagnosis.driven.validate import Judge, window_rmse
from harness.diagnosis.fit import fit
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.parameters import free_of
from harness.diagnosis.prepare import is_driven
from harness.diagnosis.rmse import rmse
from harness.model.model import Model
from harness.results.diagnosis import ForceError, ValidationResult

_STARTS = ("x0", "v0")


@dataclass(frozen=True, slots=True)
class Validation:
    """The other recording; judge : of force errors, where both are driven and the published protocol suits them."""

    recording: Recording
    judge: Judge | None


def validation(recording: Recording, options: DiagnoseOptions) -> Validation | None:
    """The recording of --validate, read as the first one was; None without the option.

    Raises InputError when it cannot be read, or is driven where the first is not.
    """
    if options.validate is None:
        return None
    other = read(options.validate, options.reading, options.trace)
    if is_driven(other) != is_driven(recording):
        kinds = ("a free decay", "a driven recording")
        found = f"{kinds[is_driven(other)]}, {options.validate}"
        raise InputError("--validate", found, f"{kinds[is_driven(recording)]} is accepted, as {recording.file} is")
    return Validation(other, Judge.of(recording, other) if is_driven(other) else None)


def validated(found: Validation, outcome: Outcome, options: DiagnoseOptions) -> ValidationResult:
    """Both models on the other recording. Raises InputError, SimulationError."""
    ready = prepared(found.recording, options)
    problem = ready.problem
    base, refined = outcome.base.model, outcome.refined.model
    force = None
    if problem.restarts is not None:
        before, after = (window_rmse(model, problem, outcome.scales) for model in (base, refined))
    else:
        own, scales = baseline(problem)

        def started(model: Model) -> dict[str, float]:
            """Only where and how fast it starts belongs to the other recording."""
            here = replace(model, x0=own.model.x0, v0=own.model.v0, t0=own.model.t0, offset=own.model.offset)
            free = tuple(f for f in free_of(here, _STARTS) if f.name in _STARTS)
            return rmse(fit(here, problem, free, scales).shown.y, problem)

        before, after = started(base), started(refined)
    if found.judge is not None:
        errors = found.judge.compared(base, refined)
        force = ForceError(
            fit_baseline=errors.fit_baseline,
            fit_refined=errors.fit_refined,
            baseline=errors.baseline,
            refined=errors.refined,
            refined_with_ripple=errors.refitted,
        )
    return ValidationResult(
        file=found.recording.file, baseline_rmse=dict(before), refined_rmse=dict(after), force_rel_error=force
    )
