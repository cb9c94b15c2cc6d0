"""A recording of a machine: one main effect among small ones, small ones alone, or one of no catalogue.

Fits set how strong its effects are, how large its noise is, and whether a draw is taken. On another processor one may
end elsewhere: another recording of the same seed. With what was sealed in place of these (``Sealed``) it is the same to
rounding, or it does not follow from the seed. Of 600 machines that another processor drew, nine had another strength
(by 1.7 % in the median, by a factor of 1.9 at most), two another noise, and one was not taken; a third processor made
one small effect of them 2.02 times as strong. Where a strength lies further away than twice, the machine with what was
sealed has to meet all that a draw must.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.proof.machines.kinds import Kind
from harness.proof.machines.rigs import Effects, Rig, draw_rig
from harness.proof.machines.shares import (
    MOST_FACTOR,
    Reading,
    Small,
    about,
    draw_small,
    fitted_share,
    ratio,
    read,
    refitted,
    relative,
    size,
    summed_up,
    weights,
)
from harness.proof.plant.base import Base, log_uniform
from harness.proof.plant.effects import STATIC, UNKNOWN, Values
from harness.proof.plant.hidden import Noise
from harness.proof.plant.strengths import DRAWS, scaled, three_digits

MOST_MOVED = 2.0
"""Factor within which a strength, or a noise, is the same on two processors: no more is asked of it."""
SAME = 1e-6
"""Relative difference that another processor may make in every other number."""


@dataclass(frozen=True, slots=True)
class Sealed:
    """What a sealed answer says that fits decide. noise : standard deviation by channel, jittered times included."""

    effects: Effects
    noise: Mapping[str, float]

    @classmethod
    def of(cls, answer: Mapping[str, Any]) -> Self:
        """From an answer; InputError where it is not one of a machine."""
        effects, noise = answer.get("plant"), answer.get("noise")
        parts = [effects, noise, *(effects.values() if isinstance(effects, dict) else ())]
        if not all(isinstance(part, dict) for part in parts):
            raise InputError("answer", "no effects and noise of a machine", "those of a sealed answer")
        assert isinstance(effects, dict)
        assert isinstance(noise, dict)
        return cls(effects, noise)

    def holds(self, effects: Effects, base: Base, most: float = MOST_FACTOR) -> bool:
        """Whether these are its effects, but for how strong they are. most : factor between strengths, at most."""
        return effects.keys() == self.effects.keys() and all(
            _is_same(name, effects[name], self.effects[name], base, most) for name in effects
        )

    def in_place_of(self, effects: Effects) -> Effects:
        """Its effects, in the order of those that came out."""
        return {name: dict(self.effects[name]) for name in effects}

    def sigma(self, channel: str, own: float, late: float) -> float:
        """Standard deviation of what is added to a channel, to three digits as it was drawn; own where it is another.

        late : what jittered times add to the channel.
        """
        total = self.noise.get(channel)
        if not isinstance(total, int | float) or not late <= total:
            return own
        said = math.sqrt(total**2 - late**2)
        return float(f"{said:.3g}") if own / MOST_MOVED <= said <= own * MOST_MOVED else own


def _is_same(name: str, own: Values, sealed: Values, base: Base, most: float) -> bool:
    """Whether each number lies where it may: that of a strength between weaker and stronger, any other where it is."""
    if own.keys() != sealed.keys():
        return False
    weak, strong = (scaled(name, own, factor, base) for factor in (1.0 / most, most))
    for key, said in sealed.items():
        reach = (own[key], *((weak[key], strong[key]) if weak[key] != strong[key] else ()))
        low, high = min(reach), max(reach)
        if not isinstance(said, int | float) or not low - SAME * abs(low) <= said <= high + SAME * abs(high):
            return False
    return True


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


SHARES = (0.6, 0.99)
"""Band of the share of a main effect."""
TABLE_SHARES = (0.8, 0.97)
"""The same where it is a static law of no catalogue."""
SMALL = 0.5
"""Share that no effect of a control has alone."""
TOGETHER = 0.5
"""Least sum of those shares: else what is left comes of how the effects act together, and none of them is small."""
MISFIT = (0.003, 0.03)
CONTROL_MISFIT = (0.001, 0.01)
FORCE_MISFIT = (0.01, 0.2)
"""What the base leaves, relative to the motion or, of a measured force, to the force."""
LEAST_MISFIT, MOST_MISFIT = 5e-4, 0.08
MOST_TRIES = 60
MOST_PASSED = 2
"""Draws that are passed over where the sealed one is looked for: another processor took none of them."""
TURNS = 3
"""Times the small effects are weighed against the main one, the last on the true motion."""
LEAST_TURNS = 5
"""Reversals of a free decay: a release and five of them are three cycles."""
BARE = 0.15
"""Share of controls without any effect."""


@dataclass(frozen=True, slots=True)
class Messy:
    """A recording with its answer.

    main : name of the main effect, "" in a control. effects : every effect with its parameters, SI.
    whole : what is read without noise. weight : of the channels, by what the base leaves in each.
    share : of the misfit beyond noise that goes with the main effect. small : share of each other effect alone.
    fitted : of a control, share that each effect takes off when it is fitted, a drawn gain among them. summed : the
    same of laws of the catalogue that are not in it.
    recorded : t, the channels with their zero, u; SI, shape (n,) each.
    """

    rig: Rig
    main: str
    effects: Effects
    whole: Reading
    weight: Mapping[str, float]
    noise: Spoiled
    share: float | None
    small: Mapping[str, float]
    fitted: Mapping[str, float]
    recorded: Mapping[str, FloatArray] = field(default_factory=dict)
    summed: Mapping[str, float] = field(default_factory=dict)


def draw(kind: Kind, main: str, rng: np.random.Generator, sealed: Sealed | None = None) -> Messy:
    """A random recording of a machine. main : an effect of the catalogue or of none, or "" for a control.

    sealed : what its answer says that fits decide; the first draw of such a machine is the one, where no more than
    ``MOST_PASSED`` that would be taken come before it. Raises InputError for an effect that this machine cannot have,
    SimulationError when no draw came out.
    """
    possible = (*kind.names, *UNKNOWN, *STATIC)
    if main and main not in possible:
        raise InputError("effect", main, f"one of {', '.join(possible)} on a {kind.name}")
    bare = not main and rng.random() < BARE
    passed = 0
    for _ in range(MOST_TRIES):
        try:
            rig = draw_rig(kind, main, rng)
            # an effect as it is drawn first may be far stronger than any machine has; it is then left
            with np.errstate(over="ignore", invalid="ignore"):
                found = _with_main(rig, main, rng, sealed) if main else _control(rig, bare, rng, sealed)
        except SimulationError:
            continue
        if found is None:
            continue
        if sealed is None or found.effects == sealed.effects:
            clean = found.whole.clean
            shifted = {**clean, "x": clean["x"] + rig.zero}
            return replace(found, recorded={"t": rig.stamps, **found.noise.spoil(shifted, rng)})
        passed += 1
        if passed > MOST_PASSED:
            break
    raise SimulationError(f"machines: no draw of {main or 'control'} on a {kind.name} in {MOST_TRIES} tries")


def _goal(rig: Rig, control: bool, rng: np.random.Generator) -> float:
    if rig.kind.driven:
        return log_uniform(rng, *FORCE_MISFIT) * (0.3 if control else 1.0)
    return log_uniform(rng, *(CONTROL_MISFIT if control else MISFIT))


def _with_main(rig: Rig, main: str, rng: np.random.Generator, sealed: Sealed | None = None) -> Messy | None:
    low, high = TABLE_SHARES if main in STATIC else SHARES
    share = float(rng.uniform(low + 0.02, high - 0.005))
    goal = _goal(rig, False, rng)
    made = about(rig, main, DRAWS[main](rig.base, rng), goal)
    if made is None or not LEAST_MISFIT < relative(rig, made[1]) < (0.5 if rig.kind.driven else MOST_MISFIT):
        return None
    values, alone = made
    count = int(rng.integers(1, 3 if _slow(rig) else 5))
    small, _ = draw_small(rig, main, relative(rig, alone) * math.sqrt((1.0 - share) / share), count, rng)
    for turn in range(TURNS):
        # strengths are tried quickly, and what they came to is measured on the true motion
        quick = turn < TURNS - 1
        effects: Effects = {main: values, **small.effects}
        known = None if quick else _answer(sealed, effects, rig)
        bound = known is not None and known.holds(effects, rig.base, MOST_MOVED)
        if known is not None:
            effects = known.in_place_of(effects)
            small = small if bound else _at(rig, small, effects)
        others = {name: one for name, one in effects.items() if name != main}
        whole, rest = read(rig, effects, quick), read(rig, others, quick)
        noise = draw_noise(rig, whole, rng, known)
        weight = weights(whole, noise.total)
        if not quick:
            whole, rest = refitted(rig, whole, weight), refitted(rig, rest, weight)
        found = 1.0 - ratio(rest, whole, weight)
        if quick and not (low + 0.01 <= found <= high - 0.003):
            if not small.effects or not -3.0 < found < 1.0:
                return None
            factor = three_digits(math.sqrt((1.0 - share) / (1.0 - found)))
            small = small.times(factor, rig.base)
    shares = small.shares(whole, weight)
    taken = low <= found <= high and all(one <= SMALL for one in shares.values())
    if taken and not rig.kind.driven:
        # what does not swing is no free decay; what its own law does not take off is not what the base lacks most
        v = whole.run.v
        turns = np.count_nonzero(np.diff(np.sign(v[v != 0.0])))
        taken = bool(turns >= LEAST_TURNS) and fitted_share(alone, whole, weight) >= low
    if not (taken or bound):
        return None
    return Messy(rig, main, effects, whole, weight, noise, found, shares, {})


def _control(rig: Rig, bare: bool, rng: np.random.Generator, sealed: Sealed | None = None) -> Messy | None:
    if bare:
        whole = read(rig, {})
        noise = draw_noise(rig, whole, rng, _answer(sealed, {}, rig))
        weight = weights(whole, noise.total)
        return Messy(rig, "", {}, whole, weight, noise, None, {}, _by_gain(rig, {}, whole, weight))
    goal = _goal(rig, True, rng)
    small, alone = draw_small(rig, "", goal, int(rng.integers(2, 4 if _slow(rig) else 6)), rng)
    if len(small.effects) < 2:
        return None
    known, effects = _answer(sealed, small.effects, rig), small.effects
    bound = known is not None and known.holds(effects, rig.base, MOST_MOVED)
    for quick in (True, False):
        if known is not None and not (quick and bound):
            effects = known.in_place_of(effects)
            small = small if bound else _at(rig, small, effects)
        whole = read(rig, effects, quick)
        noise = draw_noise(rig, whole, rng, None if quick else known)
        weight = weights(whole, noise.total)
        shares = small.shares(whole, weight)
        small_ones = max(shares.values()) <= SMALL and sum(shares.values()) >= TOGETHER
        if not bound and not (small_ones and relative(rig, whole) >= 0.3 * goal):
            return None
    fitted = _by_gain(rig, effects, whole, weight)
    if not rig.kind.driven:
        fitted |= {name: fitted_share(one, whole, weight) for name, one in alone.items()}
    return Messy(rig, "", effects, whole, weight, noise, None, shares, fitted)


def _answer(sealed: Sealed | None, effects: Effects, rig: Rig) -> Sealed | None:
    """The answer, if it is that of a machine with these effects."""
    return sealed if sealed is not None and sealed.holds(effects, rig.base) else None


def _at(rig: Rig, small: Small, effects: Effects) -> Small:
    """Small effects as strong as they are among these."""
    own = {name: effects[name] for name in small.effects}
    return Small(own, {name: read(rig, {name: one}, quick=True).misfit for name, one in own.items()})


def with_sums(case: Messy, rng: np.random.Generator) -> Messy:
    """A control of a free decay with the laws that sum it up, most of the time that it takes; others as they are."""
    if case.main or not case.effects or case.rig.kind.driven:
        return case
    return replace(case, summed=summed_up(case.rig, case.whole, case.weight, frozenset(case.effects), rng))


def _by_gain(rig: Rig, effects: Effects, whole: Reading, weight: Mapping[str, float]) -> dict[str, float]:
    """Share of the misfit of a control that its acceleration's drawn gain makes: who says that gain is right."""
    if not rig.gain:
        return {}
    return {"sensor-gain": 1.0 - ratio(read(replace(rig, gain={}), effects), whole, weight)}


def _slow(rig: Rig) -> bool:
    """Whether its motion takes long to compute: then there are fewer small effects."""
    return rig.kind.driven or rig.kind.cycles[1] > 30.0
