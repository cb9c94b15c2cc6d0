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
from harness.diagnosis.problem import Problem
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


def held_alike(options: DiagnoseOptions, problem: Problem) -> DiagnoseOptions:
    """The options with the restoring force and the zero that the first recording was diagnosed with."""
    spring = problem.restoring is Restoring.SPRING
    zero: Zero | None = "free" if problem.zero_free else ("spring" if spring else None)
    return replace(options, restoring=problem.restoring, zero=zero)


def validated(found: Validation, outcome: Outcome, options: DiagnoseOptions) -> ValidationResult:
    """Both models on the other recording. Raises InputError, SimulationError."""
    ready = prepared(found.recording, held_alike(options, outcome.problem))
    problem = ready.problem
    base, refined = outcome.base.model, outcome.refined.model
    force = None
    before, after = kind_of(problem).tried(problem, (base, refined), outcome.scales)
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
