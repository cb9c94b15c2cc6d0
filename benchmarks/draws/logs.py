"""Logs as machines leave them: an axis that stands still most of the time, an angle that wraps, an arm that carries."""

import math
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import harness
from benchmarks.draws.shared import Answer, log_uniform
from benchmarks.robot_logs.plants import clean
from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.core.recording import Recording
from harness.core.slider import Slider
from harness.exact.decay import Decay, free_decay
from harness.robot.whole_arm.columns import PAYLOAD
from harness.robot.whole_arm.perturb import called, loaded_bodies
from harness.robot.whole_arm.whole import whole_arm

_STEP = 1e-3


def still(seed: int, number: int) -> Answer:
    """A servo's axis at 10 to 40 Hz, irregularly sampled, at rest for most of the time, with friction alone.

    Right where it is adequate and dry friction lies within three of its errors, or a twentieth.
    """
    r = np.random.default_rng([seed, number, 77])
    inertia = log_uniform(r, 3e-3, 0.3)
    damping, friction = inertia / r.uniform(0.3, 1.5), inertia * r.uniform(1.0, 6.0)
    x, v, u = _served(_asked(r), inertia, damping, friction, r)
    rate = r.uniform(10.0, 40.0)
    at = np.cumsum((1.0 + 0.4 * r.uniform(-1.0, 1.0, x.size)) / rate)
    at = (at[at < (x.size - 1) * _STEP] / _STEP).astype(np.int64)
    count = 2.0 * math.pi / 4096
    logged = {
        "x": np.round(x[at] / count) * count,
        "v": v[at] + 0.01 * np.max(np.abs(v)) * r.standard_normal(at.size),
        "u": u[at] + 0.03 * friction * r.standard_normal(at.size),
    }
    channels = {c: logged[c] for c in ("xvu" if number % 2 else "xu")}
    try:
        found = harness.diagnose(Recording(at * _STEP, channels, "log.csv", angular=True), engines=())
    except (InputError, SimulationError) as error:
        return Answer(False, f"refused: {error}")
    told = found.baseline.parameters.get("f_k")
    value, stderr = (told.value, told.stderr) if told else (None, None)
    near = value is not None and abs(value - friction) <= max(3.0 * (stderr or 0.0), 0.05 * friction)
    return Answer(
        found.verdict == "adequate" and near, f"{found.verdict}, f_k {value} of {friction:.4g}, {rate:.0f} Hz"
    )


def _asked(r: np.random.Generator) -> FloatArray:
    """A way (n,), rad, of smooth moves between rests, at every step."""
    move, resting = r.uniform(0.6, 2.0), r.uniform(0.6, 0.96)
    hold = move * resting / (1.0 - resting)
    here, parts = 0.0, [np.zeros(int(hold / _STEP))]
    for _ in range(int(r.integers(8, 24))):
        goal, s = r.uniform(-1.5, 1.5), np.linspace(0.0, 1.0, int(move * r.uniform(0.7, 1.3) / _STEP))
        parts.append(here + (goal - here) * s**3 * (10.0 - 15.0 * s + 6.0 * s**2))
        parts.append(np.full(int(hold * r.uniform(0.5, 1.5) / _STEP), goal))
        here = goal
    return np.concatenate(parts)


