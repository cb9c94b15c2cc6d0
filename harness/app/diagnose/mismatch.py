"""Where the base model and a recording part, and the force it leaves over: both without a law for it."""

from harness.app.shared.parts import where_of_place
from harness.core.events import Mode
from harness.diagnosis.explain.force_map import ForceMap
from harness.diagnosis.explain.locate import Place, locate
from harness.diagnosis.kinds.known import kind_of
from harness.diagnosis.motion import Motion
from harness.diagnosis.outcome import Outcome
from harness.results.common import Where

_EVERYWHERE = "no part of the motion stands out"


def base_motion(outcome: Outcome) -> Motion:
    """The base model's own motion."""
    shown = outcome.base.shown
    return Motion(shown.x, shown.v, shown.mode == Mode.STICK, outcome.scales.omega)


def places(outcome: Outcome) -> list[Where]:
    """Up to three places that hold the base model's mismatch; the whole, where there is one that lies nowhere apart."""
    problem = outcome.problem
    n = problem.t.size
    residuals = {c: outcome.base.residual[i * n : (i + 1) * n] for i, c in enumerate(problem.channels)}
    found = locate(residuals, problem.t, base_motion(outcome), unit="rad" if problem.angular else "m")
    if not found and outcome.verdict != "adequate":
        found = (Place(((float(problem.t[0]), float(problem.t[-1])),), "throughout", _EVERYWHERE, 1.0, 0.0),)
    return [where_of_place(place) for place in found]


def left_over(outcome: Outcome) -> ForceMap:
    """The force that the base model leaves over, per unit mass."""
    return kind_of(outcome.problem).left_over(outcome.problem, outcome.base, outcome.scales)
