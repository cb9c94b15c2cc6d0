"""Which recordings a proof on real machines makes, each from the files that were given, and the effects put into it.

Effects are exact on a real recording, whatever the machine does besides. Of a free decay the sensor and the clock: what
is logged is another function of what moved. Of a driven axis a known force g(x, v, t) is added to the measured one: the
same motion, so that the machine resists by g more. g is smooth where v changes sign, since there v is known worst.

A recording has what a transcript says of it, and its samples.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import Any, Self

import numpy as np
from scipy.signal import savgol_coeffs, savgol_filter

from harness.core.arrays import FloatArray
from harness.proof.paths.files import packed
from harness.proof.plant.base import log_uniform
from harness.proof.seal import digest

_UNITS = {"x": ("m", "rad"), "v": ("m/s", "rad/s"), "a": ("m/s^2", "rad/s^2"), "u": ("N", "N*m")}
WINDOWS, ORDER, ROUGHER = (9, 17, 33, 65, 129), 3, 1.2
"""Samples of the smoothing windows, the order of their polynomials, and the rise of the residual's variance above the
least from which a window is too wide."""


@dataclass(frozen=True, slots=True)
class Rig:
    """What a transcript says of a recording, none of its samples.

    file : its name. sha256 : of its samples as ``Measured.text``. machine : files of one machine share it. channels :
    such as "xu". condition : how far its one cause is turned, None where nobody says. moves : the number ("f_k"), or
    the law ("quadratic-drag"), that grows with the condition. angular : it turns.
    """

    file: str
    sha256: str
    machine: str
    channels: str
    condition: float | None = None
    moves: str = ""
    angular: bool = False

    @property
    def driven(self) -> bool:
        return "u" in self.channels


@dataclass(frozen=True, slots=True)
class Measured:
    """Samples, SI. t : (n,). channels, covariates : (n,) each, by name. options : of harness diagnose."""

    t: FloatArray
    channels: Mapping[str, FloatArray]
    covariates: Mapping[str, FloatArray]
    angular: bool = False
    options: Mapping[str, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """The samples as CSV."""
        heads = ["t [s]", *(f"{name} [{_UNITS[name][self.angular]}]" for name in self.channels), *self.covariates]
        columns = [self.t, *self.channels.values(), *self.covariates.values()]
        rows = (",".join(f"{value:.12g}" for value in row) for row in np.column_stack(columns).tolist())
        return "\n".join([",".join(heads), *rows]) + "\n"

    def rig(self, file: str, machine: str, condition: float | None = None, moves: str = "") -> Rig:
        sha256 = digest(self.text.encode())
        return Rig(file, sha256, machine, "".join(self.channels), condition, moves, self.angular)

    def with_channels(self, t: FloatArray | None = None, **channels: FloatArray) -> Self:
        """The same with other times, or other samples of some channels."""
        return replace(self, t=self.t if t is None else t, channels={**self.channels, **channels})

    def smoothed(self) -> FloatArray:
        """x, v, a (n, 3) by local cubics over the widest window that follows x to its noise.

        No part of the diagnosis smooths so.
        """
        t, x = self.t, self.channels["x"]
        n = round((t[-1] - t[0]) / float(np.median(np.diff(t)))) + 1
        grid = np.linspace(t[0], t[-1], n)
        even = np.interp(grid, t, x)
        left = {w: _left(even, w) for w in WINDOWS if w < n}
        width = max(w for w, variance in left.items() if variance <= ROUGHER * min(left.values()))
        step = float(grid[1] - grid[0])
        found = (savgol_filter(even, width, ORDER, deriv=order, delta=step) for order in range(3))
        return np.column_stack([np.interp(t, grid, one) for one in found])


def _left(x: FloatArray, width: int) -> float:
    """Variance of what a window leaves, as it is of white noise that it does not see."""
    own = float(savgol_coeffs(width, ORDER)[width // 2])
    return float(np.var(x - savgol_filter(x, width, ORDER))) / (1.0 - own)


def rigs_of(told: Any) -> list[Rig]:
    """As a transcript has them; TypeError where it has others."""
    return [Rig(**one) for one in told]


UNTOUCHED, CONSTRUCTED, SWITCHED, REPEATED = "real-untouched", "real-constructed", "real-switched", "real-repeated"
GROUPS = (UNTOUCHED, CONSTRUCTED, SWITCHED, REPEATED)
Files = tuple[tuple[str, ...], tuple[str, ...]]
"""Before, and after; after alone of one recording."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """A recording to be made: of which group, from which files, with which effect ("" for none)."""

    group: str
    files: Files
    effect: str = ""


def wanted(rigs: Sequence[Rig], count: int, rng: np.random.Generator) -> list[Wanted]:
    """Every file as it is, ``count`` constructed effects, every two conditions of a machine, every condition in halves.

    Machines take turns, of a machine its files, and of a file its effects. Which condition comes first is chance.
    """
    machines: dict[str, list[Rig]] = {}
    for rig in sorted(rigs, key=lambda one: one.file):
        machines.setdefault(rig.machine, []).append(rig)
    found = [Wanted(UNTOUCHED, ((), (rig.file,))) for of_one in machines.values() for rig in of_one]
    able = {name: [rig for rig in of_one if effects_of(rig)] for name, of_one in machines.items()}
    order = [name for name, of_one in able.items() if of_one]
    decks: dict[str, list[tuple[str, str]]] = {}
    for number in range(count if order else 0):
        name = order[number % len(order)]
        if not decks.get(name):
            every = [(rig.file, effect) for rig in able[name] for effect in effects_of(rig)]
            decks[name] = [every[int(i)] for i in rng.permutation(len(every))]
        file, effect = decks[name].pop()
        found.append(Wanted(CONSTRUCTED, ((), (file,)), effect))
    for of_one in machines.values():
        conditions: dict[float, list[Rig]] = {}
        for rig in of_one:
            if rig.condition is not None:
                conditions.setdefault(rig.condition, []).append(rig)
        for pair in combinations(sorted(conditions), 2):
            if all(rig.moves for value in pair for rig in conditions[value]):
                first, last = (tuple(rig.file for rig in conditions[value]) for value in rng.permutation(pair).tolist())
                found.append(Wanted(SWITCHED, (first, last)))
        for alike in conditions.values():
            names = [alike[int(i)].file for i in rng.permutation(len(alike))]
            half = len(names) // 2
            if half:
                found.append(Wanted(REPEATED, (tuple(names[:half]), tuple(names[half:]))))
    return found


def made(
    seed: int, index: int, job: Wanted, rigs: Mapping[str, Rig], measured: Mapping[str, Measured]
) -> tuple[bytes, dict[str, Any]]:
    """A recording, and its answer."""
    before, after = job.files
    about: dict[str, Any] = {
        "group": job.group,
        "effect": job.effect,
        "machine": rigs[after[0]].machine,
        "files": [list(before), list(after)],
        "right": [],
        "moves": {},
        "amount": None,
        "base_chi2_excess": None,
        "base_r2": [],
    }
    parts = {file: measured[file] for file in (*before, *after)}
    if job.effect:
        effect, (file,) = EFFECTS[job.effect], after
        found = effect.put(parts[file], np.random.default_rng([seed, 6, index]))
        parts[file] = found.recording
        about |= {"right": list(effect.right), "moves": dict(effect.moves), "amount": found.amount}
        about["base_r2"] = [] if found.r2 is None else [found.r2]
    elif job.group == SWITCHED:
        (was, now), moves = (rigs[side[0]].condition or 0.0 for side in job.files), rigs[after[0]].moves
        about["moves"] = {moves: 1 if now > was else -1}
    # file names of a machine's owner tell the condition
    blind = {file: f"recording-{number}.csv" for number, file in enumerate(parts, 1)}
    options = dict(parts[after[0]].options)
    if before:
        options |= {
            "before": ",".join(blind[file] for file in before),
            "after": ",".join(blind[file] for file in after),
        }
    common = {
        "mechanisms": [*about["right"][:1], *about["moves"]],
        "source": "real",
        "setting": about["machine"],
        "channels": rigs[after[0]].channels,
        "points": sum(one.t.size for one in parts.values()),
        "arguments": [part for name, value in options.items() for part in (f"--{name}", value)],
    }
    return packed({blind[file]: one.text for file, one in parts.items()}), {**about, **common}


Rng = np.random.Generator
Force = Callable[[FloatArray, FloatArray, FloatArray, Rng], FloatArray]
"""Of t, x, v (n,): the form of g (n,), of any size."""


@dataclass(frozen=True, slots=True)
class Constructed:
    """A recording with an effect. amount : its size; of a force its rms over what the base leaves of the force, both
    beyond the base. r2 : of that base on the untouched recording, None where there is no force."""

    recording: Measured
    amount: float
    r2: float | None = None


@dataclass(frozen=True, slots=True)
class Effect:
    """right : names that tell it. moves : numbers that it moves, 1 up and -1 down; of neither nothing is to be told."""

    applies: Callable[[Rig], bool]
    put: Callable[[Measured, Rng], Constructed]
    right: tuple[str, ...] = ()
    moves: Mapping[str, int] = field(default_factory=dict)


def _gained(one: Measured, rng: Rng) -> Constructed:
    gain = log_uniform(rng, 0.03, 0.3)
    return Constructed(one.with_channels(**{c: (1.0 + gain) * y for c, y in one.channels.items()}), gain)


def _late(one: Measured, rng: Rng) -> Constructed:
    late = log_uniform(rng, 0.3, 10.0) * float(np.median(np.diff(one.t)))
    return Constructed(one.with_channels(one.t + late), late)


def _curved(one: Measured, rng: Rng) -> Constructed:
    """x + q x^2 about the middle of what was logged; the amount is the deviation at the largest x, over that x."""
    x = one.channels["x"] - np.median(one.channels["x"])
    far, bend = float(np.max(np.abs(x))), log_uniform(rng, 0.01, 0.15)
    return Constructed(
        one.with_channels(x=one.channels["x"] + float(rng.choice([-1.0, 1.0])) * bend / far * x**2), bend
    )


def _fast(one: Measured, rng: Rng) -> Constructed:
    fast = log_uniform(rng, 0.001, 0.03)
    return Constructed(one.with_channels(one.t[0] + (1.0 + fast) * (one.t - one.t[0])), fast)


def _beside(form: Force, of_base: bool = False) -> Callable[[Measured, Rng], Constructed]:
    """A force beside the measured one. of_base : it is one that the base has, so that all of it counts."""

    def put(one: Measured, rng: Rng) -> Constructed:
        (x, v, a), u = one.smoothed().T, one.channels["u"]
        slow = 0.02 * float(np.max(np.abs(v)))
        base = np.column_stack([np.ones_like(v), v, a, np.tanh(v / slow), *one.covariates.values()])

        def beyond(y: FloatArray) -> FloatArray:
            return np.asarray(y - base @ np.linalg.lstsq(base, y, rcond=None)[0])

        g, size = form(one.t - one.t[0], x - np.mean(x), v, rng), log_uniform(rng, 0.5, 10.0)
        left = float(np.std(beyond(u)))
        seen = float(np.std(g if of_base else beyond(g)))
        r2 = 1.0 - left**2 / float(np.var(u))
        return Constructed(one.with_channels(u=u + size * left / seen * g), size, r2)

    return put


def _fastest(v: FloatArray) -> float:
    """A speed that the motion reaches and a few samples alone exceed."""
    return float(np.quantile(np.abs(v), 0.98))


def _drag(t: FloatArray, x: FloatArray, v: FloatArray, rng: Rng) -> FloatArray:
    """Linear at rest, quadratic beyond a speed of its own."""
    return v * np.hypot(v, 0.1 * _fastest(v))


def _one_sided(t: FloatArray, x: FloatArray, v: FloatArray, rng: Rng) -> FloatArray:
    return float(rng.choice([-1.0, 1.0])) * np.hypot(v, 0.05 * _fastest(v))


def _ripple(t: FloatArray, x: FloatArray, v: FloatArray, rng: Rng) -> FloatArray:
    turns = 2.0 * math.pi * log_uniform(rng, 3.0, 15.0) / float(np.ptp(x))
    phase = rng.uniform(0.0, 6.3)
    return np.asarray(np.cos(turns * x + phase) + 0.2 * np.cos(2.0 * (turns * x + phase)))


def _hum(t: FloatArray, x: FloatArray, v: FloatArray, rng: Rng) -> FloatArray:
    """A line between those of the motion and half the rate of sampling."""
    turned = np.count_nonzero(np.diff(np.signbit(x - np.mean(x)))) / (2.0 * t[-1])
    rate = 0.5 / float(np.median(np.diff(t)))
    omega = 2.0 * math.pi * min(log_uniform(rng, 3.3, 30.0) * max(turned, 2.0 / t[-1]), 0.3 * rate)
    return np.asarray(np.sin(omega * t + rng.uniform(0.0, 6.3)))


def _decays(rig: Rig) -> bool:
    return not rig.driven


def _drives(rig: Rig) -> bool:
    return rig.driven and "x" in rig.channels


EFFECTS: Mapping[str, Effect] = {
    # an angle in wrong units swings otherwise: a pendulum's period tells its amplitude
    "gain of the sensor": Effect(lambda rig: _decays(rig) and not (rig.angular and "x" in rig.channels), _gained,
                                 moves={"x_k": 1}),
    "late by a delay": Effect(_decays, _late),
    "x + q x^2": Effect(lambda rig: _decays(rig) and "x" in rig.channels, _curved, ("sensor-curvature",)),
    "a clock that runs fast": Effect(_decays, _fast, moves={"omega_n": -1}),
    "drag": Effect(_drives, _beside(_drag), ("quadratic-drag", "power-law-damping")),
    "one-sided damping": Effect(_drives, _beside(_one_sided), ("asymmetric-viscous",)),
    "ripple along the way": Effect(_drives, _beside(_ripple), ("force-ripple",)),
    "hum": Effect(_drives, _beside(_hum), ("harmonic-force",)),
    "damping": Effect(_drives, _beside(lambda t, x, v, rng: v, of_base=True), moves={"c": 1}),
}  # fmt: skip
"""By a name in words."""


def effects_of(rig: Rig) -> list[str]:
    """Those that are exact on a recording."""
    return [name for name, effect in EFFECTS.items() if effect.applies(rig)]
