"""Noise of a channel from what a fitted model leaves of it: far smoother than the channel, so longer windows serve.

What a model leaves shows, too, noise that is not the same throughout: of stamps that jitter, or of a tachometer.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.special import chdtrc

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import P, Problem
from harness.diagnosis.problems.simulated import FINE
from harness.diagnosis.rules import AS_FAST, STEADY
from harness.estimate.noise import FLOOR, Noise, Uneven, channel_noise, quantisation_step, rounded
from harness.kernels.solve import Scales
from harness.model.model import Model

_SHARE_OF_PERIOD = 0.25
"""Length of a window: a cubic follows a quarter of a swing to two thousandths."""
_SHORTEST, _LONGEST = 12, 40
"""Samples of a window: eight are left to a cubic, and a longer one takes a misfit's bend for noise."""
_DEGREE = 3
"""Of what is taken off each window."""
_OUTLYING = 5.0
"""Standard deviations of a window's power above the typical from which a misfit inflates it."""
_SHOWS, _MOST_COLOUR = 2.5, 0.85
"""Standard errors of a correlation that shows a colour (one-sided level 0.6 %); above the other it is motion."""
_WINDOW_SHOWS = 4.0
"""The same where windows tell it."""
_MOVING = 0.01
"""Of a channel's range: a window that spans less is at rest, where a quantised sensor says nothing."""
_FEWEST, _FEWEST_OF_COLOUR, _LEAST_FREEDOM = 4, 10, 6
"""Windows whose power has a median; windows that tell a colour, and the degrees of freedom of each."""
_LONGEST_COLOUR = 0.97
"""At the end of the grid: a colour as long as the windows, which is motion."""
_STRETCHES = 16
"""Of a residual, of which none may be stronger than chance makes the strongest."""
_GRID = np.linspace(-0.9, 0.98, 95)


def _residual_maker(width: int) -> FloatArray:
    q, _ = np.linalg.qr(np.vander(np.linspace(-1.0, 1.0, width), _DEGREE + 1))
    keep: FloatArray = np.eye(width) - q @ q.T
    return keep


