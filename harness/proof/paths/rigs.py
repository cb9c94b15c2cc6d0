"""Machines of each way, what their sensors show, and how much an effect is worth in them."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.linalg import cholesky_banded, orth, solve_banded
from scipy.optimize import least_squares
from scipy.signal import lfilter

from harness.core.arrays import FloatArray
from harness.proof.paths import plant
from harness.proof.paths.forms import (
    AXIS,
    CURVE,
    DECAY,
    DOWN,
    JOINT,
    SERVO,
    SHAKEN,
    SIMULATED,
    SLOW,
    SPRING,
    SWING,
    TOGETHER,
    Rng,
    Scales,
    _between,
    laws,
)  # fmt: skip

NONE = np.zeros((3, plant.TABLE))
"""Tables of no effect."""
BARE = np.zeros(plant.SIZE)
"""Numbers of no effect."""
_NOISE = {"x": 0, "v": 0, "a": 1, "u": 2}
_FAST = 1
"""Place of the noise of a joint's speed, which is logged beside its position."""
_USUAL = np.array([1.0, 0.1, 1e-3, 0.1, 1e-3, 1e-3])
"""By which a base that is fitted to a motion may be off: of m, c, k and f_k their logarithms, of its start shares."""
_STEP = 1e-3
"""Of a difference, in what is usual: far more than reversals are found to."""
_STAGES = ((0.1, "soft_l1", 8), (0.3, "soft_l1", 8), (0.6, "soft_l1", 8), (1.0, "linear", 20))
"""Shares of a motion that a base is fitted to one after another, how squares count, and tries: the last half-cycle is
another one where friction is a little off, and a sample beside a reversal lies on its other side, so that a descent
from far off ends beside the best."""
COMMANDED = 1e-4
"""Of its rms, what an amplifier adds to a force that is logged as it was asked for: none gives it better, and without
it an effect of a hundred thousandth of the friction would show."""
_RESTING = 0.01
"""Of the fastest speed: slower is rest."""


@dataclass(frozen=True, slots=True, eq=False)
class Rig:
    """What does not change when an effect is made larger.

    b : m, c, k, f_k, and 1 of what swings. start : x and v. drive : of what moves it. held : whether its force is
    constant between samples. sigma : noise by channel of x, a, u. colour : of neighbouring samples. count : of an
    encoder, 0 for noise. zero : of its x. channels : shown. rest : s before it is let go. every : of a controller's
    ticks one is logged. unseen : of a force, what acts from one sample to the next and no sample tells.
    """

    path: str
    b: FloatArray
    dt: float
    start: tuple[float, float]
    drive: tuple[FloatArray, ...]
    held: bool
    fine: int
    numbers: tuple[float, ...] = ()
    gains: FloatArray | None = None
    channels: str = "x"
    sigma: tuple[float, float, float] = (1.0, 1.0, 0.0)
    colour: float = 0.0
    count: float = 0.0
    zero: float = 0.0
    rest: float = 0.0
    every: int = 1
    unseen: float = 0.0

    @property
    def driven(self) -> bool:
        """Whether its force is measured."""
        return self.path in (SPRING, SHAKEN, AXIS, SLOW, JOINT)

    def run(self, p: FloatArray, tables: FloatArray = NONE, b: FloatArray | None = None,
            start: tuple[float, float] | None = None) -> FloatArray:  # fmt: skip
        """True motion (n, 5): x, v, a, u and work against friction."""
        b = self.b if b is None else b
        if self.path in (AXIS, JOINT):
            return self.ticks(b, p, tables)[:: self.every]
        if self.path == SERVO:
            assert self.gains is not None
            return plant.served(self.drive[0], self.dt, self.every, self.gains, b, p, tables)
        if self.path == SLOW:
            (r, rv), (stiff, damp) = self.drive, self.numbers
            return plant.pushed(r, rv, stiff, damp, self.dt, self.fine, b, p, tables)
        if self.path == CURVE:
            v = self.drive[0]
            wet = np.array([plant.wet(0.0, w, 0.0, b, p, tables) for w in v])
            dry = np.array([plant.dry(0.0, w, 0.0, 0.0, b, p, tables) for w in v])
            return np.column_stack([0.0 * v, v, 0.0 * v, wet + np.sign(v) * dry, 0.0 * v])
        x0, v0 = self.start if start is None else start
        return plant.given_force(self.drive[0], self.held, self.dt, self.fine, x0, v0, b, p, tables)

    def begun(self, count: int) -> "Rig":
        """With the first samples alone of the force that moves it."""
        return replace(self, drive=(self.drive[0][: count if self.held else (count - 1) * self.fine + 1],))

    def ticks(self, b: FloatArray, p: FloatArray, tables: FloatArray = NONE) -> FloatArray:
        """Of a controller's axis, at every tick, (m, 5)."""
        assert self.gains is not None
        (r, rv, ra), tick = self.drive, self.dt / self.every
        return plant.controlled(r, rv, ra, self.numbers[0], self.gains, tick, self.fine, b, p, tables)

    def scales(self, run: FloatArray) -> Scales:
        """Of a motion without effects."""
        m, c, k, f_k, _ = map(float, self.b)
        fast = float(np.percentile(np.abs(run[:, 1]), 98))
        slow = math.sqrt(m / k) if k else 0.05 * self.dt * len(run)
        return Scales(m, c, k, f_k, fast, float(np.max(np.abs(run[:, 0]))) or 1.0, self.dt * len(run), slow, self.dt)


