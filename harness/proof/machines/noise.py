"""What the sensors add: white, coloured or quantised noise as large as goes with the misfit, and times that jitter."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.proof.machines.rigs import Rig
from harness.proof.machines.sealed import Sealed
from harness.proof.machines.shares import Reading, size
from harness.proof.plant.base import log_uniform
from harness.proof.plant.sensors import Noise

OVER = (1.5, 20.0)
"""What the base leaves, over the noise."""
FORCE_NOISE = 0.005
"""The largest noise of a measured force over its rms; three in ten have none."""


@dataclass(frozen=True, slots=True)
class Spoiled:
    """Noise of a recording. style : "white", "coloured" or "quantised". noise : what is added.

    total : standard deviation of all that is not the machine, jittered times included, by channel.
    """

    style: str
    noise: Noise
    total: Mapping[str, float]

    def spoil(self, clean: Mapping[str, FloatArray], rng: np.random.Generator) -> dict[str, FloatArray]:
        """The channels as recorded."""
        return {c: self.noise.spoil(c, clean[c], rng) for c in self.noise.sigma}


def draw_noise(rig: Rig, whole: Reading, rng: np.random.Generator, sealed: Sealed | None = None) -> Spoiled:
    """Noise of a machine with this misfit. sealed : the answer of this very machine, which says how large it is."""
    sigma, step = {}, {}
    late = float(np.std(rig.t - rig.stamps))
    jittered = {c: late * float(np.sqrt(np.mean(np.gradient(y, rig.t) ** 2))) for c, y in whole.clean.items()}
    style = str(rng.choice(["white", "coloured", "quantised"], p=[0.35, 0.25, 0.4]))
    for c in rig.channels:
        # a driven axis has a fine encoder; of a decay the noise is a part of what the base leaves
        part = log_uniform(rng, *rig.kind.resolution)
        if not rig.kind.driven:
            left = math.sqrt(whole.misfit[c]) / size(rig, whole, c)
            part = left / log_uniform(rng, *OVER) if left > 1e-4 else part
        sigma[c] = float(f"{part * size(rig, whole, c):.3g}")
        if sealed is not None and not rig.kind.driven:
            sigma[c] = sealed.sigma(c, sigma[c], jittered[c])
        if style == "quantised" and c == "x":
            # most of the error is the rounding, as of an encoder
            step[c] = math.sqrt(12.0) * sigma[c] * float(rng.uniform(0.8, 0.97))
            sigma[c] = math.sqrt(sigma[c] ** 2 - step[c] ** 2 / 12.0)
    if rig.kind.driven:
        share = 0.0 if rng.random() < 0.3 else float(rng.uniform(0.0, FORCE_NOISE))
        sigma["u"] = share * size(rig, whole, "u")
    correlation = float(rng.uniform(0.3, 0.85)) if style == "coloured" else 0.0
    noise = Noise(sigma, correlation, step or None)
    return Spoiled(style, noise, {c: math.hypot(noise.total(c), jittered[c]) for c in sigma})
