"""Whether the model that was found is good enough to change a simulation by."""

import math

from harness.diagnosis.grading.prediction import free_run, ratio
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.rules import ADVISED

_NOTHING = "No parameter or term is advised to be changed:"


def unadvised(outcome: Outcome) -> str | None:
    """Why nothing is to be changed by the refined model, one sentence; None where it serves.

    It must leave noise, or be the main effect with the remainder said beside it; its numbers must be the recording's
    and no bound's; and run freely it must miss less than the base model does.
    """
    if outcome.verdict == "adequate":
        return None
    refined, left = outcome.refined, outcome.chi2_per_point(outcome.refined)
    if left is not None and left >= ADVISED.value and outcome.verdict != "main_effect":
        return f"{_NOTHING} the best model found leaves {math.sqrt(left):.3g} times the noise itself."
    held = [f.name for f, v in zip(refined.free, refined.values, strict=True) if v <= f.lower or v >= f.upper]
    if held:
        return (
            f"{_NOTHING} in the best model found {' and '.join(held)} ended on a"
            " bound, so that other numbers stand in for it."
        )
    if not _runs_better(outcome):
        return (
            f"{_NOTHING} fitted to the first part of the recording, the best model found misses as much of the rest as"
            " the base model."
        )
    return None


def left_beside(outcome: Outcome) -> str | None:
    """What a reader of advice is to know of the model behind it; None where that leaves noise alone."""
    left = outcome.chi2_per_point(outcome.refined)
    if left is None or left < ADVISED.value:
        return None
    return (
        f"These numbers are of a model that leaves {math.sqrt(left):.3g} times the noise: what it lacks is in them too."
    )


def _runs_better(outcome: Outcome) -> bool:
    """Whether the last part of a recording, predicted from the first, is missed by less than the base model misses."""
    forward = outcome.mechanisms[0].forward if outcome.mechanisms else None
    if forward is not None:
        pairs = [(forward.refined_rmse[c], before) for c, before in forward.baseline_rmse.items()]
        return math.prod(after / before for after, before in pairs if before > 0.0) < 1.0
    if not outcome.problem.starts.names:
        # windows each begin as recorded: there is no free run, and what was held out has been predicted already
        return True
    base, refined = (free_run(f, outcome.problem, outcome.scales) for f in (outcome.base, outcome.refined))
    return base is None or refined is None or ratio(refined, base) < 1.0