def shown(rig: Rig, run: FloatArray, p: FloatArray) -> dict[str, FloatArray]:
    """Channels without noise, (n,) each: x, v, a, u as sensors of such a lag, limit and drift show them."""
    t, x, a = np.arange(len(run)) * rig.dt, run[:, 0], run[:, 2]
    if p[plant.LATE] != 0.0:
        late, form = p[plant.LATE], p[plant.LATE_FORM]
        if form == 0.0:
            x = np.interp(t - late, t, x)
        else:
            # exact between samples that straight lines join
            tau = late / form / rig.dt
            pole = math.exp(-1.0 / tau)
            for _ in range(int(form)):
                x = x[0] + lfilter([1.0 - (1.0 - pole) * tau, (1.0 - pole) * tau - pole], [1.0, -pole], x - x[0])
    if p[plant.WANDER] != 0.0:
        x = x + p[plant.WANDER] * (1.0 - np.exp(-t / p[plant.WANDER_T]))
    if p[plant.CLIP] != 0.0:
        # soft: the more the nearer its range
        top = np.max(np.abs(a)) / p[plant.CLIP]
        a = a / (1.0 + np.abs(a / top) ** 6) ** (1.0 / 6.0)
    return {"x": x, "v": run[:, 1], "a": a, "u": run[:, 3]}


def effective(rig: Rig) -> float:
    """Samples that are worth one, of noise that remembers."""
    return (1.0 - rig.colour) / (1.0 + rig.colour)


