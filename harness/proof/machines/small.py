"""Small effects beside the main one: which, how strong, and what each makes of the misfit alone."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness.proof.machines.catalogue import DRY, NEEDS, STATIC, UNKNOWN, compatible
from harness.proof.machines.rigs import Effects, Rig
from harness.proof.machines.shares import Reading, read, relative
from harness.proof.machines.strengths import draw_strength, scaled, three_digits
from harness.proof.plant.base import Base

MOST_FACTOR = 10.0
"""How much stronger than at first an effect is made at most: one that hardly shows stays so."""
MOST_PART = 0.4
"""Part of the misfit that a small effect is meant to have at most."""
NOT_SMALL = (
    *("constant-force", "pendulum-stiffness", "sensor-clipping"),
    *("static-friction", "end-stop", "backlash", "presliding"),
)
"""Effects that have no strength to make small, or are not there at all when they are."""
NOT_SMALL_DRIVEN = (*NOT_SMALL, "sensor-lag")
LEAST_DRY = 0.004
"""Friction, as x_k over the amplitude, below which laws of it are nothing."""


def _others(rig: Rig, main: str, count: int, rng: np.random.Generator) -> list[str]:
    """Names of small effects that this machine may have besides."""
    none = NOT_SMALL_DRIVEN if rig.kind.driven else NOT_SMALL
    own = [n for n in rig.kind.names if n not in none]
    outside = [n for n in (*UNKNOWN, *STATIC) if rig.kind.restoring == "spring" or "stiffness" not in n]
    possible = [n for n in (*own, *outside) if set(NEEDS.get(n, "")) <= set(rig.channels)]
    if rig.base.x_k < LEAST_DRY * rig.base.length:
        possible = [n for n in possible if n not in DRY]
    chosen: list[str] = []
    for place in rng.permutation(len(possible)):
        name = possible[int(place)]
        if all(compatible(name, other) for other in (main, *chosen)):
            chosen.append(name)
        if len(chosen) == count:
            break
    return chosen


@dataclass(frozen=True, slots=True)
class Small:
    """Small effects with what the base leaves of each alone, mean squares by channel.

    What they leave at a strength near by is in proportion.
    """

    effects: Effects
    left: Mapping[str, Mapping[str, float]]

    def times(self, factors: Mapping[str, float], base: Base) -> "Small":
        """Each stronger by its factor."""
        effects = {name: scaled(name, one, factors[name], base) for name, one in self.effects.items()}
        left = {name: {c: m * factors[name] ** 2 for c, m in one.items()} for name, one in self.left.items()}
        return Small(effects, left)

    def shares(self, whole: Reading, weight: Mapping[str, float]) -> dict[str, float]:
        """Part of the whole misfit that each makes alone."""
        total = sum(w * whole.misfit[c] for c, w in weight.items())
        return {name: sum(w * one[c] for c, w in weight.items()) / total for name, one in self.left.items()}


def draw_small(
    rig: Rig, main: str, goal: float, count: int, rng: np.random.Generator
) -> tuple[Small, dict[str, Reading]]:
    """Small effects that together make the base leave about ``goal``, and the recordings they were first seen in."""
    names = _others(rig, main, count, rng)
    effects, alone = {}, {}
    for name in names:
        values = draw_strength(name, rig.base, rng)
        found = read(rig, {name: values}, quick=True)
        if 1e-6 < relative(rig, found) < 2.0:
            effects[name], alone[name] = values, found
    parts = np.minimum(rng.dirichlet(np.full(max(len(effects), 1), 1.5)), MOST_PART)
    for name, part in zip(tuple(effects), parts, strict=False):
        factor = three_digits(min(goal * math.sqrt(part) / relative(rig, alone[name]), MOST_FACTOR))
        effects[name] = scaled(name, effects[name], factor, rig.base)
        alone[name] = read(rig, {name: effects[name]}, quick=True)
    return Small(effects, {name: one.misfit for name, one in alone.items()}), alone
