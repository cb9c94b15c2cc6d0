"""Recordings of which no plain number may be said: no motion, a wrong unit or scale, an impossible sign; by command.

White noise, a stuck sensor, one that drifts; an acceleration in g or cut off at its limit; a velocity 1.66 times too
small; a swing that something drives (negative damping). Besides, whole recordings, of which nothing may be said.
"""

import math
from collections.abc import Callable, Mapping

import numpy as np
from scipy.signal import lfilter

import harness
from benchmarks.draws.shared import Answer, log_uniform
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.slider import Slider
from harness.exact.decay import Decay, free_decay

AT_REST = ("white", "stuck", "drift")
FAULTS = (*AT_REST, "g", "clipped", "scale", "negative")
COMMANDS = ("identify", "compare", "diagnose")
_TOLD = {
    "g": ("9.81",),
    "clipped": ("limit", "saturates"),
    "scale": ("1.66", "0.602"),
    "negative": ("grow", "negative"),
}
"""Of what is said, what tells the fault."""


def decay(r: np.random.Generator, channels: str, damping: float = 1.0) -> tuple[Recording, Recording]:
    """A recording of a free decay, and a simulation of it with positive damping. damping : times a usual ratio."""
    w, x0 = log_uniform(r, 4.0, 20.0), log_uniform(r, 5e-3, 1.0)
    zeta, x_k = damping * log_uniform(r, 0.005, 0.06), x0 * log_uniform(r, 0.002, 0.03)
    span, rate = 2.0 * math.pi / w * r.uniform(6.0, 14.0), w / (2.0 * math.pi) * log_uniform(r, 40.0, 160.0)
    t = np.arange(int(span * rate)) / rate
    clean = _exact(w, zeta, x_k, x0, t)
    zeta = abs(zeta)
    level = log_uniform(r, 3e-4, 5e-3)
    noisy = {c: clean[c] + level * 0.5 * np.ptp(clean[c]) * r.standard_normal(t.size) for c in channels}
    dense = np.arange(int(span * 1.5 * rate)) / (1.5 * rate)
    there = _exact(w, zeta, x_k, x0, dense)
    return Recording(t, noisy, "rec.csv"), Recording(dense, {c: there[c] for c in channels}, "sim.csv")


def _exact(w: float, zeta: float, x_k: float, x0: float, t: FloatArray) -> dict[str, FloatArray]:
    if zeta > 0.0:
        found = free_decay(Decay.of(Slider(1.0, 2.0 * zeta * w, w * w, x_k * w * w), x0), t)
        return {"x": found.x, "v": found.v, "a": found.a}
    # a half-swing after the other about -x_k and x_k, each grown or decayed by exp(-zeta w t)
    wd, at = w * math.sqrt(1.0 - zeta * zeta), 0
    x, v, a = (np.zeros(t.size) for _ in range(3))
    turn, side, begin = x0, 1.0, 0.0
    while at < t.size and turn > x_k:
        here = np.arange(at, int(np.searchsorted(t, begin + math.pi / wd)))
        s, size = t[here] - begin, turn - x_k
        fall = size * np.exp(-zeta * w * s)
        x[here] = side * (x_k + fall * (np.cos(wd * s) + zeta * w / wd * np.sin(wd * s)))
        v[here] = -side * fall * w * w / wd * np.sin(wd * s)
        a[here] = -side * fall * w * w * (np.cos(wd * s) - zeta * w / wd * np.sin(wd * s))
        turn, side, begin = size * math.exp(-zeta * w * math.pi / wd) - x_k, -side, begin + math.pi / wd
        at = int(here[-1]) + 1 if here.size else at
    x[at:] = side * max(turn, 0.0)
    return {"x": x, "v": v, "a": a}


