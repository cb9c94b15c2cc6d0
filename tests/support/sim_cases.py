"""A recording and the user's simulation of it, constructed: wrong parameters, a missing term, both, compensation."""

from dataclasses import dataclass, replace

import numpy as np

from harness.core.recording import Recording
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.estimate.noise import Noise
from harness.kernels.solve import Scales, simulate, solve
from harness.model.model import Model, ModelTerm

KINDS = ("parameters", "term", "both", "compensated", "waiting")


@dataclass(frozen=True, slots=True)
class SimCase:
    """kind : of KINDS. true : the recording's model. user : the simulation's. recorded, trace : of 5 to 9 cycles."""

    kind: str
    true: Model
    user: Model
    recorded: Problem
    trace: Recording
    scales: Scales


def sim_case(seed: int) -> SimCase:
    """One case, drawn by its number; a recording of x with noise of a thousandth, a trace that is exact."""
    random = np.random.default_rng([2026, seed])
    kind = KINDS[seed % len(KINDS)]
    omega, x0 = float(random.uniform(4.0, 30.0)), float(random.uniform(0.05, 2.0))
    loss = x0 * omega
    zeta, dry = random.uniform(0.004, 0.02), random.uniform(0.002, 0.012)
    c, f_k = 2.0 * zeta * omega, dry * omega**2 * x0
    drag = ModelTerm.named("quadratic-drag", c2=float(random.uniform(0.02, 0.08) / x0))
    cubic = ModelTerm.named("cubic-stiffness", k3=float(random.uniform(0.03, 0.15) * (omega / x0) ** 2))
    term = drag if kind == "compensated" or random.random() < 0.5 else cubic
    true = Model(1.0, float(c), omega**2, float(f_k), x0=x0, terms=(term,), mass_known=False)
    wrong = replace(
        true, c=float(c * random.uniform(0.4, 2.0)), f_k=float(f_k * random.uniform(0.5, 1.8)),
        k=float(omega**2 * random.uniform(0.97, 1.03)),
    )  # fmt: skip
    users = {
        "parameters": wrong,
        "term": true.with_terms(),
        "both": wrong.with_terms(),
        "waiting": wrong.with_terms(),
        # what the drag takes in a cycle at a share of the amplitude is put into the damper
        "compensated": replace(true, c=float(c + random.uniform(0.2, 0.8) * drag.values[0] * 0.85 * loss), terms=()),
    }
    user = users[kind]
    period = 2.0 * np.pi / omega
    span = float(random.uniform(5.0, 9.0)) * period
    t = np.arange(0.0, span, period / 120.0)
    sigma = 1e-3 * x0
    x = solve(true, t).x + sigma * random.standard_normal(t.size)
    recorded = FreeDecay(t, {"x": x}, {"x": Noise(sigma, True)})
    wait = float(random.uniform(0.3, 0.9)) * period if kind == "waiting" else 0.0
    ticks = np.arange(0.0, span + wait, period / 400.0)
    trace = Recording(ticks + float(random.uniform(-5.0, 5.0)), {"x": simulate(replace(user, t0=wait), ticks).x}, "sim")
    return SimCase(kind, true, user, recorded, trace, Scales(x0, loss, omega))
