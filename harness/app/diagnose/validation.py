"""Both models of a diagnosis on another recording, with nothing fitted but its start."""

from dataclasses import dataclass, replace
from pathlib import Path

from harness.app.diagnose.options import DiagnoseOptions, Zero
from harness.app.diagnose.problem import prepared
from harness.app.shared.reading import read
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.alignment.match import as_kind_of
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.kinds.known import kind_of
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.prepare.driven import is_driven
from harness.model.model import Restoring
from harness.results.diagnosis import ForceError, ValidationResult


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
    other = options.validate
    if isinstance(other, Path):
        other = read(other, options.reading, options.trace)
    if is_driven(other) != is_driven(recording):
        kinds = ("a free decay", "a driven recording")
        found = f"{kinds[is_driven(other)]}, {other.file}"
        raise InputError("--validate", found, f"{kinds[is_driven(recording)]} is accepted, as {recording.file} is")
    other = as_kind_of(other, recording, "--validate")
    # the published protocol knows no covariates
    judged = is_driven(other) and not options.covariates
    return Validation(other, Judge.of(recording, other) if judged else None)


def validated(found: Validation, outcome: Outcome, options: DiagnoseOptions) -> ValidationResult:
    """Both models on the other recording, held as the first one was. Raises InputError, SimulationError."""
    first, models = outcome.problem, (outcome.base.model, outcome.refined.model)
    zero: Zero | None = "spring" if first.restoring is Restoring.SPRING else None
    held = replace(options, restoring=first.restoring, zero="free" if first.zero_free else zero)
    problem = prepared(found.recording, held).problem
    before, after = kind_of(problem).tried(problem, models, outcome.scales)
    force = None
    if found.judge is not None:
        errors = found.judge.compared(*models)
        force = ForceError.taken_from(errors, refined_with_ripple=errors.refitted)
    return ValidationResult(
        file=found.recording.file, baseline_rmse=dict(before), refined_rmse=dict(after), force_rel_error=force
    )
