"""Laws of the catalogue that sum up the small effects of a control, though none of them is in it.

Three drags, each below half of the misfit, can be a quadratic drag together: who names that is not wrong about the
machine, and the answer says so beside what is counted.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from harness.core.errors import SimulationError
from harness.proof.machines.catalogue import DRY, NAMES, NEEDS
from harness.proof.machines.kinds import KINDS
from harness.proof.machines.rigs import Rig
from harness.proof.machines.shares import Reading, fitted_share, read, relative
from harness.proof.machines.small import LEAST_DRY
from harness.proof.machines.strengths import draw_strength, scaled, three_digits

TRIES = 4
"""Draws of a law's shape (a speed, a place, a frequency) of which the best counts: its strength is fitted."""
FAINT, HUGE, NEAR = 1e-6, 2.0, (0.6, 1.6)
"""What a law leaves of the motion that is nothing, that is another motion; over the goal, that is near enough."""


def summed_up(
    rig: Rig, whole: Reading, weight: Mapping[str, float], hidden: frozenset[str], rng: np.random.Generator
) -> dict[str, float]:
    """Share of the misfit of a free decay that each law which is not in it takes off when it is fitted, at least.

    whole : the recording without noise. weight : of the channels. hidden : what is in it. Laws that take nothing off
    are left out.
    """
    goal = relative(rig, whole)
    shares = {}
    for name in _possible(rig, hidden):
        parts = (_alone(rig, name, goal, rng) for _ in range(TRIES))
        found = max((fitted_share(part, whole, weight) for part in parts if part is not None), default=0.0)
        if found > 0.0:
            shares[name] = found
    return shares


def _possible(rig: Rig, hidden: frozenset[str]) -> list[str]:
    """Laws that may be claimed of such a recording: those that any machine with such a restoring force may have."""
    alike = {name for kind in KINDS.values() if kind.restoring == rig.base.restoring for name in kind.names}
    dry = rig.base.x_k >= LEAST_DRY * rig.base.length
    return [
        name
        for name in NAMES
        if name in alike - hidden and set(NEEDS.get(name, "")) <= set(rig.channels) and (dry or name not in DRY)
    ]


def _alone(rig: Rig, name: str, goal: float, rng: np.random.Generator) -> Reading | None:
    """The recording with this law alone, about as strong as leaves ``goal``; None where it leaves nothing."""
    values = draw_strength(name, rig.base, rng)
    try:
        # a law as it is drawn first may be far stronger than any machine has: its base fit goes astray, and it is left
        with np.errstate(over="ignore", invalid="ignore"):
            return _about(rig, name, values, goal)
    except (SimulationError, np.linalg.LinAlgError):
        return None


def _about(rig: Rig, name: str, values: Mapping[str, Any], goal: float) -> Reading | None:
    found = read(rig, {name: values}, quick=True)
    left = relative(rig, found)
    if FAINT < left < HUGE and not NEAR[0] < left / goal < NEAR[1]:
        found = read(rig, {name: scaled(name, values, three_digits(goal / left), rig.base)}, quick=True)
        left = relative(rig, found)
    return found if FAINT < left < HUGE else None
