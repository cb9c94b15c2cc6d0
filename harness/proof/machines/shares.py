"""What part of the misfit an effect makes: base fits of the recording with all effects, without one, with one alone."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.proof.machines.kinds import CLAIMED
from harness.proof.machines.rigs import Effects, Rig
from harness.proof.plant.base import Base
from harness.proof.plant.base_fit import BaseFit
from harness.proof.plant.effects import DRY, EFFECTS, OF_MACHINES, STATIC, UNKNOWN, compatible
from harness.proof.plant.integrate import PlantRun
from harness.proof.plant.strengths import DRAWS, scaled, three_digits


@dataclass(frozen=True, slots=True)
class Reading:
    """A noise-free recording with its base fit. run : the true motion. clean : by channel, shape (n,)."""

    run: PlantRun
    clean: Mapping[str, FloatArray]
    fit: BaseFit

    @property
    def misfit(self) -> dict[str, float]:
        """Mean square that the base leaves in each channel."""
        return {c: float(np.mean(r**2)) for c, r in self.fit.left.items()}


def read(rig: Rig, effects: Effects, quick: bool = False) -> Reading:
    """The recording of a machine with these effects, computed at a fixed step if ``quick``; raises SimulationError."""
    run, clean = rig.motion(effects, quick)
    return Reading(run, clean, rig.base_fit(run, clean, quick=quick))


def refitted(rig: Rig, reading: Reading, weight: Mapping[str, float]) -> Reading:
    """The same with a base fit in which channels have these weights; one channel has none."""
    if rig.kind.driven or len(rig.channels) == 1:
        return reading
    return replace(reading, fit=rig.base_fit(reading.run, reading.clean, weight))


def size(rig: Rig, reading: Reading, channel: str) -> float:
    """The size of a channel, to which misfits are relative."""
    return float(np.std(reading.clean["u"])) if channel == "u" else rig.scale(channel)


def relative(rig: Rig, reading: Reading) -> float:
    """Root mean square that the base leaves, relative to the size of the channel in which that is most."""
    return float(np.sqrt(max(m / size(rig, reading, c) ** 2 for c, m in reading.misfit.items())))


def weights(of: Reading, noise: Mapping[str, float]) -> dict[str, float]:
    """Weight of each channel: by what the base leaves in it, noise and all."""
    return {c: 1.0 / max(m + noise[c] ** 2, 1e-300) for c, m in of.misfit.items()}


def total(misfit: Mapping[str, float], weight: Mapping[str, float]) -> float:
    return sum(w * misfit[c] for c, w in weight.items())


def ratio(part: Reading, whole: Reading, weight: Mapping[str, float]) -> float:
    """Misfit of one recording over that of another."""
    return total(part.misfit, weight) / total(whole.misfit, weight)


def fitted_share(part: Reading, whole: Reading, weight: Mapping[str, float]) -> float:
    """Share of the misfit that an effect takes off when its strength is fitted beside the base, to first order.

    part : the effect alone, whose misfit is the one more column of the linear problem. What the base's own parameters
    would still take off, where its fit ended before its minimum, is nobody's share.
    """
    root = {c: math.sqrt(w) for c, w in weight.items()}
    design = np.vstack([one * whole.fit.slopes[c] for c, one in root.items()])
    column = np.concatenate([one * part.fit.left[c] for c, one in root.items()])
    target = np.concatenate([one * whole.fit.left[c] for c, one in root.items()])
    return 1.0 - _rest(np.column_stack([design, column]), target) / _rest(design, target)


def _rest(design: FloatArray, target: FloatArray) -> float:
    """Sum of squares that the columns of ``design`` (N, p) leave of ``target`` (N,)."""
    length = np.sqrt(np.sum(design**2, axis=0))
    length[length == 0.0] = 1.0
    rest = target - design @ (np.linalg.lstsq(design / length, target, rcond=1e-10)[0] / length)
    return float(rest @ rest)


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
    possible = [name for name in (*own, *outside) if _shows(rig, name)]
    chosen: list[str] = []
    for place in rng.permutation(len(possible)):
        name = possible[int(place)]
        if all(compatible(name, other) for other in (main, *chosen)):
            chosen.append(name)
        if len(chosen) == count:
            break
    return chosen


def _shows(rig: Rig, name: str) -> bool:
    """Whether its channels are recorded and, of a law of dry friction, there is some."""
    dry = rig.base.x_k >= LEAST_DRY * rig.base.length
    return set(EFFECTS[name].needs) <= set(rig.channels) and (dry or name not in DRY)


@dataclass(frozen=True, slots=True)
class Small:
    """Small effects with what the base leaves of each alone, mean squares by channel.

    What they leave at a strength near by is in proportion.
    """

    effects: Effects
    left: Mapping[str, Mapping[str, float]]

    def times(self, factor: float, base: Base) -> "Small":
        effects = {name: scaled(name, one, factor, base) for name, one in self.effects.items()}
        left = {name: {c: m * factor**2 for c, m in one.items()} for name, one in self.left.items()}
        return Small(effects, left)

    def shares(self, whole: Reading, weight: Mapping[str, float]) -> dict[str, float]:
        """Part of the whole misfit that each makes alone."""
        return {name: total(one, weight) / total(whole.misfit, weight) for name, one in self.left.items()}


def draw_small(
    rig: Rig, main: str, goal: float, count: int, rng: np.random.Generator
) -> tuple[Small, dict[str, Reading]]:
    """Small effects that together make the base leave about ``goal``, and the recordings they were first seen in."""
    names = _others(rig, main, count, rng)
    effects, alone = {}, {}
    for name in names:
        values = DRAWS[name](rig.base, rng)
        found = read(rig, {name: values}, quick=True)
        if 1e-6 < relative(rig, found) < 2.0:
            effects[name], alone[name] = values, found
    parts = np.minimum(rng.dirichlet(np.full(max(len(effects), 1), 1.5)), MOST_PART)
    for name, part in zip(tuple(effects), parts, strict=False):
        factor = three_digits(min(goal * math.sqrt(part) / relative(rig, alone[name]), MOST_FACTOR))
        effects[name] = scaled(name, effects[name], factor, rig.base)
        alone[name] = read(rig, {name: effects[name]}, quick=True)
    return Small(effects, {name: one.misfit for name, one in alone.items()}), alone


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
    for name in OF_MACHINES:
        if name not in CLAIMED[rig.base.restoring] - hidden or not _shows(rig, name):
            continue
        parts = (_alone(rig, name, goal, rng) for _ in range(TRIES))
        found = max((fitted_share(part, whole, weight) for part in parts if part is not None), default=0.0)
        if found > 0.0:
            shares[name] = found
    return shares


def _alone(rig: Rig, name: str, goal: float, rng: np.random.Generator) -> Reading | None:
    """The recording with this law alone, about as strong as leaves ``goal``; None where it leaves nothing."""
    values = DRAWS[name](rig.base, rng)
    try:
        # a law as it is drawn first may be far stronger than any machine has: its base fit goes astray, and it is left
        with np.errstate(over="ignore", invalid="ignore"):
            found = about(rig, name, values, goal)
            return found[1] if found is not None and FAINT < relative(rig, found[1]) < HUGE else None
    except (SimulationError, np.linalg.LinAlgError):
        return None


def about(rig: Rig, name: str, values: Mapping[str, Any], goal: float) -> tuple[Mapping[str, Any], Reading] | None:
    """An effect as strong as makes the base leave about ``goal`` alone, if it can, with the recording of it alone.

    None where it leaves nothing, or makes another motion of it.
    """
    found = read(rig, {name: values}, quick=True)
    left = relative(rig, found)
    if not FAINT < left < HUGE:
        return None
    if not NEAR[0] < left / goal < NEAR[1]:
        values = scaled(name, values, three_digits(goal / left), rig.base)
        found = read(rig, {name: values}, quick=True)
    return values, found
