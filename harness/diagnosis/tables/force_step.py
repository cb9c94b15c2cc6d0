"""What has no name gets a model where a force is fitted: the last step of such a diagnosis."""

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace

from harness.core.errors import SimulationError
from harness.diagnosis.explain.by_force import remainder_of
from harness.diagnosis.explain.graded import prediction
from harness.diagnosis.fit.observe import Observation
from harness.diagnosis.grading.prediction import Predicted, ratio
from harness.diagnosis.inverse_dynamics.force_fit import ForceFit, as_fit, simulated
from harness.diagnosis.inverse_dynamics.force_screen import seen_in
from harness.diagnosis.inverse_dynamics.grade import ForceGraded
from harness.diagnosis.inverse_dynamics.holdout import predicted_windows
from harness.diagnosis.outcome import Holdout, Outcome
from harness.diagnosis.problems.inverse_dynamics import InverseDynamics
from harness.diagnosis.rules import TABLE_OVER_NOISE
from harness.diagnosis.tables.drawn import Drawn
from harness.diagnosis.tables.fitted import TableFit
from harness.diagnosis.tables.force_tables import ForceLeft
from harness.diagnosis.tables.selection import Tabulated, improves
from harness.diagnosis.tables.told import RULES, Modelled, told


def with_force_tables(outcome: Outcome, graded: ForceGraded) -> Outcome:
    """The outcome with tables of the force that no name says, where they predict; as it is where none does."""
    left, problem = outcome.remainder, outcome.problem
    if left is None or left.over_noise <= TABLE_OVER_NOISE.value or not isinstance(problem, InverseDynamics):
        return outcome
    main = outcome.verdict == "main_effect"
    # in the place of what was kept without a headline, or on top of it
    starts = [graded.best] if main or graded.best is graded.base else [graded.base, graded.best]
    for start in starts:
        seen = ForceLeft.of(start, graded.measured, graded.counted, outcome.scales)
        before = seen.predicted()
        kept = () if before is None else seen.tabulated(before)
        # what was listed, or is a small part, is a model too
        rival = None if graded.best is start else seen.predicted(graded.best)
        if before is not None and kept and (rival is None or improves(kept[0].held, rival)):
            windows = _windows(kept[0].fit, seen, problem)
            # what cannot follow the motion, or misses more of it than the base model does, is no model of it
            if not _follows(windows, outcome.holdout):
                continue
            with suppress(SimulationError):
                shown = simulated(_by_force(kept[0].fit, seen), problem, outcome.scales)
                return _told(outcome, graded, seen, before, kept, problem, shown, windows)
    return replace(outcome, rules=(*outcome.rules, *RULES))


def _windows(found: TableFit, seen: ForceLeft, problem: InverseDynamics) -> dict[str, float] | None:
    """Rmse by channel over windows that tables took no part in."""
    return predicted_windows(problem, lambda part: seen.over(found, part.moving[seen.measured.moving]), seen.scales)


def _follows(windows: Mapping[str, float] | None, held: Holdout) -> bool:
    """Whether no channel is missed by more than by the base model."""
    before = held.baseline_rmse
    return windows is None or all(size <= before.get(channel, math.inf) for channel, size in windows.items())


def _told(
    outcome: Outcome,
    graded: ForceGraded,
    seen: ForceLeft,
    before: Predicted,
    kept: tuple[Tabulated, ...],
    problem: InverseDynamics,
    shown: Observation,
    windows: Mapping[str, float] | None,
) -> Outcome:
    """The outcome with the best of the tables that stay; before : what is missed without one. shown : with it."""
    first, start, measured = kept[0], seen.start, graded.measured
    found, scales = first.fit, outcome.scales
    after = _by_force(found, seen)
    refined = as_fit(after, problem, measured, graded.reference, shown)
    held, evidence = ratio(first.held, before), seen_in(start, measured, problem, scales)
    independent = graded.reference.memory.independent
    gained = start.bic(independent) - after.bic(independent) - found.effective * math.log(independent)
    base_held = before if start is graded.base else seen.predicted(graded.base)
    holdout = outcome.holdout
    if windows is not None:
        holdout = replace(holdout, refined_rmse=windows) if holdout.spans else holdout
    return told(
        outcome,
        Modelled(
            kept=kept,
            refined=refined,
            drawn=Drawn.of(first, start.model, problem, seen.words.pieces, scales, held, evidence),
            share=min(max((start.squares - after.squares) / graded.excess, 0.0), 1.0),
            gained=gained,
            doubt=_doubt(seen),
            predicted=prediction(base_held, first.held),
            holdout=holdout if windows is not None else Holdout.none("refined"),
            remainder=remainder_of(replace(graded, best=after)),
        ),
    )


def _by_force(found: TableFit, seen: ForceLeft) -> ForceFit:
    """The fit by its base parameters, in newtons; its partials are what the tables cannot take over."""
    b = len(found.free)
    by = found.beside(found.jacobian[:, :b], found.jacobian[:, b:])
    residual = found.residual / seen.weight
    return ForceFit(found.model, found.free, residual, by / seen.weight, seen.measured.begins)


def _doubt(seen: ForceLeft) -> str:
    """A path that repeats itself shows a place at one phase of the drive alone."""
    if seen.words.period is None:
        return ""
    return f"or it keeps time with the drive, which repeats itself every {seen.words.period:.3g} s"
