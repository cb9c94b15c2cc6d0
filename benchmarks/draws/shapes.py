"""A free decay whose sensor has a shape of its own: a curved scale of x, or gravity in a. Position, or both, recorded.

A curve is 1 to 10 % at the end of the way, gravity's part 3 to 90 % of the acceleration; put on by their formulas.
"""

import math

import numpy as np

import harness
from benchmarks.draws.shared import Answer, log_uniform
from harness.core.errors import HarnessError
from harness.core.recording import Recording
from harness.kernels.solve import solve
from harness.model.model import Model

CURVATURE, GRAVITY = "sensor-curvature", "sensor-gravity"


def drawn(seed: int, number: int) -> tuple[Recording, str, float]:
    """A recording, what its sensor does, and by how much; every other one gravity's."""
    r = np.random.default_rng([seed, number])
    hidden = GRAVITY if number % 2 else CURVATURE
    w, size = 2.0 * math.pi * log_uniform(r, 0.4, 4.0), log_uniform(r, 0.02, 1.0)
    zeta, cycles, held = log_uniform(r, 0.002, 0.02), r.uniform(8.0, 25.0), log_uniform(r, 0.002, 0.02)
    held = min(held, 0.2 / cycles)
    t = np.linspace(0.0, cycles * 2.0 * math.pi / w, int(cycles * r.uniform(25.0, 80.0)))
    shown = solve(Model(1.0, 2.0 * zeta * w, w * w, held * size * w * w, x0=size), t, want_a=True)
    x, a = shown.x, shown.a
    side = float(r.choice([-1.0, 1.0]))
    if hidden == CURVATURE:
        much = side * log_uniform(r, 0.01, 0.1) / size
        x = x + much * x**2
    else:
        much = side * log_uniform(r, 0.03, 0.9) * w * w
        a = a + much * x
    channels = {"x": x + size * log_uniform(r, 3e-4, 3e-3) * r.standard_normal(t.size)}
    if hidden == GRAVITY or r.random() < 0.5:
        channels["a"] = a + size * w * w * log_uniform(r, 2e-3, 1e-2) * r.standard_normal(t.size)
    return Recording(t, channels, hidden), hidden, much


def answer(seed: int, number: int) -> Answer:
    """Right where it is named, or listed among three at most."""
    recording, hidden, much = drawn(seed, number)
    told = f"{hidden} {much:.3g} in {''.join(recording.channels)}"
    try:
        found = harness.diagnose(recording, engines=(), zero="spring" if number % 4 < 2 else None)
    except HarnessError as error:
        return Answer(False, f"{told}: {error}")
    listed = [m for m in found.mechanisms if m.grade not in ("minor", "tabulated")]
    names = [m.name for m in listed]
    off = ""
    for m in listed:
        if m.name == hidden:
            (p,) = m.parameters.values()
            off = f", off by {((p.value or math.nan) - much) / (p.stderr or math.nan):.1f} errors"
    right = hidden in names and len(names) <= 3
    near = [[a.name for a in m.alternatives] for m in listed]
    return Answer(right, f"{told}: {found.verdict} {names} beside {near}{off}")
