"""Laws that may say a friction curve, and which says it best."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

from harness.core.arrays import FloatArray
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
