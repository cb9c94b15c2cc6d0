"""Does structure remain in a residual beyond noise whose level is known only from the residual itself?

The total chi-square says little then. So each test compares something a misfit would fill with something only noise
fills: low frequencies with the band above them, one spectral line with its surroundings, one stretch of time or one
part of the swing with the same floor. What a fit has already taken from the residual is accounted for by its Jacobian.
Single samples on the wrong side of a jump are set aside: they are flat in frequency but many.

Parts of a recording are asked, too, whether they want the same parameters as the whole (Nyblom 1989, in blocks). To
first order a part's own fit takes from its residual what lies along the partials there. These are few directions, and a
model that only mimics an effect fails in them first, long before its residual looks structured.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import numpy as np
from scipy.special import fdtrc

from harness.core.arrays import FloatArray, IntArray
from harness.diagnosis.motion import Motion
from harness.diagnosis.residual_tests.cleaned import BANDS, Channel, channels_of


def _over_floor(chi2: float, k: float, m: float) -> float:
    """Chance of a mean square this large over a floor that has m degrees of freedom."""
    return float(fdtrc(k, m, chi2 / k)) if k >= 1.0 else 1.0


def _spared(chance: Callable[[float], float], chi2: float, spare: float) -> float:
    """Chance of a chi-square of which ``spare`` may be left besides by what is no structure, all of it here.

    chance : of a chi-square. What is spared makes a test say nothing, never that there is too little.
    """
    plain = chance(chi2)
    return plain if spare <= 0.0 else max(plain, min(chance(max(chi2 - spare, 0.0)), 0.5))


Test: TypeAlias = tuple[str, float, float]
"""What is tested, its p-value, and the mean square over what noise gives."""
_MOST_STRETCHES = 8
"""Of equal numbers of half-cycles, which are held against each other."""
_SEEN = 1e-6
"""Share of its power in a part from which a fitted direction is seen there."""


def _constancy(channels: Mapping[str, Channel], t: FloatArray, motion: Motion, spare: float) -> list[Test]:
    """Whether parameters depend on the part of a recording, for each way to part it."""
    freedom, n = float(sum(one.freedom for one in channels.values())), t.size
    turns = (t - t[0]) * motion.omega / (2.0 * math.pi)
    stretch = turns * _MOST_STRETCHES / max(float(turns[-1]), _MOST_STRETCHES)
    parts: dict[str, IntArray] = {
        "half": 2 * np.arange(n) // n,
        "quarter": 4 * np.arange(n) // n,
        "cycle": np.minimum(stretch.astype(np.int64), _MOST_STRETCHES - 1),
        "direction": (motion.v > 0.0).astype(np.int64),
        "side": (motion.x > 0.0).astype(np.int64),
    }
    out = []
    for name, part in parts.items():
        chi2, k = _taken(channels, part)
        if k >= 1.0:
            p = _spared(partial(_over_floor, k=k, m=freedom), chi2, spare)
            out.append((f"parameters that differ from {name} to {name}", p, chi2 / k))
    return out


def _taken(channels: Mapping[str, Channel], part: IntArray) -> tuple[float, float]:
    """Chi-square that the parts' own fits would take besides the common one, and its degrees of freedom."""
    fitted = next(iter(channels.values())).basis.shape[1]
    chi2, k = 0.0, -float(fitted)
    for number in range(int(part.max()) + 1):
        score, gram = np.zeros(fitted), np.zeros((fitted, fitted))
        for one in channels.values():
            inside = part[one.kept] == number
            score += one.basis[inside].T @ one.r[inside]
            gram += one.basis[inside].T @ one.basis[inside]
        values, vectors = np.linalg.eigh(gram)
        seen = values > _SEEN
        chi2 += float(np.sum((vectors.T @ score)[seen] ** 2 / values[seen]))
        k += float(np.count_nonzero(seen))
    return chi2, k


