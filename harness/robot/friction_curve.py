"""A joint's friction as a curve over its speed: its band, the line that stands for it in a model, the law that says it.

A curve is a cubic spline through knots, speeds that occur, in either direction by itself. A torque that is there
whatever the speed cannot be told from friction that differs between the directions: it is taken off.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.quantity import Quantity

_TRIED = 12
"""Values of what is not linear in a law."""
_SAID = 0.01
"""Probability from which a law is listed."""
_TRUE = 0.002
"""Of friction: a value of a curve is no truer, whatever its error, since splines are none of these laws (of 140 curves
of simulated arms half are .5 % from a regression by the law itself: python -m benchmarks.robot_calibrate.curves)."""


@dataclass(frozen=True, slots=True)
class Law:
    """One way to say a curve. probability : beside the other laws. parameters : by name."""

    name: str
    probability: float
    parameters: tuple[tuple[str, Quantity], ...]


Values = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class _Form:
    """names : of the numbers, those that are not linear last. columns : for speeds (k,) at values of these, which are
    tried. positive : the last of the linear numbers that are above 0, or the law is not what its name says."""

    names: tuple[str, ...]
    columns: Callable[[FloatArray, Values], tuple[FloatArray, ...]]
    values: Callable[[FloatArray], Iterable[Values]] = lambda _: ((),)
    positive: int = 0


def _within(s: FloatArray) -> Iterable[Values]:
    return ((float(one),) for one in np.geomspace(s[0], s[-2], _TRIED))


def _powers(_: FloatArray) -> Iterable[Values]:
    return ((one,) for one in (*_CONCAVE, 1.25, 1.5, 1.75, 2.0))


_CONCAVE = (0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8)


_FORMS = {
    "Coulomb": _Form(("f_k",), lambda s, _: (np.ones_like(s),)),
    "Coulomb and viscous": _Form(("f_k", "c"), lambda s, _: (np.ones_like(s), s)),
    "Stribeck": _Form(
        ("f_k", "c", "f_s - f_k", "v_s"), lambda s, x: (np.ones_like(s), s, np.exp(-((s / x[0]) ** 2))), _within, 1
    ),
    "Stribeck, Lorentzian": _Form(
        ("f_k", "c", "f_s - f_k", "v_s"), lambda s, x: (np.ones_like(s), s, 1.0 / (1.0 + (s / x[0]) ** 2)), _within, 1
    ),
    "power of speed": _Form(("f_k", "c", "exponent"), lambda s, x: (np.ones_like(s), s ** x[0]), _powers, 1),
    "Stribeck and power of speed": _Form(
        ("f_k", "c", "f_s - f_k", "v_s", "exponent"),
        lambda s, x: (np.ones_like(s), s ** x[1], np.exp(-((s / x[0]) ** 2))),
        lambda s: ((*fall, power) for fall in _within(s) for power in _CONCAVE),
        2,
    ),
    "saturating with speed": _Form(
        ("f_k", "rise", "v_0"), lambda s, x: (np.ones_like(s), np.tanh(s / x[0])), _within, 1
    ),
    "quadratic drag": _Form(("f_k", "c", "c_2"), lambda s, _: (np.ones_like(s), s, s**2), positive=1),
}


@dataclass(slots=True)
class _Tried:
    worth: float = math.inf
    numbers: FloatArray = field(default_factory=lambda: np.empty(0))
    errors: FloatArray = field(default_factory=lambda: np.empty(0))
    values: Values = ()


def laws(
    s: FloatArray, friction: FloatArray, covariance: FloatArray, samples: int, units: tuple[str, str]
) -> tuple[Law, ...]:
    """Laws by their probability: chi-square of the mean of both directions and the usual price of a number (BIC)."""
    power, turn = np.linalg.eigh(covariance + np.diag((_TRUE * friction) ** 2))
    root = turn / np.sqrt(np.maximum(power, 1e-9 * power[-1]))
    found = {}
    for name, form in _FORMS.items():
        if len(form.names) > s.size:
            continue
        best = _Tried()
        for values in form.values(s):
            columns = root.T @ np.column_stack(form.columns(s, values))
            inverse = np.linalg.pinv(columns.T @ columns)
            numbers = inverse @ columns.T @ (root.T @ friction)
            if np.any(numbers[numbers.size - form.positive :] <= 0.0):
                continue
            worth = float(np.sum((root.T @ friction - columns @ numbers) ** 2)) + len(form.names) * math.log(samples)
            if worth < best.worth:
                best = _Tried(worth, numbers, np.sqrt(np.diag(inverse)), values)
        if best.numbers.size:
            found[name] = best
    least = min(one.worth for one in found.values())
    odds = {name: math.exp((least - one.worth) / 2.0) for name, one in found.items()}
    whole = sum(odds.values())
    return tuple(
        Law(name, odds[name] / whole, _named(_FORMS[name], one, units))
        for name, one in sorted(found.items(), key=lambda both: both[1].worth)
        if odds[name] > _SAID * whole
    )


def _named(form: _Form, one: _Tried, units: tuple[str, str]) -> tuple[tuple[str, Quantity], ...]:
    force, damping = units
    place = "rad" if "rad" in damping else "m"
    speed = f"{place}/s"
    unit = {"c": damping, "c_2": f"{force} s^2/{place}^2", "exponent": "1", "v_s": speed, "v_0": speed}
    if "exponent" in form.names:
        unit["c"] = f"{force} ({speed})^-a"
    told = [
        (name, Quantity(float(x), float(e), unit.get(name, force)))
        for name, x, e in zip(form.names, one.numbers, one.errors, strict=False)
    ]
    nearest = "the nearest of the values that were tried"
    told += [
        (name, Quantity(value, None, unit[name], nearest))
        for name, value in zip(form.names[one.numbers.size :], one.values, strict=True)
    ]
    return tuple(told)


_KNOTS = (0.01, 0.05, 0.14, 0.28, 0.45, 0.65, 0.84, 0.97)
"""Shares of a direction's samples that are slower: more knots where laws bend most."""
_APART = 1.15
"""Ratio of neighbouring knots, at least."""
_BLOCKS = 4
"""Of time that reach the fastest knot in either direction: what is left out in turn never is all of them."""
_FEWEST = 3
"""Knots that make a curve."""
_SURE = 2.0
"""Errors above none from which a number of the line is there."""
_SAYS = 4.0
"""Errors from which friction is said to change with something: one of a dozen asked does so by chance at two."""