def loss(rig: Rig, p: FloatArray, tables: FloatArray = NONE) -> float:
    """Log-likelihood that the base model is expected to lose, in effective samples: half its chi-square there.

    Of a free motion, or one under a given force, the base is fitted to the whole; of an axis, to what its equation of
    motion leaves; of a curve, to its points; of a servo, by what small changes of its numbers move. A force with noise
    tells no more than that lets.
    """
    run = rig.run(p, tables)
    if not np.all(np.isfinite(run)) or np.max(np.abs(run)) > 1e9:
        return math.nan
    if rig.path == CURVE:
        off = _without(run[:, 3], [run[:, 1], np.sign(run[:, 1])])
        return 0.5 * float(np.sum((off / rig.sigma[2]) ** 2))
    if rig.path in (AXIS, SLOW, JOINT):
        extra, columns = extra_force(rig, run)
        u = math.hypot(rig.sigma[2], rig.unseen)
        return followed(extra, run[:, 1], columns, rig.dt, rig.b[0], rig.sigma[0], u, effective(rig))
    if rig.path == SERVO:
        off = run[:, 0] - rig.run(BARE)[:, 0]
        return 0.5 * float(np.sum((_without(off, _moved(rig)) / rig.sigma[0]) ** 2))
    seen = shown(rig, run, p)
    told = [(c, rig.sigma[_NOISE[c]]) for c in rig.channels if c != "u"]
    span = float(np.max(np.abs(run[:, 0]))), float(np.max(np.abs(run[:, 1])))

    @lru_cache(maxsize=1)
    def kept(z: tuple[float, ...], share: float) -> FloatArray:
        q, b = _USUAL * z, rig.b.copy()
        b[:4] *= np.exp(np.clip(q[:4], -5.0, 5.0) * ([rig.driven, 1.0, 1.0, 1.0] * (b[:4] > 0.0)))
        begun = rig.begun(math.ceil(share * len(run)))
        again = begun.run(BARE, NONE, b, (rig.start[0] + q[4] * span[0], rig.start[1] + q[5] * span[1]))
        bare = shown(begun, again, BARE)
        parts = [(seen[c][: len(again)] - bare[c]) / sigma for c, sigma in told]
        parts[0] = parts[0] - (np.mean(parts[0]) if "x" in rig.channels and rig.zero else 0.0)
        return np.nan_to_num(np.concatenate(parts), nan=1e6, posinf=1e6, neginf=-1e6)

    # a copy, which the solver weighs in place; it asks for slopes where it asked last
    def left(z: FloatArray, share: float) -> FloatArray:
        return kept((*z,), share).copy()

    def slopes(z: FloatArray, share: float) -> FloatArray:
        here = left(z, share)
        return np.column_stack([(left(z + step, share) - here) / _STEP for step in _STEP * np.eye(6)])

    z, cost = np.zeros(6), 0.0
    for share, counts, tries in _STAGES:
        found = least_squares(left, z, slopes, loss=counts, max_nfev=tries, args=(share,))
        z, cost = found.x, float(found.cost)
    worth = cost * effective(rig)
    if not rig.driven:
        return worth
    extra, columns = extra_force(rig, run)
    return min(worth, _left(extra, run[:, 1], columns, rig.sigma[2])[1])


@lru_cache(maxsize=2)
def _moved(rig: Rig) -> list[FloatArray]:
    """What small changes of a servo's numbers and of its encoder's zero do to its positions, (n,) each."""
    assert rig.gains is not None
    x, size = rig.run(BARE)[:, 0], rig.gains.size
    found = [np.ones_like(x)]
    for i in range(4 + size):
        b, gains = rig.b.copy(), rig.gains.copy()
        changed, at = (b, i) if i < 4 else (gains, i - 4)
        if at == plant.STEP and i >= 4:
            continue
        changed[at] += 0.01 * changed[at] if changed[at] else 0.0
        found.append(replace(rig, gains=gains).run(BARE, b=b)[:, 0] - x)
    return found


def _without(y: FloatArray, columns: list[FloatArray]) -> FloatArray:
    """What columns leave of y, (n,)."""
    table = np.column_stack(columns)
    return np.asarray(y - table @ np.linalg.lstsq(table, y, rcond=None)[0])


def extra_force(rig: Rig, run: FloatArray) -> tuple[FloatArray, list[FloatArray]]:
    """What the base equation lacks along a motion, N, (n,), and the base's columns."""
    x, v, a, u, _ = run.T
    side: FloatArray = np.sign(v)
    own: list[FloatArray] = [np.asarray(v, dtype=np.float64), side]
    bare = [plant.wet(x[i], v[i], 0.0, rig.b, BARE, NONE) + side[i] * rig.b[3] for i in range(x.size)]
    place = np.sin(x) if rig.b[4] else x
    if rig.path == CURVE:
        return u - np.array(bare), own
    # of what nothing drives the acceleration is the sum of all the others
    own += [np.ones_like(x), *([a] if rig.driven else []), *([place] if rig.b[2] else [])]
    return u - rig.b[0] * a - np.array(bare), own


