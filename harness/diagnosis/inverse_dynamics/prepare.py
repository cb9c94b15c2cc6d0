"""What a force needs before it is fitted: a mass that can be simulated, how it acts between samples, several as one.

What is left out may look like a mass, so that the law which says the force best is asked beside the base model. Whether
a force is held between samples the force itself tells where a servo makes the slider stick often: a simulation from one
start then hangs on every stick, and a torque that is right to its noise lets it stray.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.core.recording import Recording
from harness.diagnosis.covariates.following import enter
from harness.diagnosis.covariates.values import Acting, values_in
from harness.diagnosis.fit.standard_errors import base_parameters, unit_of
from harness.diagnosis.inverse_dynamics.search import force_baseline, moving, nearest, unseen_mass
from harness.diagnosis.prepare.driven import forced_problem
from harness.diagnosis.prepare.free_decay import in_common
from harness.diagnosis.prepare.intersample import ACTS_HELD, held
from harness.diagnosis.problems.forces_together import ForcesTogether
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.measured import BLOCK
from harness.diagnosis.request import Asked, AskedCovariate
from harness.diagnosis.rules import MASS_UNSEEN
from harness.model.covariate import Covariate
from harness.model.model import Restoring

_HELD = 0.9
"""Ratio of squares: what a law leaves is coloured, and chance alone moves that of a few hundred words by a tenth."""


def as_it_acts(problem: InverseDynamics, u: FloatArray) -> tuple[InverseDynamics, tuple[str, ...]]:
    """The problem with its force u (n,) held, and a sentence that says so, where less of it is left so.

    Beside the law that says most of it: what is missing leaves more than what a force does between two samples.
    Raises SimulationError where little moves.
    """
    stepped = replace(problem, drive=held(problem.t, u))
    if _left(stepped) < _HELD * _left(problem):
        return stepped, (ACTS_HELD,)
    return problem, ()


def _left(problem: InverseDynamics) -> float:
    """Sum of squares of the force that is left, N^2."""
    return float(np.sum((problem.rows["u"] - nearest(problem).shown.y["u"]) ** 2))


def with_covariates(
    problem: InverseDynamics, recording: Recording, asked: tuple[AskedCovariate, ...]
) -> InverseDynamics:
    """The problem with its covariates, and the rough base model with each where it enters best.

    Raises InputError for one that is no column, hardly varies, or follows from the base model and time.
    """
    acting = tuple(Acting.of(one, recording) for one in asked)
    problem = replace(problem, covariates=values_in(asked, recording), acting=acting)
    base, scales = force_baseline(problem)
    found = enter(base, problem, scales)
    first = replace(problem.first, covariates=found.fit.model.covariates)
    return replace(problem, first=first, enters=found.said, acting=found.acting)


def with_unseen_mass(problem: InverseDynamics) -> InverseDynamics:
    """The problem with its mass given where the fitted one accelerates with less force than any fit could tell.

    Without this the fit of a slow axis ends at no mass at all, and its motion cannot be simulated; nor where a law that
    is missing pulls the other way than the mass, whose value beside that law is taken then. Raises SimulationError when
    little moves or the base model cannot be fitted.
    """
    if not problem.mass_names:
        return problem
    (base, scales), best = force_baseline(problem), nearest(problem)
    mass = unseen_mass(best, problem)
    if mass == 0.0:
        return problem
    of, unit = "inertia" if problem.angular else "mass", unit_of("kg", problem)
    if best.model.m < mass:
        why = f"The force does not show the {of}"
        how = f"whose force is {100.0 * MASS_UNSEEN.value:.2g} % of what the fit leaves"
    else:
        with suppress(SimulationError):
            moving(base, problem, scales)
            return problem
        if not best.model.terms:
            return problem
        mass, law = best.model.m, best.model.terms[-1].term.name
        why, how = f"Without {law} the fitted {of} is too small to be simulated", "the value fitted with it"
    # a robot's model says what moves, and its joint takes no --mass
    another = "" if problem.guarded else "; --mass KG sets another"
    said = f"{why}: {mass:.3g} {unit} is taken, {how}{another}."
    first = replace(base.model, m=mass)
    return replace(problem, mass=mass, first=first, enters=(*problem.enters, said))


_UNTOLD = "taken as 0, as motion and time say what the column does,"
_BY_FORCE = "driven, several: the force of all is fitted at once, whether or not the motion of each could be followed"


def forces_together(recordings: Sequence[Recording], asked: Asked) -> tuple[ForcesTogether, tuple[str, ...]]:
    """Driven recordings as one problem, and what was done to each, one sentence each.

    On a spring each has a zero of its own, unless that is given. What covariates do is the same law in all. Raises
    InputError for fewer than two, for free decays among them, for those that have no channel in common or hardly move;
    SimulationError.
    """
    common = in_common(recordings)
    spring = (asked.restoring or Restoring.SPRING) is not Restoring.NONE
    # smoothing rounds off reversals, of which each recording has its own share
    alike = replace(asked, guarded=True, zero_free=spring if asked.zero_free is None else asked.zero_free)
    values_in(asked.covariates, *recordings)
    notes, each = [_BY_FORCE], list[InverseDynamics]()
    for one in recordings:
        problem, done = _alone(one, alike, common)
        each.append(problem)
        notes += [f"in {one.file}: {note}" for note in done]
        left_out = [c for c in ("x", "v", "a") if c in one and c not in common]
        notes += [f"in {one.file}: {c} is not used: not every recording has it" for c in left_out]
    acting, entered = _as_in_all(each, recordings, asked.covariates)
    for i, one in enumerate(recordings):
        try:
            given = replace(each[i], first=replace(each[i].first, covariates=acting))
            each[i], said = as_it_acts(given, one["u"][: given.t.size])
        except SimulationError as error:
            accepted = "recordings in which the slider moves most of the time"
            raise InputError(one.file, str(error), accepted) from error
        notes += [f"in {one.file}: {note}" for note in said]
    laid = ForcesTogether.laid(each)
    if acting:
        fitted = tuple(replace(one, known=one.gain == 0.0) for one in laid.first.covariates)
        laid = replace(laid, first=replace(laid.first, covariates=fitted), enters=entered)
    known = with_unseen_mass(laid)
    if known.mass is not None and known.mass != laid.mass:
        laid = laid.with_mass(known.mass, known.first, known.enters)
    return laid, tuple(notes)


def _alone(recording: Recording, asked: Asked, common: Sequence[str]) -> tuple[InverseDynamics, tuple[str, ...]]:
    seen = {c: y for c, y in recording.channels.items() if c in (*common, "u")}
    problem, notes = forced_problem(replace(recording, channels=seen), asked)
    problem = replace(problem, covariates={one.name: recording.covariates[one.name] for one in asked.covariates})
    # whole blocks, so that none reaches over the seam
    return problem.part(slice(0, problem.t.size // BLOCK * BLOCK)), notes


def _as_in_all(
    each: Sequence[InverseDynamics], recordings: Sequence[Recording], asked: tuple[AskedCovariate, ...]
) -> tuple[tuple[Covariate, ...], tuple[str, ...]]:
    """What covariates do in all recordings alike, whatever else is each one's own, and a sentence on each.

    Between conditions a pressure differs by more than it varies in one: that tells its gain where the motion itself
    presses the air.
    """
    if not asked:
        return (), ()
    laid = ForcesTogether.laid(each)
    laid = laid.with_own((*laid.mass_names, *laid.physics))
    base, scales = force_baseline(laid)
    found = enter(base, replace(laid, acting=tuple(Acting.of(one, *recordings) for one in asked)), scales)
    numbers = base_parameters(found.fit, laid, scales.omega, explained=False)
    acting = found.fit.model.covariates
    said = tuple(
        f"{line} {one.parameter} is {numbers.get(one.parameter, _UNTOLD)} in all recordings."
        for line, one in zip(found.said, acting, strict=True)
    )
    return tuple(replace(one, known=True) for one in acting), said
