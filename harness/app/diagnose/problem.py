"""A recording made ready to be diagnosed, or refused with the reason.

Sizes of a free decay that are rather those of another unit are asked, with the --columns that would say so. And another
recording, on which both models are tried with nothing fitted but its start.
"""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from harness.app.diagnose.options import DiagnoseOptions, Zero
from harness.app.shared.columns import in_unit, mapping, refuse_misread
from harness.app.shared.reading import read
from harness.core.errors import InputError, SimulationError
from harness.core.recording import Recording
from harness.diagnosis.alignment.consistency import Consistency, consistency
from harness.diagnosis.alignment.match import as_kind_of
from harness.diagnosis.baseline.base_fit import dominant_frequency
from harness.diagnosis.inverse_dynamics.validate import Judge
from harness.diagnosis.kinds.known import kind_of
from harness.diagnosis.moves.classify import classify
from harness.diagnosis.moves.kinds import MotionKind, Moves
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.pipeline import prepare, prepare_together
from harness.diagnosis.prepare.driven import is_driven
from harness.diagnosis.problem import Problem
from harness.diagnosis.request import Asked
from harness.model.model import Restoring
from harness.results.diagnosis import ForceError, ValidationResult

_RAIL, _RAILS = 0.15, 0.6
"""Share of the samples at each end of a saturated channel's range, and at both together."""
_FEW_LEVELS = 5
"""Values through which a channel goes at most, where those are its sensor's steps about a level; two are two rails."""
_SUSPECT = 1.1
"""Ratio of one channel to the derivative of another from which it is told: calibrations are better than a tenth."""


@dataclass(frozen=True, slots=True)
class Prepared:
    """A recording ready to be diagnosed; of several, the first. moves : what it holds.

    notes : what was done to it. warnings : what looks wrong with it. channels : what each pair says of the other.
    """

    problem: Problem
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    channels: tuple[Consistency, ...]
    recording: Recording
    moves: Moves


def prepared(recording: Recording, options: DiagnoseOptions) -> Prepared:
    """Channels with their noise, what was asked, and what the recording itself says against it.

    Raises InputError for a recording that cannot be diagnosed, and for options that do not go with it.
    """
    if options.horizon is not None and not is_driven(recording):
        accepted = "it goes with a driven recording"
        raise InputError("--horizon", f"given, but {recording.file} has no measured force", accepted)
    _refuse(recording)
    given = [name for name in ("model", "sim", "validate", "horizon") if getattr(options, name) is not None]
    if recording.steady and given:
        found = f"given with {recording.file}, a table of speeds and forces without a time"
        raise InputError(f"--{given[0]}", found, "it goes with a recording of a motion")
    asked = Asked(
        options.restoring, options.zero_free, options.mass, options.horizon, options.covariates, options.guarded
    )
    moves = classify(recording, asked.restoring)
    moves.refuse(recording.file)
    recording, chosen = moves.part(recording)
    problem, notes = prepare(recording, asked, moves)
    channels, warnings = _channels(recording, problem)
    warnings = (*(warnings or implausible(recording, problem, moves)), *([moves.wanted] if moves.wanted else []))
    return Prepared(problem, (*chosen, *notes), warnings, channels, recording, moves)


def prepared_together(recordings: Sequence[Recording], options: DiagnoseOptions) -> Prepared:
    """As ``prepared``, recordings of one machine; the channels are those of the first that has two."""
    for one in recordings:
        _refuse(one)
    asked = Asked(
        options.restoring, options.zero_free, options.mass, covariates=options.covariates, guarded=options.guarded
    )
    problem, notes = prepare_together(recordings, asked)
    all_moves = [classify(one, asked.restoring) for one in recordings]
    for one, moves in zip(recordings, all_moves, strict=True):
        moves.refuse(one.file)
    each = [_channels(one, alone) for one, alone in zip(recordings, problem.alone, strict=True)]
    warnings = [f"{one.name}: {line}" for one, (_, said) in zip(recordings, each, strict=True) for line in said]
    channels = next((channels for channels, _ in each if channels), ())
    return Prepared(problem, notes, tuple(warnings), channels, recordings[0], all_moves[0])


