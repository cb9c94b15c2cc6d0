"""Random cases: a slider, what is hidden in it, what was recorded; concealed and decidable, or drawn again.

What the decrement of a decay says at a glance is the check that nothing looks wrong to somebody who trusts it. Turning
points of position obey X' = q X - (1 + q) x_k, the largest accelerations of successive half-cycles, taken just before
the reversals, A' = q A - 2 q omega_n^2 x_k (magnitudes; q = exp(-pi zeta/sqrt(1 - zeta^2))).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from io import StringIO
from itertools import pairwise
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.proof.plant.base import Base, draw_axis, draw_decay, draw_driven, log_uniform
from harness.proof.plant.base_fit import BaseFit, Seen, fit_decay, fit_simulated, whiten
from harness.proof.plant.effects import BENCH, EFFECTS, FAMILY, compatible
from harness.proof.plant.hidden import Motion, Noise, build, regions
from harness.proof.plant.integrate import simulate
from harness.proof.plant.strengths import DRAWS

CONCEALED = 0.98
DECIDABLE, PART_DECIDABLE = 100.0, 60.0
BEYOND_DOUBT = 20.0
"""Times the bound from which a loss is not looked at closer: a second fit was never seen to lower one tenfold."""

MOST_TRIES = 200
SETTINGS = ("decay", "driven", "axis", "axis-unit-mass", "pendulum")
FROM_REST = ("presliding", "viscoelastic", "attached-mode", "sensor-lag", "alien-rattle", "sensor-clipping")
"""Kinds with states inside, or of whom the first sample tells: released from rest."""
ARGUMENTS = {
    "spring": (),
    "pendulum": ("--restoring", "pendulum", "--zero", "free"),
    "none": ("--restoring", "none"),
}
"""What a user who knows his machine would tell the diagnosis: how it is held, never what is hidden."""


@dataclass(frozen=True, slots=True)
class Case:
    """One recording with its answer.

    effects : what is hidden, with its parameters, SI. channels : "x", "a" or "xa".
    recorded : t and the channels, shape (n,) each (and u when driven). region : spans in s, or None.
    base : parameters of the slider. noise : total standard deviation by channel (both channels, recorded or not).
    source : what made the motion. Losses of chi-square are those found, exact where they are near their bounds.
    """

    effects: Mapping[str, Mapping[str, Any]]
    channels: str
    recorded: Mapping[str, FloatArray]
    clean: Mapping[str, FloatArray]
    base: Base
    noise: Noise
    setting: str
    region: list[list[float]] | None
    source: str = "plant"
    base_chi2_excess: float = math.nan
    base_r2: tuple[float, ...] = ()
    part_chi2_excess: Mapping[str, float] = field(default_factory=dict)

    @property
    def mechanisms(self) -> tuple[str, ...]:
        return tuple(self.effects)

    @property
    def seen(self) -> Seen:
        channels = {c: self.recorded[c] for c in self.channels}
        return Seen(channels, {c: self.noise.total(c) for c in self.channels}, self.noise.correlation)


def _base(rng: np.random.Generator, setting: str, kinds: tuple[str, ...]) -> Base:
    if setting == "driven":
        return draw_driven(rng)
    if setting in ("axis", "axis-unit-mass"):
        return draw_axis(rng, unit_mass=setting == "axis-unit-mass")
    at_rest = any(kind in FROM_REST for kind in kinds)
    if setting == "pendulum":
        return draw_decay(rng, at_rest=at_rest, restoring="pendulum", length=float(rng.uniform(0.1, 1.2)))
    # one that swings is as large as makes its sine show
    length = log_uniform(rng, 0.08, 0.7) if "pendulum-stiffness" in kinds else None
    return draw_decay(rng, at_rest=at_rest, length=length)


def _channels(rng: np.random.Generator, setting: str, kinds: tuple[str, ...]) -> str:
    needed = set("".join(BENCH[kind].needs for kind in kinds)) | ({"x"} if setting != "decay" else set())
    channels = ""
    while not channels or not needed <= set(channels):
        channels = str(rng.choice(["x", "a", "xa"], p=[0.3, 0.25, 0.45]))
    return channels


def _noise(rng: np.random.Generator, base: Base, style: str) -> Noise:
    sigma = {
        "x": base.length * log_uniform(rng, 0.0005, 0.006),
        "a": base.length * base.omega_n**2 * log_uniform(rng, 0.002, 0.017),
    }
    if style == "mixed":
        style = str(rng.choice(["white", "coloured", "quantised"], p=[0.6, 0.2, 0.2]))
    if style == "coloured":
        return Noise(sigma, correlation=float(rng.uniform(0.2, 0.8)))
    if style == "quantised":
        return Noise(sigma, step={"x": sigma["x"] * float(rng.uniform(1.0, 4.0))})
    if style != "white":
        raise InputError("noise", style, "white, coloured, quantised or mixed")
    return Noise(sigma)


def draw(
    kind: str | tuple[str, ...], rng: np.random.Generator, *, setting: str = "decay", noise: str = "white"
) -> Case:
    """A random case of a kind: a name of the catalogue, an alien, "control", or a pair of names.

    setting : how it is recorded; static friction is driven whatever is said. noise : white, coloured, quantised, mixed.
    Raises InputError for a name that is not one, SimulationError when no draw was concealed and decidable.
    """
    kinds: tuple[str, ...] = () if kind == "control" else (kind,) if isinstance(kind, str) else tuple(kind)
    unknown = [name for name in kinds if name not in BENCH]
    if unknown:
        raise InputError("kind", unknown[0], f"control or one of {', '.join(BENCH)}")
    if len(kinds) == 2 and not compatible(*kinds):
        raise InputError("kind", " + ".join(kinds), "two effects that can act together")
    if setting not in SETTINGS:
        raise InputError("setting", setting, f"one of {', '.join(SETTINGS)}")
    if "static-friction" in kinds and setting in ("decay", "pendulum"):
        setting = "driven"
    for _ in range(MOST_TRIES):
        base = _base(rng, setting, kinds)
        effects = {name: DRAWS[name](base, rng) for name in kinds}
        try:
            seen = _channels(rng, setting, kinds), _noise(rng, base, noise), rng
            case = accepted(fitted(measured(base, effects, setting, *seen)))
        except SimulationError:
            continue
        if case is not None:
            return case
    raise SimulationError(
        f"plant: no concealed and decidable draw of {' + '.join(kinds) or 'control'} in {MOST_TRIES} tries"
    )


def control(rng: np.random.Generator, *, setting: str = "decay", noise: str = "white") -> Case:
    """What ``draw`` gives of a control, without its base fit, which on a driven one takes ten times as long."""
    base = _base(rng, setting, ())
    return measured(base, {}, setting, _channels(rng, setting, ()), _noise(rng, base, noise), rng)


def measured(
    base: Base,
    effects: Mapping[str, Mapping[str, Any]],
    setting: str,
    channels: str,
    noise: Noise,
    rng: np.random.Generator,
    motion: Motion = simulate,
    source: str = "plant",
) -> Case:
    """Simulate and spoil. motion : what makes the motion, with the name ``source``. Raises SimulationError."""
    model, sensors = build(base, effects)
    run, clean = sensors.read(model, base.times, motion)
    recorded = {"t": base.times, **{c: noise.spoil(c, clean[c], rng) for c in channels}}
    if base.drive is not None:
        recorded["u"] = run.u
    region = regions(effects, base, run.x, sensors.saturated(run))
    return Case(effects, channels, recorded, clean, base, noise, setting, region, source)


def fitted(case: Case) -> Case:
    """The case with its base fit; whether it serves is not asked."""
    at_truth = _chi2_truth(case)
    fit = _fit_base(case, at_truth)
    excess = fit.chi2 - at_truth
    parts = dict.fromkeys(case.effects, excess)
    return replace(case, base_chi2_excess=excess, base_r2=tuple(fit.r2.values()), part_chi2_excess=parts)


def accepted(case: Case) -> Case | None:
    """The case, with the loss of each part of a pair; None when what is hidden shows too plainly or not at all.

    Concealed: R^2 of the base fit above CONCEALED in each channel, and nothing odd about the decrement.
    """
    if not case.effects:
        return case
    if min(case.base_r2) < CONCEALED or case.base_chi2_excess < DECIDABLE or not _plausible(case):
        return None
    if len(case.effects) == 1:
        return case
    at_truth, parts = _chi2_truth(case), {}
    for name in case.effects:
        # the model without this part but with all the others, refitted
        left = {other: values for other, values in case.effects.items() if other != name}
        refit = fit_simulated(case.base, left, case.seen, case.recorded.get("u"), _bounds(at_truth, PART_DECIDABLE))
        # the base is a special case of what is left, so its loss is never below this one's
        parts[name] = min(refit.chi2 - at_truth, case.base_chi2_excess)
        if parts[name] < PART_DECIDABLE:
            return None
    return replace(case, part_chi2_excess=parts)


def _plausible(case: Case) -> bool:
    """Whether the decrement of a decay gives nothing away, in no channel."""
    if case.setting != "decay":
        return True
    t, base = case.recorded["t"], case.base
    return all(decrement(t, case.recorded[c], c).plausible(base.omega_n, base.length) for c in case.channels)


def _chi2_truth(case: Case) -> float:
    seen = case.seen
    left = {c: whiten(y - case.clean[c], seen.sigma[c], seen.correlation) for c, y in seen.channels.items()}
    return sum(float(np.sum(one**2)) for one in left.values())


def _fit_base(case: Case, chi2_truth: float) -> BaseFit:
    base, seen, u = case.base, case.seen, case.recorded.get("u")
    if base.restoring == "spring" and base.drive is None:
        return fit_decay(base.times, seen, (base.omega_n, base.zeta, base.x_k, base.x0, base.v0))
    if not case.effects:
        # of a control every fit is of use, of the others one that is concealed and decidable
        return fit_simulated(base, {}, seen, u)
    return fit_simulated(base, {}, seen, u, _bounds(chi2_truth, DECIDABLE), CONCEALED)


def _bounds(chi2_truth: float, loss: float) -> tuple[float, float]:
    return chi2_truth + loss, chi2_truth + BEYOND_DOUBT * loss


def truth(case: Case) -> dict[str, Any]:
    base, noise, effects = case.base, case.noise, case.effects

    def judged(name: str) -> dict[str, Any]:
        # a stop on the lower side alone has no agreed sign of its gap
        lower = effects[name].get("side") == "lower"
        return {p: effects[name][p] for p in BENCH[name].headline if p in effects[name] and not lower}

    return {
        "mechanisms": list(effects),
        "families": list(dict.fromkeys(family for name in effects for family in EFFECTS[name].families)),
        "channels": case.channels,
        "noise": {c: noise.total(c) for c in ("x", "a")},
        "noise_correlation": noise.correlation,
        "noise_step": noise.step,
        "setting": case.setting,
        "source": case.source,
        **{name: getattr(base, name) for name in ("restoring", "m", "omega_n", "zeta", "x_k", "x0", "v0")},
        "headline": {name: judged(name) for name in effects if name in FAMILY} or {"none": {}},
        "base_chi2_excess": case.base_chi2_excess,
        "base_r2": list(case.base_r2),
        "part_chi2_excess": dict(case.part_chi2_excess),
        "points": base.samples,
        "parameters": {name: dict(values) for name, values in effects.items()},
        "duration": float(case.recorded["t"][-1]),
        "region": case.region,
        "arguments": list(ARGUMENTS[base.restoring]),
    }


def csv_text(case: Case) -> str:
    """t, the channels and u where driven, in SI; an angle says so in its header."""
    angular = case.base.restoring == "pendulum" or "pendulum-stiffness" in case.effects
    unit = {"x": " [rad]", "a": " [rad/s^2]"} if angular else {}
    return as_csv({c + unit.get(c, ""): case.recorded[c] for c in ("t", "x", "a", "u") if c in case.recorded})


def as_csv(columns: Mapping[str, FloatArray]) -> str:
    """Columns by their heading, shape (n,) each, with nine significant digits."""
    text = StringIO()
    np.savetxt(
        text, np.column_stack(list(columns.values())), fmt="%.9g", delimiter=",", header=",".join(columns), comments=""
    )
    return text.getvalue()


SMALLEST = 0.15
"""Of the first extreme: smaller ones are left out, noise is too large a part of them."""
LEAST = 4


@dataclass(frozen=True, slots=True)
class Decrement:
    """omega_n (rad/s), zeta, x_k (m); nan where fewer than four half-cycles were seen."""

    omega_n: float
    zeta: float
    x_k: float

    def plausible(self, omega_n: float, length: float) -> bool:
        """Whether nobody would look twice.

        Finite, the frequency within 5 % of omega_n, damping and friction positive and below a tenth: of critical, and
        of the length of the motion.
        """
        if not all(map(math.isfinite, (self.omega_n, self.zeta, self.x_k))):
            return False
        near = abs(self.omega_n / omega_n - 1.0) < 0.05
        return near and 0.0 < self.zeta < 0.1 and 0.0 < self.x_k < 0.1 * length


def decrement(t: FloatArray, y: FloatArray, channel: str) -> Decrement:
    """The three numbers from one channel, "x" (m) or "a" (m/s^2), shape (n,), of a free decay."""
    extremes, half = _extremes(t, y)
    keep = int(np.argmax(extremes < SMALLEST * extremes[0])) if np.any(extremes < SMALLEST * extremes[0]) else None
    extremes = extremes[:keep]
    if extremes.size < LEAST or not half > 0.0:
        return Decrement(math.nan, math.nan, math.nan)
    q, less = np.polyfit(extremes[:-1], extremes[1:], 1)
    if not q > 0.0:
        return Decrement(math.nan, math.nan, math.nan)
    beta = -math.log(q) / math.pi
    zeta = beta / math.sqrt(1.0 + beta**2)
    omega_n = math.pi / half / math.sqrt(1.0 - zeta**2)
    x_k = -less / (1.0 + q) if channel == "x" else -less / (2.0 * q * omega_n**2)
    return Decrement(omega_n, zeta, float(x_k))


def _extremes(t: FloatArray, y: FloatArray) -> tuple[FloatArray, float]:
    """Magnitudes of the extremes of the half-cycles in between crossings of zero, and the time of a half-cycle, s."""
    smooth, half = y, math.nan
    for _ in range(2):
        crossed = np.flatnonzero(np.diff(np.signbit(smooth)))
        if crossed.size < LEAST:
            return np.zeros(1), math.nan
        gaps = np.diff(t[crossed[: max(LEAST, crossed.size // 2)]])
        half = float(np.median(gaps[gaps > 0.5 * gaps.max()]))
        # once more with crossings that noise has not multiplied
        width = max(1, int(0.15 * half / (t[1] - t[0])))
        smooth = np.convolve(y, np.ones(width) / width, mode="same")
    at = t[crossed]
    apart = np.concatenate([[True], np.diff(at) > 0.6 * half])
    at = at[apart]
    found = [_extreme(t, y, low, high) for low, high in pairwise(at.tolist()) if high - low < 1.4 * half]
    return (np.array(found) if found else np.zeros(1)), half


def _extreme(t: FloatArray, y: FloatArray, low: float, high: float) -> float:
    """The extreme of a half-cycle: a parabola through its middle half."""
    inside = np.abs(t - 0.5 * (low + high)) < 0.25 * (high - low)
    if np.count_nonzero(inside) < 4:
        return 0.0
    s = (t[inside] - 0.5 * (low + high)) / (high - low)
    curve = np.polynomial.Polynomial.fit(s, np.abs(y[inside]), 2)
    return float(np.max(curve(np.linspace(s[0], s[-1], 50))))