def _left(extra: FloatArray, v: FloatArray, columns: list[FloatArray], sigma: float) -> tuple[FloatArray, float]:
    """What columns leave of a force along a motion, N, (n,), and what that is worth beside its noise."""
    moving = np.abs(v) > _RESTING * np.max(np.abs(v))
    extra = np.where(moving, extra, 0.0)
    extra[moving] = _without(extra[moving], [c[moving] for c in columns])
    return extra, 0.5 * float(np.sum((extra / sigma) ** 2)) if sigma > 0.0 else math.inf


def followed(
    extra: FloatArray, v: FloatArray, columns: list[FloatArray], dt: float, m: float, x: float, u: float,
    worth: float = 1.0,
) -> float:  # fmt: skip
    """Loss of what columns leave of a force, (n,), that moves a mass m: no estimator finds more in position and force.

    The position has noise x, samples of which are ``worth`` so much, and the force noise u: what the equation of motion
    leaves has the covariance of both, the position's differentiated twice. At rest friction is anything.
    """
    resting = np.abs(v) <= _RESTING * np.max(np.abs(v))
    of_force = np.where(resting, np.max(np.abs(extra)), u)[1:-1] ** 2
    second = (m * x / dt**2) ** 2 / worth
    bands = second * np.array([6.0, -4.0, 1.0])[:, None] + np.stack((of_force, 0.0 * of_force, 0.0 * of_force))
    table = np.column_stack([np.where(resting, 0.0, extra), *columns])[1:-1]
    white = solve_banded((2, 0), cholesky_banded(bands, lower=True), table)
    return 0.5 * float(np.sum(_without(white[:, 0], [*white[:, 1:].T]) ** 2))


def unseen(u: FloatArray, every: int) -> float:
    """Standard deviation of a force's mean from one sample to the next about what four samples tell of it by least
    squares; u (m,) : at every tick, of which one in ``every`` is logged."""
    told = u[::every]
    mean = np.mean(u[: (told.size - 1) * every].reshape(-1, every), axis=1)
    beside = [told[i : told.size - 3 + i] for i in range(4)]
    return float(np.std(_without(mean[1 : told.size - 2], [np.ones(told.size - 3), *beside])))


def laws_of(rig: Rig, p: FloatArray, tables: FloatArray) -> dict[str, float]:
    """The share of an unknown effect's squares that each law of the catalogue takes beside the base."""
    run = rig.run(p, tables)
    return projected(run[:, 0], run[:, 1], rig.dt, *extra_force(rig, run))


def projected(
    x: FloatArray, v: FloatArray, dt: float, extra: FloatArray, columns: list[FloatArray]
) -> dict[str, float]:
    """The share of a force's squares, (n,), that each law takes beside columns along a motion."""
    moving = np.abs(v) > 0.02 * np.max(np.abs(v))
    basis = orth(np.column_stack([c[moving] / max(np.max(np.abs(c)), 1e-300) for c in columns]), 1e-9)
    y = extra[moving] - basis @ (basis.T @ extra[moving])
    found: dict[str, float] = {}
    for name, tries in laws(x[moving], v[moving], dt * np.flatnonzero(moving).astype(np.float64)).items():
        for law in tries:
            own = np.atleast_2d(law).T
            left = _without(y, [*(own - basis @ (basis.T @ own)).T])
            found[name] = max(found.get(name, 0.0), 1.0 - float(np.sum(left**2) / max(np.sum(y**2), 1e-300)))
    return found