def _refuse(recording: Recording) -> None:
    """Raise InputError for channels that hold no motion, or units that exclude each other."""
    for name in ("x", "v", "a"):
        if name not in recording:
            continue
        y = recording[name]
        low, high = float(np.mean(y == y.min())), float(np.mean(y == y.max()))
        if min(low, high) > _RAIL and low + high > _RAILS:
            if 2 < (levels := np.unique(y)).size <= _FEW_LEVELS:
                found = f"{levels.size} values in all, {np.diff(levels).min():.3g} apart: its sensor's steps"
                raise InputError(f"{recording.file}: channel {name}", found, "a motion through many of them")
            share = f"{100.0 * (low + high):.0f} % of its samples at {y.min():.4g} or {y.max():.4g}"
            accepted = "a channel mostly within its range"
            raise InputError(f"{recording.file}: channel {name}", f"saturated throughout ({share})", accepted)
    given = {c: recording.units[c] for c in ("x", "a") if recording.units.get(c)}
    angles = {"rad" in unit or "deg" in unit or "°" in unit for unit in given.values()}
    if len(angles) == 2:
        found = f"x in {given['x']} with a in {given['a']}, which cannot belong together"
        raise InputError(recording.file, found, "both as angles or both as lengths")


def _channels(recording: Recording, problem: Problem) -> tuple[tuple[Consistency, ...], tuple[str, ...]]:
    """What each pair of channels says of the other, and sentences on units and scales that look wrong.

    Raises InputError for channels that are not of one motion.
    """
    y = next(iter(problem.channels.values()))
    omega = dominant_frequency(problem.t, y) if problem.scales is None else problem.scales.omega
    if not 0.0 < omega < 1e300:
        return (), ()
    channels = consistency(problem.t, problem.channels, problem.noise, omega, problem.angular)
    refuse_misread(recording, channels)
    said = []
    for one in channels:
        gain = one.gain.value
        if gain is not None and not one.consistent and max(gain, 1.0 / gain) > _SUSPECT:
            said.append(one.sentence)
    return channels, tuple(said)


@contextmanager
def errors_of(recording: Recording) -> Iterator[None]:
    """What could not be simulated, as an error of its recording that says what else may be asked."""
    try:
        yield
    except InputError as error:
        where = recording.file if error.where == "recording" else error.where
        raise InputError(where, error.found, error.accepted) from error
    except SimulationError as error:
        accepted = "a part of it that can (--from, --to), or another --restoring or --zero"
        raise SimulationError(f"{recording.file}: {error}; expected {accepted}") from error


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
        raise InputError("--validate", found, f"{kinds[is_driven(recording)]}, as {recording.file} is")
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


_FASTEST = 100.0
"""m/s, which no slider that swings reaches: what does was read in m and is in mm, or in ms and is in s."""
_SLOWEST = 100.0
"""s of a swing, which a slider on a spring hardly takes."""


def implausible(recording: Recording, problem: Problem, moves: Moves) -> tuple[str, ...]:
    """Questions on what swings too far, too fast or too slowly for its units; none of what is no free decay."""
    decays = (MotionKind.FREE_DECAY, MotionKind.SEVERAL_DECAYS)
    if moves.kind not in decays or "x" not in problem.channels:
        return ()
    x = problem.channels["x"]
    far, omega = 0.5 * float(np.ptp(x)), dominant_frequency(problem.t, x)
    period = 2.0 * math.pi / omega if omega > 0.0 else 0.0
    said = []
    if problem.angular and far > 2.0 * math.pi:
        turns = far / (2.0 * math.pi)
        said.append(
            f"x swings {far:.3g} rad to each side, {turns:.2g} turns: is it in deg?{_as(recording, 'x', 'deg')}"
        )
    if not problem.angular and far * omega > _FASTEST:
        found = f"x swings {far:.2g} m each way in {period:.2g} s, at up to {far * omega:.2g} m/s"
        likelier = ("t", "s") if period < 0.01 and recording.units.get("t", "s") != "s" else ("x", "mm")
        said.append(f"{found}: is {likelier[0]} in {likelier[1]}?{_as(recording, *likelier)}")
    if period > _SLOWEST:
        said.append(f"one swing takes {period:.2g} s: is t in ms?{_as(recording, 't', 'ms')}")
    return tuple(said)


def _as(recording: Recording, channel: str, unit: str) -> str:
    """What reads a channel in another unit; "" where nobody told from which columns it came."""
    if channel not in recording.columns:
        return ""
    return f' Try: --columns "{mapping(in_unit(recording.columns, channel, unit))}"'
