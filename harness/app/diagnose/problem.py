"""A recording made ready to be diagnosed, or refused with the reason."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from harness.app.diagnose.checks import refuse, refuse_few, refuse_unrelated
from harness.app.diagnose.options import DiagnoseOptions
from harness.core.errors import InputError, SimulationError
from harness.core.recording import Recording
from harness.diagnosis.alignment.consistency import Consistency, consistency
from harness.diagnosis.baseline.base_fit import dominant_frequency
from harness.diagnosis.pipeline import prepare
from harness.diagnosis.prepare.driven import is_driven
from harness.diagnosis.problem import Problem
from harness.diagnosis.request import Asked


@dataclass(frozen=True, slots=True)
class Prepared:
    """A recording ready to be diagnosed.

    notes : what was done to it. warnings : what looks wrong with it. channels : what each pair says of the other.
    """

    problem: Problem
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    channels: tuple[Consistency, ...]


def prepared(recording: Recording, options: DiagnoseOptions) -> Prepared:
    """Channels with their noise, what was asked, and what the recording itself says against it.

    Raises InputError for a recording that cannot be diagnosed, and for options that do not go with it.
    """
    driven = is_driven(recording)
    if options.horizon is not None and not driven:
        accepted = "it is accepted with a driven recording"
        raise InputError("--horizon", f"given, but {recording.file} has no measured force", accepted)
    refuse(recording)
    asked = Asked(
        options.restoring, options.zero_free, options.mass, options.horizon, options.covariates, options.guarded
    )
    problem, notes = prepare(recording, asked)
    if not driven:
        refuse_few(recording.file, problem)
    omega = dominant_frequency(problem.t, next(iter(problem.channels.values())))
    channels = (
        consistency(problem.t, problem.channels, problem.noise, omega, problem.angular) if 0.0 < omega < 1e300 else ()
    )
    return Prepared(problem, notes, refuse_unrelated(recording, channels), channels)


@contextmanager
def errors_of(recording: Recording) -> Iterator[None]:
    """What could not be simulated, as an error of its recording that says what else may be asked."""
    try:
        yield
    except InputError as error:
        where = recording.file if error.where == "recording" else error.where
        raise InputError(where, error.found, error.accepted) from error
    except SimulationError as error:
        accepted = "a part of it (--from, --to), or another --restoring or --zero, may be accepted"
        raise SimulationError(f"{recording.file}: {error}; {accepted}") from error