def at_rest(r: np.random.Generator, kind: str) -> Recording:
    """What a sensor shows that nothing moves."""
    n, rate = int(r.integers(300, 3000)), float(r.choice([20, 50, 100, 200, 500]))
    t, fresh, level = np.arange(n) / rate, r.standard_normal(n), log_uniform(r, 1e-4, 1e-1)
    name = str(r.choice(["x", "x", "v", "a"]))
    if kind == "white":
        y = level * (r.uniform(-5.0, 5.0) + lfilter([1.0], [1.0, -r.choice([0.0, 0.0, r.uniform(0.2, 0.9)])], fresh))
    elif kind == "stuck":
        y = np.full(n, level * r.uniform(1.0, 9.0))
        how = r.integers(3)
        if how == 0:
            at = r.integers(0, n, int(r.integers(1, 4)))
            y[at] += level * r.standard_normal(at.size)
        elif how == 1:
            y += 0.01 * level * np.round(r.uniform(0.2, 0.8) + 0.2 * fresh)
        else:
            y += 0.01 * level * np.cumsum(r.random(n) < 3.0 / n)
    else:
        how = r.integers(3)
        slow = (
            np.cumsum(fresh) * 0.1
            if how == 0
            else t / t[-1] * 30.0
            if how == 1
            else 30.0 * (1.0 - np.exp(-4.0 * t / t[-1]))
        )
        y = level * (slow + r.standard_normal(n) * r.uniform(0.1, 1.0))
    return Recording(t, {name: y}, "rec.csv")


def drawn(seed: int, number: int, fault: str) -> tuple[Recording, Recording]:
    """A recording with a fault, and a simulation to compare it with."""
    r = np.random.default_rng([seed, number, FAULTS.index(fault)])
    if fault in AT_REST:
        real = at_rest(r, fault)
        if r.random() < 0.5:
            return real, Recording(*_alike(at_rest(r, fault), next(iter(real.channels))), "sim.csv")
        _, sim = decay(r, "xva")
        return real, sim
    channels = {"g": "xa", "clipped": str(r.choice(["xa", "a"])), "scale": "xv"}.get(
        fault, str(r.choice(["x", "xa", "xv"]))
    )
    real, sim = decay(r, channels, -1.0 if fault == "negative" else 1.0)
    y = dict(real.channels)
    if fault == "g":
        y["a"] = y["a"] * 9.80665 ** float(r.choice([-1.0, 1.0]))
    elif fault == "clipped":
        end = r.uniform(0.4, 0.85) * 0.5 * float(np.ptp(y["a"]))
        y["a"] = np.clip(y["a"], -end, end)
    elif fault == "scale":
        y["v"] = y["v"] / 1.66
    return Recording(real.t, y, "rec.csv"), sim


def _alike(other: Recording, channel: str) -> tuple[FloatArray, dict[str, FloatArray]]:
    return other.t, {channel: next(iter(other.channels.values()))}


def answer(seed: int, number: int, *, fault: str, command: str) -> Answer:
    """Right where a recording at rest is refused, or differs from what moves, and where the fault is told."""
    real, sim = drawn(seed, number, fault)
    try:
        said, plain = _SAID[command](real, sim)
    except InputError as error:
        return Answer(
            fault in AT_REST or any(word in str(error) for word in _TOLD[fault]), f"{fault}: refused: {error}"
        )
    told = any(word in line for line in said for word in _TOLD.get(fault, ()))
    right = not plain if fault in AT_REST else told or (command == "compare" and fault == "negative" and not plain)
    return Answer(right, f"{fault}: {' | '.join(line[:110] for line in said[:3])}")


def _identified(real: Recording, sim: Recording) -> tuple[list[str], bool]:
    found = harness.identify(real)
    numbers = [p.value for one in found.estimates.values() for p in (one.zeta, one.x_k)]
    return found.warnings, any(value is not None for value in numbers)


def _compared(real: Recording, sim: Recording) -> tuple[list[str], bool]:
    found = harness.compare(sim, real)
    return [found.verdict, *found.sentences], found.verdict != "different"


def _diagnosed(real: Recording, sim: Recording) -> tuple[list[str], bool]:
    found = harness.diagnose(real, engines=())
    notes = [*found.warnings, *found.recording.notes, *(m.statement for m in found.mechanisms)]
    return [found.verdict, *notes], True


_SAID: Mapping[str, Callable[[Recording, Recording], tuple[list[str], bool]]] = {
    "identify": _identified, "compare": _compared, "diagnose": _diagnosed,
}  # fmt: skip


def whole(seed: int, number: int) -> Answer:
    """Right where nothing is said against a whole recording, and a right simulation of it is the same within noise."""
    r = np.random.default_rng([seed, number, 99])
    real, sim = decay(r, str(r.choice(["x", "xa", "xv", "a"])))
    try:
        against = harness.identify(real).warnings
        verdict = harness.compare(sim, real).verdict
    except InputError as error:
        return Answer(False, f"refused: {error}")
    return Answer(not against and verdict == "same within noise", f"{verdict}, against: {against}")
