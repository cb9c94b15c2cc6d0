"""Does structure remain in a residual beyond noise whose level is known only from the residual itself?

The total chi-square says little then. So each test compares something a misfit would fill with something only noise
fills: low frequencies with the band above them, one spectral line with its surroundings, one stretch of time or one
part of the swing with the same floor. What a fit has already taken from the residual is accounted for by its Jacobian.
Single samples on the wrong side of a jump are set aside: they are flat in frequency but many.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.fft import dct
from scipy.special import fdtrc

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.motion import Motion

_BANDS = (0.5, 1.5, 3.5, 8.5, 16.5)
"""Upper ends of the bands tested, in units of the motion's frequency."""
_WIDEST = 0.4
_FLOOR_RATIO = 4.0
_FEWEST_FLOOR = 60
_ISOLATED = 3.5
_NEIGHBOUR = 1.7
_TAIL = 2.8
_STILL = 5
_STRETCHES = (4, 16, 64)
_PHASES = 24
_LOWEST_FLOOR = 0.5
_SURROUNDINGS = 64
_INSIDE = 1e-2
"""A fitted direction with less than this share of its power outside a band is lost to it."""
_MOST_PARTS = 8
_SEEN = 1e-6
"""Share of its power in a part from which a fitted direction is seen there."""
_TRUSTED = 1e-4


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


@dataclass(frozen=True, slots=True)
class _Channel:
    """A cleaned residual r (n,) in units of its floor and the fitted directions (n, q), both with cosine coefficients.

    kept : which samples of the recording these are. per_omega : coefficients per multiple of the swing's frequency.
    freedom : of the floor. top : coefficients below the floor's band.
    """

    r: FloatArray
    basis: FloatArray
    c: FloatArray
    q: FloatArray
    kept: BoolArray
    per_omega: float
    freedom: int
    top: int


def isolated(r: FloatArray) -> BoolArray:
    """Which samples of a residual (n,) stand alone far out: misplaced next to a jump, or stray."""
    level = 1.4826 * float(np.median(np.abs(r)))
    if level <= 0.0:
        return np.zeros(r.size, dtype=np.bool_)
    padded = np.concatenate(([0.0], r, [0.0]))
    beside = np.maximum(padded[:-2] * np.sign(r), padded[2:] * np.sign(r))
    found: BoolArray = (np.abs(r) > _ISOLATED * level) & (beside < np.maximum(_NEIGHBOUR * level, 0.4 * np.abs(r)))
    return found


def _repeats(r: FloatArray) -> BoolArray:
    """Samples that repeat the one before in a run of at least five: a quantised sensor at rest says one thing once."""
    same = np.concatenate(([False], np.abs(np.diff(r)) <= 1e-6 * (np.abs(r[1:]) + 1e-12)))
    edges = np.diff(np.concatenate(([0], same.astype(np.int8), [0])))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    found = np.zeros(r.size, dtype=np.bool_)
    for lo, hi in zip(starts, ends, strict=True):
        if hi - lo >= _STILL:
            found[lo:hi] = True
    return found


@dataclass(frozen=True, slots=True)
class _Clean:
    """Samples of a channel that count, as multiples of its floor; the same of the Jacobian."""

    r: FloatArray
    j: FloatArray
    kept: BoolArray
    per_omega: float
    freedom: int
    top: int


def _clean(r: FloatArray, j: FloatArray, t: FloatArray, omega: float, doubtful: BoolArray | None) -> _Clean:
    kept = (r != 0.0) & ~_repeats(r)
    y, partial = r[kept].copy(), j[kept].copy()
    away = isolated(y)
    if doubtful is not None:
        away |= doubtful[kept]
    # heavier tails than normal ones are cut: what they hold is no structure, but would count as much
    level = _TAIL * 1.4826 * float(np.median(np.abs(y))) if y.size else 0.0
    if level > 0.0:
        np.clip(y, -level, level, out=y)
    y[away] = 0.0
    partial[away] = 0.0
    n = y.size
    per_omega = n * float(np.median(np.diff(t))) * omega / math.pi
    top = int(min(_BANDS[-1] * per_omega, _WIDEST * n))
    last = min(n, max(int(_FLOOR_RATIO * top), top + _FEWEST_FLOOR))
    above = dct(y, norm="ortho")[top:last] ** 2 if n else y
    # a claimed level far above what is seen is believed: numbers have other errors than noise
    floor = math.sqrt(max(float(np.mean(above)) if above.size else 1.0, _LOWEST_FLOOR))
    return _Clean(y / floor, partial / floor, kept, per_omega, max(above.size, 1), top)