def _served(
    way: FloatArray, inertia: float, damping: float, friction: float, r: np.random.Generator
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Position, speed and torque (n,) of an axis that follows a way under a controller, and sticks.

    Its torque is held for a step, in which the motion is exact.
    """
    fast = np.gradient(way, _STEP)
    ahead, own = inertia * np.gradient(fast, _STEP), 2.0 * math.pi * r.uniform(3.0, 6.0)
    x, v, u = np.zeros(way.size), np.zeros(way.size), np.zeros(way.size)
    for k in range(way.size - 1):
        u[k] = inertia * (own**2 * (way[k] - x[k]) + 2.0 * own * (fast[k] - v[k])) + ahead[k]
        x[k + 1], v[k + 1] = _after(x[k], v[k], u[k], inertia, damping, friction)
    u[-1] = u[-2]
    return x, v, u


def _after(x: float, v: float, u: float, inertia: float, damping: float, friction: float) -> tuple[float, float]:
    """Position and speed a step later, under a torque that is held."""
    left, rate = _STEP, damping / inertia
    while left > 0.0 and not (v == 0.0 and abs(u) <= friction):
        side = math.copysign(1.0, v if v != 0.0 else u)
        end = (u - friction * side) / damping
        stops = math.log1p(-v / end) / rate if v * end < 0.0 else math.inf
        t = min(left, stops)
        fade = -math.expm1(-rate * t)
        x, v, left = x + end * t + (v - end) * fade / rate, v + (end - v) * fade, left - t
        if t == stops:
            v = 0.0
    return x, v


def wrapped(seed: int, number: int) -> Answer:
    """A torsional swing of up to three turns, whose angle an encoder gives within one, beside its speed or alone.

    Right where it is adequate and zeta lies within three of its errors.
    """
    r = np.random.default_rng([seed, number, 78])
    w, x0, zeta = log_uniform(r, 2.0, 10.0), 2.0 * math.pi * r.uniform(0.6, 3.0), log_uniform(r, 0.005, 0.05)
    rate = w / (2.0 * math.pi) * log_uniform(r, 60.0, 200.0)
    t = np.arange(int(2.0 * math.pi / w * r.uniform(8.0, 16.0) * rate)) / rate
    moved = free_decay(Decay.of(Slider(1.0, 2.0 * zeta * w, w * w, x0 * log_uniform(r, 0.002, 0.02) * w * w), x0), t)
    x = moved.x + 3e-3 * r.standard_normal(t.size)
    channels = {"x": (x + math.pi) % (2.0 * math.pi) - math.pi}
    if number % 2:
        channels["v"] = moved.v + 3e-3 * x0 * w * r.standard_normal(t.size)
    units = {"t": "s", "x": "rad", "v": "rad/s"}
    with TemporaryDirectory() as folder:
        file = Path(folder) / "log.csv"
        table, head = np.column_stack((t, *channels.values())), ",".join(f"{c} [{units[c]}]" for c in ("t", *channels))
        np.savetxt(file, table, delimiter=",", header=head, comments="")
        try:
            found = harness.diagnose(file, engines=(), restoring="spring", zero="free")
        except InputError as error:
            return Answer(False, f"refused: {error}")
    told = found.baseline.parameters["zeta"]
    near = told.value is not None and abs(told.value - zeta) <= 3.0 * (told.stderr or math.inf)
    return Answer(found.verdict == "adequate" and near, f"{found.verdict}, zeta {told.value} of {zeta:.4g}")


def loads(seed: int, number: int) -> Answer:
    """An arm in closed loop that carries what its user does not say, on one of its last three bodies in turn: right
    where that is told within a twentieth, and where it sits.
    """
    r = np.random.default_rng([seed, number, 79])
    kg, beside = log_uniform(r, 0.5, 5.0), r.uniform(-0.1, 0.1, 3)
    one = clean(seed, number, ("mujoco", "sticking")[number % 2], kg, beside, number % 3)
    on = called(one.arm, loaded_bodies(one.arm, 1 + number % 3)[-1]) if number % 3 else "at the end"
    found = whole_arm(one.log, one.arm)
    named = [name for name, _ in found.named]
    mass = [v.value for e in found.model if PAYLOAD in named for what, v in e.parameters if what == "mass"]
    near = bool(mass) and mass[0] is not None and abs(mass[0] - kg) <= 0.05 * kg
    there = any(f" {on} " in e.statement for e in found.model)
    return Answer(named == [PAYLOAD] and near and there, f"{named}, {mass} of {kg:.3g} kg {on}")
