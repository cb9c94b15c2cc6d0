"""Where the base model and a recording part, and the force it leaves over: both without a law for it."""

import math

import numpy as np

from harness.app.shared.places import where_of_place
from harness.core.events import Mode
from harness.diagnosis.explain.force_map import ForceMap, force_map
from harness.diagnosis.explain.locate import Place, locate
from harness.diagnosis.motion import Motion
from harness.diagnosis.outcome import Outcome
from harness.model.model import Restoring
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
    problem, model, shown = outcome.problem, outcome.base.model, outcome.base.shown
    interval, omega = float(np.median(np.diff(problem.t))), outcome.scales.omega
    sigma = {c: noise.sigma * math.sqrt(noise.inflation(omega, interval)) for c, noise in problem.noise.items()}
    stiffness = np.full(problem.t.size, 0.0 if model.restoring is Restoring.NONE else model.k / model.m)
    if model.restoring is Restoring.PENDULUM:
        stiffness *= np.cos(shown.x)
    residual = {c: y - shown.y[c] for c, y in problem.channels.items()}
    return force_map(problem.t, residual, sigma, base_motion(outcome), model.c / model.m, stiffness)