def _channels(
    residuals: Mapping[str, FloatArray],
    jacobian: Mapping[str, FloatArray],
    t: FloatArray,
    omega: float,
    doubtful: Mapping[str, BoolArray],
) -> dict[str, _Channel]:
    """Channels without doubtful samples, orthogonal once more to what was fitted."""
    clean = {c: _clean(r, jacobian[c], t, omega, doubtful.get(c)) for c, r in residuals.items()}
    clean = {c: one for c, one in clean.items() if one.top >= 1}
    if not clean:
        return {}
    sizes = np.cumsum([one.r.size for one in clean.values()])[:-1]
    q = _orthonormal(np.concatenate([one.j for one in clean.values()]))
    r = np.concatenate([one.r for one in clean.values()])
    r -= q @ (q.T @ r)
    out = {}
    for (c, one), part, basis in zip(clean.items(), np.split(r, sizes), np.split(q, sizes), strict=True):
        coefficients = dct(basis, norm="ortho", axis=0) if basis.shape[1] else basis
        out[c] = _Channel(
            part, basis, dct(part, norm="ortho"), coefficients, one.kept, one.per_omega, one.freedom, one.top
        )
    return out


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


def _p(chi2: float, k: float, m: float) -> float:
    """Chance of a mean square this large over a floor that has m degrees of freedom."""
    return float(fdtrc(k, m, chi2 / k)) if k >= 1.0 else 1.0


def _bands(channels: Mapping[str, _Channel]) -> list[tuple[str, float, float]]:
    out = []
    for end in _BANDS:
        c, a, m = [], [], []
        for one in channels.values():
            k = int(np.clip(end * one.per_omega, 1, one.top))
            c.append(one.c[:k])
            a.append(one.q[:k])
            m.append(one.freedom)
        chi2, k_free = _score(np.concatenate(c), np.concatenate(a))
        name = f"slow structure, up to {end:g} times the swing's frequency"
        out.append((name, _p(chi2, k_free, float(sum(m))), chi2 / max(k_free, 1.0)))
    return out


def _stretches(channels: Mapping[str, _Channel]) -> list[tuple[str, float, float]]:
    """The strongest of equal stretches of time, in slow structure within the stretch."""
    out = []
    for count in _STRETCHES:
        for name, one in channels.items():
            width = one.r.size // count
            block = max(1, int(one.r.size / max(one.top, 1)))
            inside = width // block
            if inside < 3:
                continue
            cut = one.r[: count * width].reshape(count, width)[:, : inside * block]
            means = cut.reshape(count, inside, block).sum(axis=2) / math.sqrt(block)
            power = np.sum(means**2, axis=1)
            worst = float(np.max(power))
            single = _p(worst, float(inside), float(one.freedom))
            text = f"channel {name} stands out in one {count}th of the time"
            out.append((text, -math.expm1(count * math.log1p(-min(single, 1.0 - 1e-16))), worst / inside))
    return out