_STRETCHES = (4, 16, 64)
"""Equal stretches of a recording, the strongest of which is tested: one event, or many cycles."""
_FEWEST_INSIDE = 3
"""Blocks of slow structure in a stretch below which it has none of its own."""
_PHASES = 24
"""Parts of a swing whose means are tested."""
_SURROUNDINGS = 64
"""Frequencies around a line that say its level."""
_FEW_SURROUNDINGS, _FEW_FREEDOM, _FREEDOM = 8, 2.0 * 44.0, 2.0 * 60.0
"""The level is a median of 64: its scatter fattens the tail, as an F with so many degrees would, fewer where there are
few levels to be the largest of."""
_LEAST_LEVEL = 0.8
"""Of the floor: beside a lower level any line would stand out."""
_FEWEST = 40
"""Samples of a channel that is tested."""
_EXACT = 1e-12
"""Chance below which the combination of tests is that of the least, times their number."""
_SAID = 0.05
"""Chance from which the sentence says noise; the verdict has its own level (rule structure)."""
_INSIDE = 1e-2
"""A fitted direction with less than this share of its power outside a band is lost to it."""


@dataclass(frozen=True, slots=True)
class LackOfFit:
    """Outcome of the test.

    p_value : chance that noise alone looks at least so structured. statistic : of the strongest single test, its mean
    square over what noise gives. sentence : what was found, plainly. tests : every test with its p-value.
    """

    p_value: float
    statistic: float
    sentence: str
    tests: tuple[tuple[str, float], ...] = ()


def _score(c: FloatArray, a: FloatArray) -> tuple[float, float]:
    """Chi-square of the coefficients c (K,) of an orthonormal set, and its degrees of freedom.

    a : (K, q), coefficients in the same set of an orthonormal basis of what was fitted, to which the residual is
    orthogonal. The set's covariance is then I - a a', inverted by way of I - a' a.
    """
    chi2 = float(c @ c)
    if not a.shape[1]:
        return chi2, float(c.size)
    inner = np.eye(a.shape[1]) - a.T @ a
    values, vectors = np.linalg.eigh(inner)
    free = values > _INSIDE
    lost = float(np.count_nonzero(~free))
    b = (vectors.T @ (a.T @ c))[free]
    return chi2 + float(np.sum(b * b / values[free])), max(c.size - lost, 0.0)


def _bands(channels: Mapping[str, Channel], spare: float) -> list[Test]:
    out = []
    for end in BANDS:
        c, a, m = [], [], []
        for one in channels.values():
            k = int(np.clip(end * one.per_omega, 1, one.top))
            c.append(one.c[:k])
            a.append(one.q[:k])
            m.append(one.freedom)
        chi2, k_free = _score(np.concatenate(c), np.concatenate(a))
        name = f"slow structure, up to {end:g} times the swing's frequency"
        p = _spared(partial(_over_floor, k=k_free, m=float(sum(m))), chi2, spare)
        out.append((name, p, chi2 / max(k_free, 1.0)))
    return out


def _stretches(channels: Mapping[str, Channel], spare: float) -> list[Test]:
    """The strongest of equal stretches of time, in slow structure within the stretch."""
    out = []
    for count in _STRETCHES:
        for name, one in channels.items():
            width = one.r.size // count
            block = max(1, int(one.r.size / max(one.top, 1)))
            inside = width // block
            if inside < _FEWEST_INSIDE:
                continue
            cut = one.r[: count * width].reshape(count, width)[:, : inside * block]
            means = cut.reshape(count, inside, block).sum(axis=2) / math.sqrt(block)
            power = np.sum(means**2, axis=1)
            worst = float(np.max(power))
            p = _spared(partial(_of_the_most, count=count, k=float(inside), m=float(one.freedom)), worst, spare)
            out.append((f"channel {name} stands out in one {count}th of the time", p, worst / inside))
    return out


def _of_the_most(chi2: float, count: int, k: float, m: float) -> float:
    """Chance that the largest of so many is this large."""
    return -math.expm1(count * math.log1p(-min(_over_floor(chi2, k, m), 1.0 - 1e-16)))


