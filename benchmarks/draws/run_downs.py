"""Run-downs by scipy's integrator, of four machines with the nuisances of their sensors, and an effect in half of them.

A motor that is switched off (cogging), a wheel, a car that coasts on a grade, a turntable. Forces are written as their
trades write them: torque over inertia, rolling and drag of a car, a groove's friction; none of our formulas is called.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.integrate import solve_ivp

import harness
from benchmarks.draws.shared import Answer
from harness.core.arrays import FloatArray
from harness.core.errors import HarnessError
from harness.core.recording import Recording
from harness.results.diagnosis import DiagnosisResult

MACHINES = ("motor", "wheel", "car", "turntable")
EFFECTS = ("stribeck", "quadratic-drag", "power-law-damping", "force-ripple")
LEAST, _TRIES = 60.0, 50
"""Chi-square that an effect must be worth, above what decides among names, and draws until one is."""
_NOTHING = Recording(np.arange(60.0), {"x": np.arange(60.0)})
Slowing = Callable[[float, float], float]
"""Deceleration, 1/s^2, at a place and a speed above 0."""


@dataclass(frozen=True, slots=True)
class Drawn:
    """A run-down. truth : c and f_k per inertia, and what the effect's first number is. effect : "" of a control.

    clean : the channel (n,) without noise, and the place (n,). stop : s. sigma : of the noise, that of stamps included.
    """

    recording: Recording
    effect: str
    machine: str
    truth: dict[str, float] = field(default_factory=dict)
    clean: dict[str, tuple[FloatArray, FloatArray]] = field(default_factory=dict)
    stop: float = math.inf
    sigma: float = 1.0


def _run(slowing: Slowing, v0: float, longest: float, fine: float) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Times, places, speeds until it stops or the time is over, and the time of the stop."""

    def stopped(t: float, y: FloatArray) -> float:
        return float(y[1]) - 1e-7 * v0

    stopped.terminal, stopped.direction = True, -1  # type: ignore[attr-defined]
    run = solve_ivp(
        lambda _, y: (y[1], -slowing(y[0], y[1])), (0.0, longest), (0.0, v0), method="DOP853", rtol=1e-10,
        atol=1e-10 * v0, max_step=fine, events=stopped, dense_output=True,
    )  # fmt: skip
    end = float(run.t[-1])
    t = np.linspace(0.0, end, max(int(8 * end / fine), 20_000))
    x, v = run.sol(t)
    return t, x, v, end


def drawn(seed: int, number: int, effect: str | None = None) -> Drawn:
    """One draw; effect : "" for none, None for any or none."""
    r = np.random.default_rng([seed, number])
    machine = str(r.choice(MACHINES))
    if effect is None:
        effect = str(r.choice(["", *EFFECTS]))
    v0 = {"motor": 2.0 * math.pi * r.uniform(8, 40), "wheel": r.uniform(10, 60), "car": r.uniform(8, 30),
          "turntable": r.uniform(3, 9)}[machine]  # fmt: skip
    seconds = r.uniform(1.0, 8.0) if machine == "motor" else r.uniform(5.0, 60.0)
    # what slows it at half its speed, per second: by dry friction and by damping
    wet = r.uniform(0.2, 0.75)
    f = (1.0 - wet) * v0 / seconds * r.uniform(1.0, 2.0)
    c = wet / seconds * r.uniform(1.0, 2.0)
    size = r.uniform(0.25, 0.8)
    truth = {"c": c, "f_k": f}
    more: Slowing = lambda x, v: 0.0  # noqa: E731
    if effect == "stribeck":
        v_s = v0 * r.uniform(0.06, 0.2)
        more = lambda x, v: size * f * math.exp(-((v / v_s) ** 2))  # noqa: E731
        truth["f_s"] = (1.0 + size) * f
    elif effect == "quadratic-drag":
        c2 = size * (f + c * v0) / v0**2
        more = lambda x, v: c2 * v * v  # noqa: E731
        truth["c2"] = c2
    elif effect == "power-law-damping":
        p = r.uniform(0.3, 0.6)
        more = lambda x, v: size * (f + c * v0) * (max(v, 0.0) / v0) ** p  # noqa: E731
    elif effect == "force-ripple":
        teeth, phase = int(r.integers(2, 13)), r.uniform(0.0, 2.0 * math.pi)
        turn = 2.0 * math.pi if machine != "car" else 2.0
        wave = 2.0 * math.pi * teeth / turn
        more = lambda x, v: size * f * math.cos(wave * x + phase)  # noqa: E731
        truth["amplitude"] = size * f
    fine = seconds / 400.0 if effect != "force-ripple" else 0.25 / (wave * v0) * 2.0 * math.pi
    t, x, v, end = _run(lambda x, v: f + c * v + more(x, v), v0, 3.0 * seconds, fine)
    return _sensed(r, Drawn(_NOTHING, effect, machine, truth, stop=end), t, x, v)


