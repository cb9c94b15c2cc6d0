"""Laws that may say a friction curve, and which says it best."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.quantity import Quantity

_TRIED = 12
"""Values of what is not linear in a law."""
_SAID = 0.01
"""Probability from which a law is listed."""


@dataclass(frozen=True, slots=True)
class Law:
    """One way to say a curve. probability : beside the other laws. parameters : by name."""

    name: str
    probability: float
    parameters: tuple[tuple[str, Quantity], ...]


Columns = Callable[[FloatArray, float], tuple[FloatArray, ...]]


@dataclass(frozen=True, slots=True)
class _Form:
    """names : of the numbers, what is not linear last. columns : for speeds (k,) at a value of that. positive : the
    last linear number is above 0."""

    names: tuple[str, ...]
    columns: Columns
    values: Callable[[FloatArray], FloatArray] | None = None
    positive: bool = False


def _within(s: FloatArray) -> FloatArray:
    return np.geomspace(s[0], s[-2], _TRIED)


_FORMS = {
    "Coulomb": _Form(("f_k",), lambda s, _: (np.ones_like(s),)),
    "Coulomb and viscous": _Form(("f_k", "c"), lambda s, _: (np.ones_like(s), s)),
    "Stribeck": _Form(
        ("f_k", "c", "f_s - f_k", "v_s"), lambda s, x: (np.ones_like(s), s, np.exp(-((s / x) ** 2))), _within, True
    ),
    "Stribeck, Lorentzian": _Form(
        ("f_k", "c", "f_s - f_k", "v_s"), lambda s, x: (np.ones_like(s), s, 1.0 / (1.0 + (s / x) ** 2)), _within, True
    ),
    "power of speed": _Form(
        ("f_k", "c", "exponent"),
        lambda s, x: (np.ones_like(s), s**x),
        lambda _: np.array([0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.25, 1.5, 1.75, 2.0]),
    ),
    "saturating with speed": _Form(
        ("f_k", "rise", "v_0"), lambda s, x: (np.ones_like(s), np.tanh(s / x)), _within, True
    ),
    "quadratic drag": _Form(("f_k", "c", "c_2"), lambda s, _: (np.ones_like(s), s, s**2)),
}


@dataclass(slots=True)
class _Tried:
    worth: float = math.inf
    numbers: FloatArray = field(default_factory=lambda: np.empty(0))
    errors: FloatArray = field(default_factory=lambda: np.empty(0))
    value: float = 0.0


def laws(
    s: FloatArray, friction: FloatArray, covariance: FloatArray, samples: int, units: tuple[str, str]
) -> tuple[Law, ...]:
    """Laws by their probability: chi-square of the mean of both directions and the usual price of a number (BIC)."""
    power, turn = np.linalg.eigh(covariance)
    root = turn / np.sqrt(np.maximum(power, 1e-9 * power[-1]))
    found = {}
    for name, form in _FORMS.items():
        if len(form.names) > s.size:
            continue
        best = _Tried()
        for value in (0.0,) if form.values is None else form.values(s):
            columns = root.T @ np.column_stack(form.columns(s, float(value)))
            inverse = np.linalg.pinv(columns.T @ columns)
            numbers = inverse @ columns.T @ (root.T @ friction)
            if form.positive and numbers[-1] <= 0.0:
                continue
            worth = float(np.sum((root.T @ friction - columns @ numbers) ** 2)) + len(form.names) * math.log(samples)
            if worth < best.worth:
                best = _Tried(worth, numbers, np.sqrt(np.diag(inverse)), float(value))
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
    if form.values is not None:
        last = form.names[-1]
        told.append((last, Quantity(one.value, None, unit[last], "the nearest of the values that were tried")))
    return tuple(told)