def _lines(channels: Mapping[str, Channel]) -> list[Test]:
    """The strongest spectral line over its surroundings, at any frequency (Fisher's test with a local level)."""
    out = []
    for name, one in channels.items():
        n = one.r.size
        power = np.abs(np.fft.rfft(one.r))[1 : (n + 1) // 2] ** 2 / n
        count = power.size // _SURROUNDINGS
        if count == 0:
            continue
        rows = power[: count * _SURROUNDINGS].reshape(count, -1)
        level = np.maximum(np.median(rows, axis=1) / math.log(2.0), _LEAST_LEVEL)
        peaks = np.max(rows, axis=1) / level
        i = int(np.argmax(peaks))
        few = power.size < _FEW_SURROUNDINGS * _SURROUNDINGS
        single = _over_floor(2.0 * float(peaks[i]), 2.0, _FEW_FREEDOM if few else _FREEDOM)
        p = -math.expm1(power.size * math.log1p(-min(single, 1.0 - 1e-16)))
        out.append((f"a line in the spectrum of channel {name}", p, float(peaks[i])))
    return out


def _phases(channels: Mapping[str, Channel], motion: Motion, spare: float) -> list[Test]:
    """Mean residual in parts of the swing, large and small amplitudes apart."""
    turn = np.arctan2(-motion.v / motion.omega, motion.x) / (2.0 * math.pi) + 0.5
    size = np.hypot(motion.x, motion.v / motion.omega)
    part = np.minimum((turn * _PHASES).astype(np.int64), _PHASES - 1) + _PHASES * (size > np.median(size))
    c, a, m = [], [], []
    for one in channels.values():
        place = part[one.kept]
        count = np.bincount(place, minlength=2 * _PHASES).astype(np.float64)
        used = count > 0
        root = np.sqrt(count[used])
        c.append(np.bincount(place, one.r, 2 * _PHASES)[used] / root)
        q = one.basis
        a.append(
            np.column_stack([np.bincount(place, q[:, j], 2 * _PHASES)[used] / root for j in range(q.shape[1])])
            if q.shape[1]
            else np.zeros((int(used.sum()), 0))
        )
        m.append(one.freedom)
    chi2, k = _score(np.concatenate(c), np.concatenate(a))
    p = _spared(partial(_over_floor, k=k, m=float(sum(m))), chi2, spare)
    return [("a mean that depends on the part of the swing", p, chi2 / max(k, 1.0))]


def _combined(p_values: Sequence[float]) -> float:
    """One p-value of several dependent ones (Liu and Xie 2020, the Cauchy combination: exact in the tail)."""
    p = np.clip(np.asarray(p_values), 1e-300, 1.0 - _EXACT)
    if p.min() < _EXACT:
        return float(min(1.0, p.min() * p.size))
    mean = float(np.mean(np.tan((0.5 - p) * math.pi)))
    return 0.5 - math.atan(mean) / math.pi


def lack_of_fit(
    residuals: Mapping[str, FloatArray],
    t: FloatArray,
    omega: float,
    *,
    jacobian: Mapping[str, FloatArray] | None = None,
    motion: Motion | None = None,
    spare: float = 0.0,
) -> LackOfFit:
    """Whether structure remains in whitened residuals (n,) of each channel at t (n,), s; omega of the motion, rad/s.

    The level of the noise is taken from the residuals; samples that are exactly zero did not count in the fit.
    jacobian : whitened partials (n, q) of each channel by the fitted numbers, so that the test is exact although the
    fit has taken its share. motion : to look at parts of the swing too, and of the recording. spare : chi-square that
    may be left beyond the level of the noise, in one place or another, by what is no structure. Linear in samples.
    """
    names = [c for c, r in residuals.items() if np.count_nonzero(r) >= _FEWEST]
    if not names:
        return LackOfFit(1.0, 0.0, "there is nothing left over at all")
    partials = {c: jacobian[c] if jacobian else np.zeros((t.size, 0)) for c in names}
    channels = channels_of({c: residuals[c] for c in names}, partials, t, omega)
    if not channels:
        return LackOfFit(1.0, 0.0, "too few samples for any structure to show")
    tests = _bands(channels, spare) + _stretches(channels, spare) + _lines(channels)
    if motion is not None:
        tests += _phases(channels, motion, spare)
        tests += _constancy(channels, t, motion, spare)
    p = _combined([test[1] for test in tests])
    name, _, ratio = min(tests, key=lambda test: (test[1], -test[2]))
    if p < _SAID:
        sentence = f"{name}: {ratio:.3g} times what noise gives there (p = {p:.2g})"
    else:
        sentence = f"what is left looks like noise (p = {p:.2g})"
    return LackOfFit(p, ratio, sentence, tuple((test[0], test[1]) for test in tests))