def _expected(keep: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Mean square and lag-one product of detrended windows of unit first-order noise, over a grid of phi."""
    level, product = np.empty(_GRID.size), np.empty(_GRID.size)
    for i, phi in enumerate(_GRID):
        seen = _seen(keep, float(phi))
        level[i], product[i] = np.trace(seen), np.trace(seen, 1)
    return level, product / level


def _seen(keep: FloatArray, phi: float) -> FloatArray:
    """Covariance of a detrended window of unit first-order noise."""
    at = np.arange(keep.shape[0])
    found: FloatArray = keep @ phi ** np.abs(np.subtract.outer(at, at)) @ keep
    return found


def coloured_whole(residual: FloatArray, weight: FloatArray, said: Noise, width: int) -> Noise:
    """Noise of first-order colour that a residual (n,) as a whole would be; ``said`` where it shows no such colour.

    said : as windows of ``width`` samples tell it; they see little of a colour that lasts long beside them. weight (n,)
    : 0 for samples that do not count. Positive colours only, short beside a motion of some twenty samples a period, as
    strong in every stretch as in the others (a burst, such as a hand's at the release, is no noise), and as strong in
    windows as such a colour is: a slow misfit under a fast noise looks coloured as well, but moves less in each.
    """
    used = weight > 0.0
    both = used[1:] & used[:-1]
    power = float(np.mean(residual[used] ** 2)) if np.any(used) else 0.0
    if power <= 0.0 or not np.any(both) or not said.found:
        return said
    n = int(np.count_nonzero(both))
    phi = float(np.mean(residual[1:][both] * residual[:-1][both])) / power
    phi += (1.0 + 3.0 * phi) / n  # its bias in a short series (Marriott and Pope 1954)
    if not _SHOWS / math.sqrt(n) < phi < _MOST_COLOUR:
        return said
    coloured = replace(said, sigma=math.sqrt(power), phi=phi)
    fast = share_in_windows(residual, used, coloured, width) >= AS_FAST.value
    return coloured if fast and _steady(coloured.whitened(residual)[used]) else said


def window_of(t: FloatArray, period: float) -> int:
    """Samples of a window, at times t (n,), s, of a motion with this period, s."""
    return int(np.clip(_SHARE_OF_PERIOD * period / np.median(np.diff(t)), _SHORTEST, _LONGEST))


def share_in_windows(residual: FloatArray, used: BoolArray, noise: Noise, width: int) -> float:
    """Power of a residual (n,) in windows of ``width`` over what they would see of a noise; infinite without windows.

    used (n,) : samples that count; a window counts where all of its samples do.
    """
    whole = residual.size // width * width
    windows = residual[:whole].reshape(-1, width)[np.all(used[:whole].reshape(-1, width), axis=1)]
    if not windows.size:
        return math.inf
    keep = _residual_maker(width)
    expected = noise.sigma**2 * float(np.trace(_seen(keep, noise.phi)))
    return float(np.mean(np.sum((windows @ keep) ** 2, axis=1))) / expected


def _steady(white: FloatArray) -> bool:
    """Whether no stretch of whitened noise (n,) is stronger than chance makes the strongest."""
    width = white.size // _STRETCHES
    if width < 1:
        return True
    stretches = white[: _STRETCHES * width].reshape(_STRETCHES, width)
    strongest = float(np.max(np.sum(stretches**2, axis=1)))
    # one of so many: Bonferroni
    return bool(_STRETCHES * chdtrc(width, strongest) > STEADY.value)


def residual_noise(
    t: FloatArray, residual: FloatArray, channel: FloatArray, period: float, told: Noise | None = None
) -> Noise:
    """Noise of a channel (n,) from the residual (n,) of a model that follows its large motion.

    t : s. period : of the motion, s. Windows in which the model misses a jump are outvoted. Never below the
    quantisation's step^2/12, nor 1e-5 of the channel's rms, unless less was told of the channel itself.
    """
    width = window_of(t, period)
    windows = residual[: residual.size // width * width].reshape(-1, width)
    span = np.ptp(channel[: windows.size].reshape(-1, width), axis=1)
    moving = span > _MOVING * np.ptp(channel)
    windows = windows[moving] if np.count_nonzero(moving) >= _FEWEST else windows
    keep = _residual_maker(width)
    left = windows @ keep
    freedom = width - _DEGREE - 1
    power = np.sum(left**2, axis=1)
    typical = float(np.median(power)) / (freedom * (1.0 - 2.0 / (9.0 * freedom)) ** 3)
    # windows that a misfit inflates are left out; what that takes from honest ones is below one per cent
    sane = left[power <= typical * (freedom + _OUTLYING * math.sqrt(2.0 * freedom))]
    if sane.shape[0] < _FEWEST:
        sane = left
    total = float(np.sum(sane**2))
    phi, variance = 0.0, total / (sane.shape[0] * freedom)
    if freedom >= _LEAST_FREEDOM and sane.shape[0] >= _FEWEST_OF_COLOUR and total > 0.0:
        level, ratio = _expected(keep)
        seen = float(np.sum(sane[:, 1:] * sane[:, :-1])) / total
        white = float(np.interp(0.0, _GRID, ratio))
        if abs(seen - white) > _WINDOW_SHOWS / math.sqrt(sane.shape[0] * freedom):
            phi = float(np.interp(seen, np.maximum.accumulate(ratio), _GRID))
            # a colour as long as the windows is not told from what the model misses
            phi = 0.0 if phi > _LONGEST_COLOUR else phi
            variance = total / sane.shape[0] / float(np.interp(phi, _GRID, level))
    step = quantisation_step(channel)
    if rounded(variance, step):
        # a rounding says of the next one what the speed makes of it, which no colour does
        phi = 0.0
    sigma = math.sqrt(max(variance, step * step / 12.0))
    floor = FLOOR * float(np.std(channel))
    if told is not None and told.found and told.sigma < floor:
        return Noise(sigma, True, phi, step) if sigma > told.sigma else told
    return Noise(sigma, True, phi, step) if sigma > floor else Noise(floor, False)


_WINDOW, _QUINTIC = 8, 5
"""Samples of a window whose noise tells of stamps, and what is taken off it: a law that acts for longer stays out."""
_BESIDE = 4.0
"""Standard deviations of a stamp within which a sample may lie on the other side of a jump."""


def stamped(problem: P, model: Model, scales: Scales) -> P:
    """A problem whose samples count as their noise lets them; itself where it is even. model : fitted to it.

    An acceleration jumps where dry friction turns round: a sample beside that is left out. Raises SimulationError.
    """
    shown = problem.shows(model, (), scales, FINE)
    t, beside = problem.t, _to_reversal(problem.t, shown.v)
    turns = beside <= float(np.median(np.diff(t)))
    found = {}
    for c, y in problem.channels.items():
        left = y - shown.y[c]
        noise = channel_noise(t, left, 2.0 * np.pi / scales.omega)
        value, slope = shown.y[c], np.gradient(shown.y[c], t)
        found[c] = Uneven.of(c, t, left, value, slope, noise, _WINDOW, _QUINTIC, turns)
    worst, share = max(one.jitter for one in found.values()), max(one.share for one in found.values())
    if max(worst, share) <= 0.0:
        return problem
    level = {c: problem.level[c] * one.level for c, one in found.items()}
    counts = {c: (beside > _BESIDE * worst) | (c != "a") for c in problem.channels}
    return replace(problem, level=level, jitter=worst, share=share).weighted(counts)


def likelihood(found: Fit, problem: Problem, weight: Mapping[str, FloatArray]) -> float:
    """BIC of a fit under noise of unknown level, more of it by ``Problem.level``, over samples with a weight (n,)."""
    total = 0.0
    for c, left in problem.left(found.shown).items():
        used, level = weight[c] > 0.0, problem.level[c]
        even = (left / level)[used]
        total += even.size * math.log(float(np.mean(even**2))) + 2.0 * float(np.sum(np.log(level[used])))
    return total + len(found.free) * math.log(problem.points)


def _to_reversal(t: FloatArray, v: FloatArray) -> FloatArray:
    """Time (n,), s, from each sample to the nearest at which the speed v (n,) changes its sign."""
    at = np.flatnonzero(np.sign(v[1:]) != np.sign(v[:-1]))
    if not at.size:
        return np.full(t.size, np.inf)
    share = v[at] / (v[at] - v[at + 1])
    times = t[at] + share * (t[at + 1] - t[at])
    after = np.clip(np.searchsorted(times, t), 1, max(times.size - 1, 1))
    ends = np.stack((times[np.minimum(after - 1, times.size - 1)], times[np.minimum(after, times.size - 1)]))
    return np.asarray(np.min(np.abs(t - ends), axis=0), dtype=np.float64)