def spoiled(rig: Rig, clean: dict[str, FloatArray], rng: Rng) -> dict[str, FloatArray]:
    """Channels as they are logged: noise, steps, a zero of its own."""
    found = {}
    for c in rig.channels:
        y = clean[c]
        if rig.path == CURVE:
            found[c] = y if c == "v" else y + rig.sigma[2] * rng.standard_normal(y.size)
            continue
        if c == "x" and rig.count and rig.path != SERVO:
            found[c] = np.floor(y / rig.count + 0.5) * rig.count + rig.zero
            continue
        r = rig.colour if c != "u" else 0.0
        if rig.path == SERVO:
            # the encoder's step is on what it shows
            y = y + rig.zero + rig.sigma[1] * rng.standard_normal(y.size)
            found[c] = np.floor(y / rig.count + 0.5) * rig.count
            continue
        noise = lfilter([math.sqrt(1.0 - r * r)], [1.0, -r], rng.standard_normal(y.size + 50))[50:]
        sigma = rig.sigma[_FAST if rig.driven and c == "v" else _NOISE[c]]
        found[c] = y + sigma * noise + (rig.zero if c == "x" else 0.0)
    return found


def draw_rig(path: str, rng: Rng, both: bool = False) -> Rig:
    """A machine of a way. both : x and a are shown of a free decay, both directions of a curve."""
    if path in (DECAY, SWING, TOGETHER, SIMULATED):
        rig = _let_go(path, rng, both)
    elif path in (SPRING, SHAKEN):
        rig = _shaken(path, rng)
    elif path == CURVE:
        rig = _curve(rng, both)
    else:
        rig = {AXIS: _axis, SLOW: _slow, DOWN: _run_down, JOINT: _joint, SERVO: _servo}[path](rng)
    if path == CURVE:
        size = float(np.std(rig.run(BARE)[:, 3]))
        return replace(rig, channels="vu", sigma=(1.0, 1.0, size * 10.0 ** rng.uniform(-3.0, -1.8)))
    return rig if path in (JOINT, SERVO) else _with_sensors(rig, rng)


def _with_sensors(rig: Rig, rng: Rng) -> Rig:
    run = rig.run(BARE)
    far, hard = float(np.std(run[:, 1 if "v" in rig.channels else 0])), float(np.std(run[:, 2]))
    coarse = _between(rng, 2e-4, 5e-3) if not rig.driven else _between(rng, 2e-5, 3e-3)
    encoder = rig.path == AXIS or ("x" in rig.channels and rng.random() < 0.3)
    count = (rig.numbers[0] if rig.path == AXIS else far * coarse * 3.0) if encoder else 0.0
    noisy = rig.driven and (not rig.held or rng.random() < 0.3)
    force = float(np.std(run[:, 3])) * (_between(rng, 3e-4, 2e-2) if noisy else rig.driven * COMMANDED)
    sigma = (count / math.sqrt(12.0) if encoder else far * coarse, hard * _between(rng, 2e-3, 2e-2), force)
    colour = float(rng.uniform(0.2, 0.7)) if not encoder and rng.random() < 0.25 else 0.0
    moved = rig.path != SPRING and "x" in rig.channels and rng.random() < 0.5
    zero = far * float(rng.uniform(-0.5, 0.5)) if moved and not rig.b[4] else 0.0
    return replace(rig, sigma=sigma, colour=colour, count=count, zero=zero)


def _slider(rng: Rng, swings: bool, wet: tuple[float, float], dried: tuple[float, float]) -> tuple[float, FloatArray]:
    """How far it goes, m or rad, and m, c, k, f_k, whether it swings."""
    omega, m = _between(rng, 3.0, 60.0 if not swings else 12.0), _between(rng, 0.3, 3.0)
    k, size = m * omega**2, rng.uniform(0.35, 1.1) if swings else _between(rng, 0.005, 0.1)
    b = [m, 2.0 * _between(rng, *wet) * m * omega, k, _between(rng, *dried) * k * size, float(swings)]
    return size, np.array(b)


