"""Whether two matched traces differ by more than their noise, where, and whether a fit says more than noise would.

A fit follows noise as well as it can and leaves noise. Its rival, a slider at rest under a sensor's noise, moves
nothing: of every channel a level, with noise about it that may wander. That is an ARMA(1, 1) process, whose root is
real: white noise, a random walk, all between and both together. It swings at no frequency (Box and Jenkins 1976,
chapter 3).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.alignment.consistency import Consistency, consistency
from harness.diagnosis.alignment.match import Match, match, swing_of
from harness.diagnosis.baseline.residual_noise import residual_noise
from harness.diagnosis.explain.locate import Place, locate
from harness.diagnosis.motion import motion_of
from harness.diagnosis.residual_tests.cleaned import isolated
from harness.diagnosis.residual_tests.lack_of_fit import LackOfFit, lack_of_fit
from harness.diagnosis.rules import DECISIVE, ONE_CHANNEL, TRACES_LOUD, TRACES_STRUCTURE


@dataclass(frozen=True, slots=True)
class Comparison:
    """Two traces, moved and scaled onto each other.

    match : how, and what differs. doubted : structure of the difference. loud : its mean square over that of the noise,
    by channel. places : where it lies, none where the two agree. checks : what each trace's channels say of each other,
    sim first.
    """

    match: Match
    doubted: LackOfFit
    loud: Mapping[str, float]
    places: tuple[Place, ...]
    checks: tuple[tuple[Consistency, ...], tuple[Consistency, ...]]

    @property
    def verdict(self) -> Literal["identical", "same within noise", "different"]:
        """Whether the two differ."""
        if self.match.identical:
            return "identical"
        if self.match.aligned.faster:
            return "different"
        different = self.doubted.p_value < TRACES_STRUCTURE.value or max(self.loud.values()) > TRACES_LOUD.value
        return "different" if different else "same within noise"


def compared(sim: Recording, real: Recording, shift: float | None = None) -> Comparison:
    """Compare two traces, with a given shift of the first (s) or the one found; raises InputError when they have
    nothing in common.
    """
    found = match(sim, real, shift)
    # both traces in one, each by its precision: the motion whose noise has nothing in common with the difference; by a
    # trace's own noise the parts of its swing would be told by what is then looked for in them
    power = [{c: noise[c].sigma ** 2 if noise[c].found else 0.0 for c in found.real} for noise in found.found]
    share = {c: power[0][c] / max(power[0][c] + power[1][c], 1e-300) for c in found.real}
    between = {c: found.sim[c] + share[c] * left for c, left in found.difference.items()}
    motion = motion_of(found.t, between, found.omega)
    jacobian = {c: d[:, None] for c, d in found.partial.items()}
    doubted = lack_of_fit(found.whitened, found.t, found.omega, jacobian=jacobian, motion=motion)
    judged = dict(found.whitened)
    if found.interpolated:
        judged = {c: np.where(isolated(r), 0.0, r) for c, r in judged.items()}
    loud = {}
    for c, r in judged.items():
        # or over the noise that short windows of the difference show: a trace of some hundred samples tells its noise
        # to a factor of two in power; what two traces leave of each other is far smoother, and tells it better
        left = found.difference[c]
        own = residual_noise(found.t, left, found.real[c], 2.0 * math.pi / found.omega)
        loud[c] = min(float(np.mean(np.square(r))), float(np.mean(np.square(own.whitened(left)))))
    # a trace in which nothing swings has no channels to hold against each other
    checks = (
        consistency(sim.t, sim.channels, found.found[0], swing_of(sim), sim.angular),
        consistency(real.t, real.channels, found.found[1], found.omega, real.angular),
    )
    same = Comparison(found, doubted, loud, (), checks)
    # shift and rate were fitted, and each channel has a level and a size
    numbers = 2 + 2 * len(found.real)
    alike = same.verdict == "same within noise"
    if alike and motion_evidence(found.real, found.difference, numbers) < DECISIVE.value:
        what = f"no motion in common: noise about a level explains it as well as {sim.file} does"
        raise InputError(real.file, what, "two traces in which something moves")
    if same.verdict != "different":
        return same
    located = locate(judged, found.t, motion, unit="rad" if real.angular else "m")
    whole = ((float(found.t[0]), float(found.t[-1])),)
    places = (*_channel_alone(loud, whole), *located)
    return replace(same, places=places or (Place(whole, "throughout", "the whole of both traces", 1.0, 0.0),))


def _channel_alone(loud: Mapping[str, float], whole: tuple[tuple[float, float], ...]) -> tuple[Place, ...]:
    """The one channel that holds nearly all of the mismatch, where the others agree within the noise."""
    excess = {c: max(power - 1.0, 0.0) for c, power in loud.items()}
    total, (first, *others) = sum(excess.values()), sorted(loud, key=lambda c: -loud[c])
    quiet = others and all(loud[c] < TRACES_LOUD.value for c in others)
    if quiet and loud[first] > TRACES_LOUD.value and excess[first] > ONE_CHANNEL.value * total:
        return (Place(whole, "channel", f"channel {first}", excess[first] / total, 0.0),)
    return ()


_STARTS = ((0.0, 0.0), (0.7, 0.0), (0.97, 0.0), (0.97, 0.7), (0.999, 0.95))
"""Of memory and of what noise beside it takes off: white, coloured, wandering, and wandering under white noise."""


def motion_evidence(channels: Mapping[str, FloatArray], left: Mapping[str, FloatArray], numbers: int) -> float:
    """By how much BIC prefers a motion to rest under noise of unknown level and colour.

    channels (n,) : as recorded. left (n,) : what the motion leaves of each. numbers : fitted, of the motion.
    """
    gain, samples = 0.0, 0
    for c, y in channels.items():
        moving = _innovations(left[c])
        if moving <= 0.0:
            return math.inf
        gain += y.size * math.log(_innovations(y - np.mean(y)) / moving)
        samples += y.size
    return gain - (numbers - len(channels)) * math.log(samples)


def _innovations(left: FloatArray) -> float:
    """Mean square of what each value of a series (n,) adds to what those before say of it."""
    # imported when they are needed: they bring half of their library along
    from scipy.optimize import minimize
    from scipy.signal import lfilter

    def added(at: FloatArray) -> float:
        memory, beside = at
        fresh = lfilter([1.0], [1.0, -beside], left[1:] - memory * left[:-1])
        return float(np.mean(fresh**2))

    start = min(_STARTS, key=lambda at: added(np.array(at)))
    found = minimize(added, start, method="Nelder-Mead", bounds=[(-1.0, 1.0), (-1.0, 1.0)], options={"maxfev": 100})
    return float(found.fun)