@dataclass(frozen=True, slots=True)
class Change:
    """How friction changes with something beside speed. by : for one unit of it, None where the log does not cover it.

    why : then what it lacks. surely : by more than four errors.
    """

    what: str
    by: Quantity | None
    why: str = ""

    @property
    def surely(self) -> bool:
        """Whether it is there."""
        by = self.by
        return by is not None and by.value is not None and abs(by.value) > _SAYS * (by.stderr or math.inf)


@dataclass(frozen=True, slots=True)
class FrictionCurve:
    """Friction of a joint over its speed, mean over the positions and loads of a log.

    v (n,) : knots, rad/s or m/s, rising; half of them are in either direction. friction (n,) : torque that acts against
    the drive, N m or N, of the sign of v. low, high (n,) : its band of 95 %. error (n,) : standard. line : Coulomb and
    viscous friction that come nearest at the speeds that occur. laws : most probable first. apart : chance of such a
    difference between the directions where there is none. break_away, presliding : at its zero, None where the log does
    not show it. changes : with what else it changes. left : rms of torque that was not fitted, beside the curve.
    """

    v: FloatArray
    friction: FloatArray
    low: FloatArray
    high: FloatArray
    error: FloatArray
    unit: str
    line: tuple[Quantity, Quantity]
    laws: tuple[Law, ...]
    apart: float
    break_away: Quantity | None = None
    presliding: Quantity | None = None
    changes: tuple[Change, ...] = ()
    left: float | None = None

    def at(self, v: FloatArray) -> FloatArray:
        """Friction at speeds (m,), rad/s or m/s; beyond the knots it goes on as beside them."""
        return splines(v, np.sign(v), self.v[self.v > 0.0]) @ self.friction