def _let_go(path: str, rng: Rng, both: bool) -> Rig:
    swings = path == SWING
    size, b = _slider(rng, swings, (0.003, 0.03), (0.003, 0.03))
    # of a free motion only ratios show
    b[:4] /= b[0]
    omega, per = math.sqrt(b[2]), _between(rng, 30.0, 150.0)
    dt, n = 2.0 * math.pi / omega / per, int(rng.uniform(8.0, 20.0) * per)
    fine, side = max(4, math.ceil(500.0 / per)), float(rng.choice([-1.0, 1.0]))
    channels = "xa" if both else "x"
    if not both and path in (DECAY, SIMULATED):
        channels = str(rng.choice(["x", "xa", "a"], p=[0.5, 0.35, 0.15]))
    rest = dt * int(rng.uniform(0.3, 2.0) * per) if rng.random() < 0.4 else 0.0
    return Rig(path, b, dt, (side * size, 0.0), (np.zeros(n),), True, fine, channels=channels, rest=rest)


def _shaken(path: str, rng: Rng) -> Rig:
    size, b = _slider(rng, path == SHAKEN, (0.01, 0.1), (0.01, 0.08))
    omega, per = math.sqrt(b[2] / b[0]), int(rng.integers(30, 130))
    dt, n, fine = 2.0 * math.pi / omega / per, int(rng.integers(14, 30)) * per, max(4, math.ceil(500.0 / per))
    held = bool(rng.random() < 0.5)
    at = np.arange(n) * dt if held else np.arange((n - 1) * fine + 1) * (dt / fine)
    u = np.zeros_like(at)
    for _ in range(5):
        u += rng.uniform(0.4, 1.0) * np.sin(omega * rng.uniform(0.25, 1.6) * at + rng.uniform(0.0, 6.3))
    # the force that moves it so far as was meant
    rig, scale = Rig(path, b, dt, (0.0, 0.0), (u,), held, fine, channels="xu"), b[2] * size * 0.4
    for _ in range(4):
        far = float(np.max(np.abs(replace(rig, drive=(u * scale,)).run(BARE)[:, 0])))
        scale *= min(max(size / max(far, 1e-3 * size), 0.2), 5.0)
    return replace(rig, drive=(u * scale,))


def _moves(rng: Rng, t: FloatArray, travel: float, fastest: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """To-and-fro moves of quintic laws, of several lengths and speeds, with short rests: r, its speed, its bend."""
    r, rv, ra = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
    at, now, far = 0.0, 0.0, True
    while now < t[-1]:
        to = (0.5 if far else -0.5) * travel * rng.uniform(0.5, 1.0)
        far = not far
        length = abs(to - at) * 1.875 / (fastest * _between(rng, 0.15, 1.0))
        inside = (t >= now) & (t < now + length)
        s, d = (t[inside] - now) / length, to - at
        r[inside] = at + d * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
        rv[inside] = d / length * 30.0 * s**2 * (1.0 - s) ** 2
        ra[inside] = d / length**2 * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s)
        r[t >= now + length], at, now = to, to, now + length + rng.uniform(0.0, 0.25)
    return r, rv, ra


def _axis(rng: Rng) -> Rig:
    travel, m = _between(rng, 0.05, 0.6), _between(rng, 1.0, 60.0)
    dt, n = float(rng.choice([0.001, 0.002, 0.004])), int(rng.integers(4000, 7000))
    fastest = 1.9 * travel / max(n * dt / rng.uniform(14.0, 24.0), 0.15)
    r, rv, ra = _moves(rng, dt * np.arange(float(n)), travel, fastest)
    top = m * float(np.max(np.abs(ra)))
    f_k = top * _between(rng, 0.1, 1.0)
    c = f_k / fastest * _between(rng, 0.1, 1.0)
    band, count = min(_between(rng, 20.0, 60.0), 0.12 / dt), travel / _between(rng, 2e4, 4e5)
    fed, ahead = m * float(rng.random() < 0.5), 0.8 * f_k * float(rng.random() < 0.3)
    gains = np.array([
        m * band**2, 2.0 * 0.8 * m * band, m * band**3 * rng.uniform(0.0, 0.15), min(1.0, dt * 10.0 * band), fed,
        ahead, 4.0 * (top + 2.0 * f_k + c * fastest), fastest,
    ])  # fmt: skip
    b = np.array([m, c, 0.0, f_k, 0.0])
    return Rig(AXIS, b, dt, (0.0, 0.0), (r, rv, ra), True, 8, (count,), gains, "xu")