def _lines(channels: Mapping[str, _Channel]) -> list[tuple[str, float, float]]:
    """The strongest spectral line over its surroundings, at any frequency (Fisher's test with a local level)."""
    out = []
    for name, one in channels.items():
        n = one.r.size
        if n < 2 * _SURROUNDINGS:
            continue
        power = np.abs(np.fft.rfft(one.r))[1 : (n + 1) // 2] ** 2 / n
        count = power.size // _SURROUNDINGS
        rows = power[: count * _SURROUNDINGS].reshape(count, -1)
        level = np.maximum(np.median(rows, axis=1) / math.log(2.0), 0.8)
        peaks = np.max(rows, axis=1) / level
        i = int(np.argmax(peaks))
        # the level is a median of 64: its scatter fattens the tail, as an F with about 2 x 44 degrees would
        single = _p(2.0 * float(peaks[i]), 2.0, 2.0 * 44.0 if power.size < 8 * _SURROUNDINGS else 2.0 * 60.0)
        p = -math.expm1(power.size * math.log1p(-min(single, 1.0 - 1e-16)))
        out.append((f"a line in the spectrum of channel {name}", p, float(peaks[i])))
    return out


def _phases(channels: Mapping[str, _Channel], motion: Motion) -> list[tuple[str, float, float]]:
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
    return [("a mean that depends on the part of the swing", _p(chi2, k, float(sum(m))), chi2 / max(k, 1.0))]


def _constancy(
    channels: Mapping[str, _Channel], t: FloatArray, motion: Motion, gain: float
) -> list[tuple[str, float, float]]:
    """Whether each part of a recording asks for the same parameters as the whole does (Nyblom 1989, in blocks).

    To first order a part's own fit takes from its residual what lies along the partials there: few directions, and a
    model that only mimics fails in them first. What is a hundredth of an explained effect in size, gain in chi-square,
    counts as explained with it: so far a simulation is trusted next to jumps.
    """
    turns = (t - t[0]) * motion.omega / (2.0 * math.pi)
    cycles = np.minimum((turns * _MOST_PARTS / max(float(turns[-1]), _MOST_PARTS)).astype(np.int64), _MOST_PARTS - 1)
    halves = [(f"part {n}", np.minimum((n * np.arange(t.size)) // t.size, n - 1)) for n in (2, 4)]
    parts = [*halves, ("cycle", cycles), ("direction", (motion.v > 0.0).astype(np.int64)),
             ("side", (motion.x > 0.0).astype(np.int64))]  # fmt: skip
    m = float(sum(one.freedom for one in channels.values()))
    fitted = next(iter(channels.values())).basis.shape[1]
    out = []
    for name, label in parts:
        chi2, k = 0.0, -float(fitted)
        for part in range(int(label.max()) + 1):
            score, gram = np.zeros(fitted), np.zeros((fitted, fitted))
            for one in channels.values():
                inside = label[one.kept] == part
                score += one.basis[inside].T @ one.r[inside]
                gram += one.basis[inside].T @ one.basis[inside]
            values, vectors = np.linalg.eigh(gram)
            seen = values > _SEEN
            chi2 += float(np.sum((vectors.T @ score)[seen] ** 2 / values[seen]))
            k += float(np.count_nonzero(seen))
        chi2 = max(chi2 - _TRUSTED * gain, 0.0)
        if k >= 1.0:
            out.append((f"parameters that depend on the {name}", _p(chi2, k, m), chi2 / k))
    return out


def _combined(p_values: Sequence[float]) -> float:
    """One p-value of several dependent ones (Liu and Xie 2020, the Cauchy combination: exact in the tail)."""
    p = np.clip(np.asarray(p_values), 1e-300, 1.0 - 1e-12)
    if p.min() < 1e-12:
        return float(min(1.0, p.min() * p.size))
    mean = float(np.mean(np.tan((0.5 - p) * math.pi)))
    return 0.5 - math.atan(mean) / math.pi


def lack_of_fit(
    residuals: Mapping[str, FloatArray],
    t: FloatArray,
    omega: float,
    *,
    jacobian: Mapping[str, FloatArray] | None = None,
    doubtful: Mapping[str, BoolArray] | None = None,
    motion: Motion | None = None,
    gain: float = 0.0,
) -> LackOfFit:
    """Whether structure remains in whitened residuals (n,) of each channel at t (n,), s; omega of the motion, rad/s.

    The level of the noise is taken from the residuals; samples that are exactly zero did not count in the fit.
    jacobian : whitened partials (n, q) of each channel by the fitted numbers, so that the test is exact although the
    fit has taken its share. doubtful : samples that may lie on the wrong side of a jump. motion : to look at parts of
    the swing too, and of the recording. gain : chi-square that the model's terms explain. Linear in samples.
    """
    names = [c for c, r in residuals.items() if np.count_nonzero(r) >= 40]
    if not names:
        return LackOfFit(1.0, 0.0, "there is nothing left over at all")
    partials = {c: jacobian[c] if jacobian else np.zeros((t.size, 0)) for c in names}
    channels = _channels({c: residuals[c] for c in names}, partials, t, omega, doubtful or {})
    if not channels:
        return LackOfFit(1.0, 0.0, "too few samples for any structure to show")
    tests = _bands(channels) + _stretches(channels) + _lines(channels)
    if motion is not None:
        tests += _phases(channels, motion)
        tests += _constancy(channels, t, motion, gain)
    p = _combined([test[1] for test in tests])
    name, _, ratio = min(tests, key=lambda test: (test[1], -test[2]))
    if p < 0.05:
        sentence = f"{name}: {ratio:.3g} times what noise gives there (p = {p:.2g})"
    else:
        sentence = f"what is left looks like noise (p = {p:.2g})"
    return LackOfFit(p, ratio, sentence, tuple((test[0], test[1]) for test in tests))


def _orthonormal(j: FloatArray) -> FloatArray:
    """An orthonormal basis of the columns of j (N, q); directions that cannot be told from others are dropped."""
    scale = np.sqrt(np.einsum("ij,ij->j", j, j))
    j = j[:, scale > 0.0] / scale[scale > 0.0]
    if not j.shape[1]:
        return j
    values, vectors = np.linalg.eigh(j.T @ j)
    good = values > 1e-10 * float(values[-1])
    basis: FloatArray = j @ (vectors[:, good] / np.sqrt(values[good]))
    return basis
