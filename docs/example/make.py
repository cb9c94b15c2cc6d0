"""The example recording: a slider on a spring with a sail, as a rig's logger writes it; python docs/example/make.py.

A draw wire reads the position in steps of 0.02 mm, an accelerometer the acceleration in g; the logger starts half a
second before the slider is let go and loses a few samples.
"""

from pathlib import Path

import numpy as np

from harness import api
from harness.io.units import STANDARD_GRAVITY

RATE, BEFORE, LENGTH = 250.0, 0.5, 6.0
STEP_MM, NOISE_MM, NOISE_G = 0.02, 0.03, 0.004
RIG = {
    "schema": "harness.model/1",
    "base": {"m": 1.0, "c": 0.24, "k": 144.0, "f_k": 0.12},
    "release": {"x0": 0.040},
    "terms": [{"name": "quadratic-drag", "parameters": {"c2": 1.5}}],
    "mass_known": False,
}


def table() -> str:
    """The recording as CSV: t [s], x [mm], a [g]."""
    t = np.arange(0.0, BEFORE + LENGTH, 1.0 / RATE)
    chance = np.random.default_rng(2)
    moving = t >= BEFORE
    motion = api.simulate(RIG, t[moving] - BEFORE)
    x, a = np.full(t.size, 40.0), np.zeros(t.size)
    x[moving], a[moving] = 1e3 * motion.x, motion.a / STANDARD_GRAVITY
    x = np.round((x + chance.normal(0.0, NOISE_MM, t.size)) / STEP_MM) * STEP_MM
    a += chance.normal(0.0, NOISE_G, t.size)
    kept = chance.random(t.size) > 0.002
    lines = [f"{row[0]:.3f},{row[1]:.2f},{row[2]:.4f}" for row in np.column_stack((t, x, a))[kept]]
    return "\n".join(("t [s],x [mm],a [g]", *lines)) + "\n"


if __name__ == "__main__":
    Path(__file__).with_name("rig.csv").write_text(table(), encoding="utf-8")