def _joint(rng: Rng) -> Rig:
    """A hinge under a controller on its encoder, gravity pulling at three of four: zero is where it hangs."""
    inertia, omega = _between(rng, 0.02, 3.0), _between(rng, 2.0, 9.0) * float(rng.random() < 0.75)
    every, tick = int(rng.choice([1, 2, 4, 8])), float(rng.choice([0.001, 0.002]))
    n, travel = int(rng.integers(2500, 5000)), rng.uniform(0.5, 2.4)
    fastest = min(1.9 * travel / (n * tick * every / rng.uniform(10.0, 24.0)), 6.0)
    r, rv, ra = _moves(rng, tick * np.arange(float((n - 1) * every + 1)), travel, fastest)
    top = inertia * float(np.max(np.abs(ra))) + inertia * omega**2 * math.sin(min(0.5 * travel, 0.5 * math.pi))
    f_k = top * _between(rng, 0.08, 0.8)
    c = f_k / fastest * _between(rng, 0.1, 1.0)
    band, count = min(_between(rng, 20.0, 60.0), 0.12 / tick), 2.0 * math.pi / 2.0 ** int(rng.integers(14, 21))
    gains = np.array([
        inertia * (band**2 + omega**2), 1.6 * inertia * band, inertia * band**3 * rng.uniform(0.0, 0.15),
        min(1.0, tick * 10.0 * band), inertia * float(rng.random() < 0.5), 0.8 * f_k * float(rng.random() < 0.3),
        4.0 * (top + 2.0 * f_k + c * fastest), fastest,
    ])  # fmt: skip
    b = np.array([inertia, c, inertia * omega**2, f_k, float(omega > 0.0)])
    channels = "xvu" if rng.random() < 0.5 else "xu"
    rig = Rig(JOINT, b, tick * every, (0.0, 0.0), (r, rv, ra), True, 4, (count,), gains, channels, every=every)
    ticks = rig.ticks(b, BARE)
    run = ticks[::every]
    noise = float(np.std(run[:, 3])) * (_between(rng, 3e-4, 2e-2) if rng.random() < 0.6 else COMMANDED)
    sigma = count / math.sqrt(12.0), float(np.std(run[:, 1])) * _between(rng, 1e-3, 1e-2), noise
    of_u = unseen(ticks[:, 3], every)
    return replace(rig, sigma=sigma, count=count, zero=rng.uniform(-2.0, 2.0), unseen=of_u)


STEP = 2.0 * math.pi / 4096
STALL, BRAKE, GAIN, MOST, VOLTS = 0.4527, 0.5486, 0.166 * 16.0, 0.97, 7.4
"""Of an STS3215: rad, N m a volt, N m s/rad, duty a rad, duty, V."""
_TICK, _FREE = 1e-3, 0.9
"""s of the servo's own loop, and the share of its largest duty that a log asks for."""


def _servo(rng: Rng) -> Rig:
    """A joint of an arm under a servo like an STS3215, its goals those of somebody who leads it."""
    inertia, pull, f_k, c = (_between(rng, *one) for one in ((0.024, 0.09), (0.15, 1.2), (0.02, 0.12), (0.02, 0.08)))
    dt, rest = 1.0 / float(rng.choice([30.0, 50.0])), rng.uniform(-math.pi, math.pi)
    t = dt * np.arange(float(round(rng.uniform(25.0, 40.0) / dt)))
    gains = np.array([GAIN, STALL * VOLTS * rng.uniform(0.85, 1.15), MOST, rng.uniform(0.002, 0.03), STEP, rest, BRAKE])
    noise, b = STEP * rng.uniform(0.5, 1.5), np.array([inertia, c + BRAKE, pull, f_k, 1.0])
    sigma = math.hypot(noise, STEP / math.sqrt(12.0)), noise, 0.0
    # led so that its duty is never all there is, which nobody who does not name the servo can know of
    slow, way = 1.0, int(rng.integers(2**32))
    while True:
        goal = goals(t / slow, np.random.default_rng(way))
        rig = Rig(SERVO, b, dt, (0.0, 0.0), (goal,), True, 1, (), gains, "x", sigma, count=STEP, zero=rest,
                  every=round(dt / _TICK))  # fmt: skip
        if float(np.max(np.abs(goal - rest - rig.run(BARE)[:, 0]))) < _FREE * MOST / GAIN:
            return rig
        slow *= 1.25