def knots(v: FloatArray, block: IntArray) -> FloatArray | None:
    """Knots (k,) of speeds (m,) that occur in both directions, in several blocks of time each.

    block (m,) : number of each sample's. None where they are too few, or too much alike.
    """
    ways = [(np.abs(v[side]), block[side]) for side in (v > 0.0, v < 0.0)]
    if min(s.size for s, _ in ways) < 2 * len(_KNOTS):
        return None
    slow = max(float(np.quantile(s, _KNOTS[0])) for s, _ in ways)
    fast = min(float(np.quantile(s, _KNOTS[-1])) for s, _ in ways)
    for s, of in ways:
        reached = sorted(float(np.max(s[of == one])) for one in np.unique(of))
        fast = min(fast, reached[-min(_BLOCKS, len(reached))])
    inside = np.concatenate([s[(s >= slow) & (s <= fast)] for s, _ in ways])
    if not inside.size or slow <= 0.0:
        return None
    found = [slow]
    for at in np.quantile(inside, _KNOTS[1:-1]):
        if at > _APART * found[-1] and fast > _APART * at:
            found.append(float(at))
    found += [fast] * (fast > _APART * slow)
    return np.array(found) if len(found) >= _FEWEST else None


def splines(v: FloatArray, sign: FloatArray, speeds: FloatArray) -> FloatArray:
    """Shares (m, 2 k) of the values at knots ``speeds`` (k,) in friction at v (m,); sign (m,) : from -1 to 1.

    In the order of the speeds with their signs; a cubic spline between them. Slower than the first and faster than the
    last friction goes straight on.
    """
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(speeds, np.eye(speeds.size))
    s = np.abs(v)
    inside = np.clip(s, speeds[0], speeds[-1])
    ends = np.where((s < inside)[:, None], spline(speeds[0], 1), spline(speeds[-1], 1))
    found = spline(inside) + (s - inside)[:, None] * ends
    back, on = (1.0 - sign[:, None]) / 2.0, (1.0 + sign[:, None]) / 2.0
    return np.hstack((found[:, ::-1] * back, found * on))


_DRAWS, _SEED = 200, 0
"""Of the bootstrap."""


def drawn(normal: FloatArray, pull: FloatArray, rest: FloatArray) -> FloatArray:
    """Numbers (draws, p) under random weights of blocks, exponential with mean one (Rubin 1981, Ann. Statist. 9, 130):
    a block bootstrap that never leaves out the only block in which something is seen.

    normal (b, p, p), pull (b, p) : normal equations by block. rest (p, p) : what is added whatever the weights.
    """
    count, p = pull.shape
    weights = np.random.default_rng(_SEED).standard_exponential((_DRAWS, count))
    weights *= count / weights.sum(axis=1, keepdims=True)
    both = (weights @ normal.reshape(count, -1)).reshape(_DRAWS, p, p) + rest
    return np.asarray(np.linalg.solve(both, (weights @ pull)[:, :, None])[:, :, 0])


def widened(covariance: FloatArray, draws: FloatArray) -> FloatArray:
    """A covariance (p, p) as wide as draws (d, p) scatter where that is more."""
    more = np.maximum(np.std(draws, axis=0, ddof=1) / np.sqrt(np.maximum(np.diag(covariance), 1e-300)), 1.0)
    return np.asarray(covariance * np.outer(more, more))


_TIMES = 20
"""Blocks of a series of friction."""
_FLAT = 1e-10
"""Share of a normal equation that keeps it solvable."""


def of_series(v: FloatArray, friction: FloatArray, units: tuple[str, str]) -> FrictionCurve | None:
    """The curve of friction (m,) that was found at speeds (m,), in the order of time; None of too few speeds."""
    if (speeds := knots(v, _in_time(v.size))) is None:
        return None
    values, spread = _by_blocks(splines(v, np.sign(v), speeds), friction)
    # a line by the samples themselves: beyond the last knot a curve goes on as what is noise beside it
    by = np.column_stack((np.sign(v), v, np.ones_like(v)))
    return curve(speeds, values, spread, v, _TIMES - 1, units, lambda asked: _by_blocks(by[:, [*asked, 2]], friction))


def _in_time(count: int) -> IntArray:
    """The number (m,) of the block of each of so many values."""
    return (np.arange(count) * _TIMES) // max(count, 1)