def _sensed(r: np.random.Generator, one: Drawn, t: FloatArray, x: FloatArray, v: FloatArray) -> Drawn:
    """As the machine's sensor tells it, with a rest or a cut at the end."""
    n, machine, end = int(r.integers(400, 4000)), one.machine, one.stop
    last = end * (r.uniform(1.01, 1.3) if r.random() < 0.6 else r.uniform(0.6, 0.95))
    at = np.linspace(0.0, last, n)
    late = 0.1 * at[1] * r.standard_normal(n) if r.random() < 0.5 else np.zeros(n)
    when = np.clip(at + late, 0.0, last)
    place, speed = np.interp(when, t, x), np.where(when > end, 0.0, np.interp(when, t, v))
    noise = r.standard_normal(n)
    if machine == "car" or (machine == "wheel" and r.random() < 0.5):
        shown = speed + v[0] * 10.0 ** r.uniform(-3.0, -2.0) * noise
        if r.random() < 0.4:
            step = v[0] * 10.0 ** r.uniform(-3.3, -2.3)
            shown = step * np.round(shown / step)
        clean = {"v": (np.where(at > end, 0.0, np.interp(at, t, v)), np.interp(at, t, x))}
        told = Recording(at, {"v": shown}, "run.csv", angular=machine == "wheel")
        return replace(one, recording=told, clean=clean, sigma=float(np.std(shown - speed)))
    turn = 2.0 * math.pi / float(r.choice([1024, 2048, 4096, 10000]))
    shown = place + turn * 10.0 ** r.uniform(-0.6, 0.5) * noise
    if r.random() < 0.5:
        shown = turn * np.round(shown / turn)
    true = np.interp(at, t, x)
    told = Recording(at, {"x": shown + r.uniform(-3.0, 3.0)}, "run.csv", angular=True)
    return replace(one, recording=told, clean={"x": (true, true)}, sigma=float(np.std(shown - true)))


def worth(one: Drawn) -> float:
    """Chi-square that viscous and dry friction leave of an effect in speeds, or places, without noise (by scipy alone).

    Of a speed v(t) they make v0 - f t - c x; of a place its integral.
    """
    t, said = one.recording.t, one.clean
    name = next(iter(said))
    y, x = said[name]
    way = np.concatenate(([0.0], np.cumsum(0.5 * np.diff(t) * (x[1:] + x[:-1]))))
    columns = [np.ones_like(t), t, x] if name == "v" else [np.ones_like(t), t, t**2, way]
    moving = t < one.stop
    table = np.column_stack(columns)[moving]
    left = y[moving] - table @ np.linalg.lstsq(table, y[moving], rcond=None)[0]
    return float(np.sum((left / one.sigma) ** 2))


def named(seed: int, number: int) -> Answer:
    """Right where the hidden effect, worth ``LEAST`` in chi-square or more, is named."""
    tries = (drawn(seed, number + 1000 * again, EFFECTS[number % len(EFFECTS)]) for again in range(_TRIES))
    return _answer(next(one for one in tries if worth(one) >= LEAST))


def controls(seed: int, number: int) -> Answer:
    """Right where nothing is claimed of a run-down of viscous and Coulomb friction alone."""
    return _answer(drawn(seed, number, ""))


def off_by(found: DiagnosisResult, one: Drawn) -> dict[str, float]:
    """By how many standard errors each number that has one is off."""
    said = dict(found.refined.parameters)
    for mechanism in found.mechanisms:
        said |= mechanism.parameters
    return {
        name: (p.value - one.truth[name]) / p.stderr
        for name, p in said.items()
        if name in one.truth and p.value is not None and p.stderr
    }


def both_ways(seed: int, number: int) -> Answer:
    """Right where a push is told from dry friction by run-downs in two directions; of every second there is none."""
    r = np.random.default_rng([seed, number, 2])
    machine, seconds = str(r.choice(MACHINES)), r.uniform(5.0, 40.0)
    v0, share, wet = r.uniform(5.0, 40.0), r.uniform(0.1, 0.6) * (number % 2), r.uniform(0.2, 0.75)
    f, c = (1.0 - wet) * v0 / seconds, wet / seconds
    push = share * f * r.choice([-1.0, 1.0])
    whole = Drawn(_NOTHING, "constant-force" if share else "", machine, {"c": c, "f_k": f, "force": push})
    parts = []
    for side, begun in ((1.0, v0), (-1.0, v0 * r.uniform(0.6, 1.0))):
        t, x, v, end = _run(lambda x, v: f + c * v - side * push, begun, 4.0 * seconds, seconds / 400.0)  # noqa: B023
        parts.append(_sensed(r, replace(whole, stop=end), t, x, v).recording)
    told = [replace(parts[0], file="there.csv"), replace(parts[1].turned(), file="back.csv")]
    # one sensor reads both
    common = {"x", "v"} & set(told[0].channels) & set(told[1].channels)
    return _answer(whole, told) if common else both_ways(seed, number + 10_000)


def _answer(one: Drawn, of: Sequence[Recording] = ()) -> Answer:
    try:
        found = harness.diagnose(of or one.recording, engines=())
    except HarnessError as error:
        return Answer(False, f"{one.machine} {one.effect}: {error}")
    names = [m.name for m in found.mechanisms]
    right = names == [one.effect] if one.effect else found.verdict == "adequate"
    held = off_by(found, one)
    errors = ", ".join(f"{name} {z:+.1f}" for name, z in held.items())
    return Answer(right, f"{one.machine} {one.effect or 'nothing'}: {found.verdict} {names}; errors {errors}")