def goals(t: FloatArray, rng: Rng) -> FloatArray:
    """Goals (n,), rad, as somebody leads an arm: from place to place, with rests, and a little sway."""
    edges, places = [0.0], [rng.uniform(-0.8, 0.8)]
    while edges[-1] < t[-1]:
        move = rng.uniform(0.5, 2.0)
        edges += [edges[-1] + move, edges[-1] + move + rng.choice([0.0, rng.uniform(0.2, 1.0)])]
        places += [rng.uniform(-0.9, 0.9)] * 2
    at = np.searchsorted(edges, t, side="right") - 1
    ends = np.minimum(at + 1, len(edges) - 1)
    s = np.clip((t - np.take(edges, at)) / np.maximum(np.take(edges, ends) - np.take(edges, at), 1e-9), 0.0, 1.0)
    found = np.take(places, at) + s**3 * (10.0 - 15.0 * s + 6.0 * s**2) * (np.take(places, ends) - np.take(places, at))
    return np.asarray(found + 0.1 * np.sin(2.0 * np.pi * rng.uniform(0.3, 1.0) * t + rng.uniform(0.0, 6.0)))


def _slow(rng: Rng) -> Rig:
    travel, m = _between(rng, 0.05, 0.6), _between(rng, 1.0, 60.0)
    dt, n, fine = float(rng.choice([0.005, 0.01, 0.02])), int(rng.integers(2500, 4500)), 8
    fastest = 1.9 * travel / (n * dt / rng.uniform(14.0, 26.0))
    r, rv, ra = _moves(rng, np.arange((n - 1.0) * fine + 1.0) * (dt / fine), travel, fastest)
    f_k = m * float(np.max(np.abs(ra))) * _between(rng, 1.0, 20.0)
    stiff = m * (0.25 / dt) ** 2
    b = np.array([m, f_k / fastest * _between(rng, 0.1, 1.0), 0.0, f_k, 0.0])
    return Rig(SLOW, b, dt, (0.0, 0.0), (r, rv), False, fine, (stiff, 1.2 * math.sqrt(m * stiff)), channels="xu")


def _run_down(rng: Rng) -> Rig:
    v0, seconds, share = _between(rng, 3.0, 250.0), _between(rng, 1.0, 60.0), rng.uniform(0.2, 0.75)
    b = np.array([1.0, share / seconds * 1.5, 0.0, (1.0 - share) * v0 / seconds * 1.5, 0.0])
    end = math.log1p(b[1] * v0 / b[3]) / b[1]
    n, last = (
        int(rng.integers(400, 3000)),
        end * (rng.uniform(1.01, 1.3) if rng.random() < 0.6 else rng.uniform(0.6, 0.95)),
    )
    channels = str(rng.choice(["v", "x"]))
    return Rig(DOWN, b, last / n, (0.0, v0), (np.zeros(n),), True, 4, channels=channels)


def _curve(rng: Rng, both: bool) -> Rig:
    rows, top, level = int(rng.integers(12, 40)), _between(rng, 0.05, 300.0), _between(rng, 0.01, 100.0)
    spaced = np.geomspace(0.005 * top, top, rows) if rng.random() < 0.6 else np.linspace(0.03 * top, top, rows)
    v = np.concatenate((-spaced[::-1], spaced)) if rng.random() < 0.7 or both else spaced
    b = np.array([1.0, level / top * rng.uniform(0.2, 1.0), 0.0, level, 0.0])
    return Rig(CURVE, b, 1.0, (0.0, 0.0), (rng.permutation(v),), True, 1)