def _by_blocks(columns: FloatArray, friction: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Numbers (p,) of columns (m, p), in the order of time, and their covariance as blocks of time scatter."""
    block = _in_time(friction.size)
    normal = np.stack([columns[block == b].T @ columns[block == b] for b in range(_TIMES)])
    pull = np.stack([columns[block == b].T @ friction[block == b] for b in range(_TIMES)])
    whole = normal.sum(axis=0)
    rest = _FLAT * float(np.trace(whole)) * np.eye(whole.shape[0])
    values = np.linalg.solve(whole + rest, pull.sum(axis=0))
    noise = float(np.mean((friction - columns @ values) ** 2))
    return values, widened(noise * np.linalg.inv(whole + rest), drawn(normal, pull, rest))


Lines = Callable[[list[int]], tuple[FloatArray, FloatArray]]
"""From which of Coulomb (0) and viscous friction (1) are fitted to these, a constant last, and their covariance."""


def curve(
    speeds: FloatArray,
    values: FloatArray,
    covariance: FloatArray,
    v: FloatArray,
    freedom: int,
    units: tuple[str, str],
    lines: Lines | None = None,
) -> FrictionCurve:
    """A curve of what was fitted. speeds (k,) : knots. values (2 k,) : of splines. v (m,) : speeds that occur.

    freedom : of the errors. units : of Coulomb and viscous friction. lines : how its line is fitted, by default to the
    curve at the speeds that occur.
    """
    from scipy.special import chdtrc, stdtrit

    every = np.concatenate((-speeds[::-1], speeds))
    odd = np.hstack((-np.eye(speeds.size)[::-1], np.eye(speeds.size))) / 2.0
    even = np.abs(odd)
    sure = 1.0 / np.maximum(np.diag(even @ covariance @ even.T), 1e-300)
    # what is the same in both directions whatever the speed
    constant = sure @ even / sure.sum()
    centred = np.eye(every.size) - constant
    friction, spread = centred @ values, centred @ covariance @ centred.T
    error = np.sqrt(np.maximum(np.diag(spread), 0.0))
    wide = float(stdtrit(max(freedom, 1), 0.975)) * error
    uneven = even @ friction
    chance = chdtrc(
        speeds.size - 1, float(uneven @ np.linalg.pinv(even @ spread @ even.T, rcond=1e-9, hermitian=True) @ uneven)
    )
    return FrictionCurve(
        every, friction, friction - wide, friction + wide, error, units[0],
        _line(lines or _along(splines(v, np.sign(v), speeds) @ centred, v, values, covariance), units),
        laws(speeds, odd @ values, odd @ covariance @ odd.T, v.size, units), float(chance),
    )  # fmt: skip


def _along(occur: FloatArray, v: FloatArray, values: FloatArray, covariance: FloatArray) -> Lines:
    """Lines along a curve. occur (m, 2 k) : shares of its values in friction at the speeds (m,) that occur."""
    columns = np.column_stack((np.sign(v), v, np.ones_like(v)))

    def along(asked: list[int]) -> tuple[FloatArray, FloatArray]:
        solved = np.linalg.lstsq(columns[:, [*asked, 2]], occur, rcond=None)[0]
        return solved @ values, solved @ covariance @ solved.T

    return along


def _line(lines: Lines, units: tuple[str, str]) -> tuple[Quantity, Quantity]:
    """Coulomb and viscous friction; where one is not surely above none the other alone: no model takes less."""
    found, errors = np.zeros(2), np.full(2, math.inf)
    asked = [0, 1]
    while asked:
        fitted, spread = lines(asked)
        found[:], errors[:] = 0.0, math.inf
        found[asked], errors[asked] = fitted[:-1], np.sqrt(np.maximum(np.diag(spread)[:-1], 0.0))
        unsure = next((i for i in reversed(asked) if found[i] < _SURE * errors[i]), None)
        if unsure is None or len(asked) == 1:
            break
        asked.remove(unsure)
    f_k, c = (
        Quantity(float(x), float(e), unit) if i in asked else Quantity(0.0, None, unit, _NOT_SURE)
        for i, (x, e, unit) in enumerate(zip(found, errors, units, strict=True))
    )
    return f_k, c


_NOT_SURE = "not surely above none beside the other"
