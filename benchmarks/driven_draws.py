"""Draws of driven recordings: what is recorded, how it is driven, what is hidden, and how much that is worth."""

import math
from dataclasses import dataclass

import numpy as np

from benchmarks import driven_plant as plant
from benchmarks.driven_plant import AXIS, PENDULUM, PUSHED, SPRING, Array

KINDS = (SPRING, AXIS, PUSHED, PENDULUM)
RIGHT = {SPRING: "spring", PENDULUM: "pendulum", AXIS: "none", PUSHED: "none"}
"""How a slider of a kind is held."""
EFFECTS = {
    "drag": (("quadratic-drag", "power-law-damping"), KINDS),
    "stribeck": (("stribeck", "static-friction"), KINDS),
    "hardening": (("cubic-stiffness",), (SPRING,)),
    "cogging": (("force-ripple",), (AXIS, PUSHED)),
    "sides": (("asymmetric-viscous",), KINDS),
    "slope": (("position-dependent-friction",), KINDS),
    "dip": (("load-dependent-friction", "position-dependent-friction"), KINDS),
    "warm": (("friction-drift",), KINDS),
    "bristle": (("presliding",), KINDS),
    "hum": (("harmonic-force",), (SPRING, AXIS, PENDULUM)),
    "pulse": (("impulse",), (SPRING, PENDULUM)),
    "stop": (("end-stop",), (SPRING, PUSHED)),
    "tilt": (("constant-force",), (SPRING,)),
    "creep": (("viscoelastic",), (SPRING,)),
}
"""Forms that are hidden: names that are right, and kinds that they are hidden in."""


@dataclass(frozen=True)
class Drawn:
    """One recording. t, x, u (n,); truth: names that are right, () for a control; worth: effective samples."""

    kind: str
    effect: str
    truth: tuple[str, ...]
    worth: float
    measured: str
    t: Array
    x: Array
    u: Array
    clean_x: Array
    base: dict[str, float]
    angular: bool

    @property
    def csv(self) -> str:
        """As a file."""
        head = "t [s],x [rad],u [N*m]" if self.angular else "t [s],x [m],u [N]"
        rows = (f"{t:.7g},{x:.10g},{u:.9g}" for t, x, u in zip(self.t, self.x, self.u, strict=True))
        return "\n".join((head, *rows)) + "\n"


@dataclass(frozen=True)
class _Rig:
    """What does not change when an effect is made larger."""

    kind: str
    b: Array
    dt: float
    drive: tuple[Array, ...]
    held: bool
    numbers: tuple[float, ...]
    gains: Array

    def run(self, p: Array) -> tuple[Array, Array]:
        """True motion and true force (n,)."""
        if self.kind == AXIS:
            r, rv, ra = self.drive
            return plant.controlled(r, rv, ra, self.numbers[0], self.gains, self.dt, self.b, p)
        if self.kind == PUSHED:
            (r, rv), (stiff, damp) = self.drive, self.numbers
            return plant.pushed(r, rv, stiff, damp, self.dt, self.b, p)
        x, _ = plant.given_force(self.drive[0], self.held, self.dt, self.numbers[0], 0.0, self.b, p)
        return x, self.drive[0] if self.held else self.drive[0][:: plant._FINE]


def _between(rng: np.random.Generator, low: float, high: float) -> float:
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def _moves(rng: np.random.Generator, t: Array, travel: float, fastest: float) -> tuple[Array, Array, Array]:
    """To-and-fro moves of quintic laws, of several lengths and speeds, with short rests: r, its speed, its bend."""
    r, rv, ra = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
    at, now = 0.0, 0.0
    far = True
    while now < t[-1]:
        to = (0.5 if far else -0.5) * travel * rng.uniform(0.5, 1.0)
        far = not far
        length = abs(to - at) * 1.875 / (fastest * _between(rng, 0.15, 1.0))
        inside = (t >= now) & (t < now + length)
        s = (t[inside] - now) / length
        d = to - at
        r[inside] = at + d * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
        rv[inside] = d / length * 30.0 * s**2 * (1.0 - s) ** 2
        ra[inside] = d / length**2 * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s)
        rest = rng.uniform(0.0, 0.25)
        later = t >= now + length
        r[later], at, now = to, to, now + length + rest
    return r, rv, ra


def _rig(rng: np.random.Generator, kind: str) -> _Rig:
    none = np.zeros(1)
    if kind in (SPRING, PENDULUM):
        omega, m = _between(rng, 3.0, 20.0), _between(rng, 0.3, 3.0)
        k = m * omega**2
        size = rng.uniform(0.35, 1.1) if kind == PENDULUM else _between(rng, 0.005, 0.1)
        zeta, dry = _between(rng, 0.01, 0.1), _between(rng, 0.01, 0.08)
        b = np.array([m, 2.0 * zeta * m * omega, k, dry * k * size, 1.0 if kind == PENDULUM else 0.0])
        cycles, per = int(rng.integers(14, 30)), int(rng.integers(30, 130))
        dt = 2.0 * math.pi / omega / per
        n = cycles * per
        held = bool(rng.uniform() < 0.5)
        fine = np.arange(n) * dt if held else np.arange((n - 1) * plant._FINE + 1) * (dt / plant._FINE)
        u = np.zeros_like(fine)
        for _ in range(5):
            w = omega * rng.uniform(0.25, 1.6)
            u += rng.uniform(0.4, 1.0) * np.sin(w * fine + rng.uniform(0.0, 6.3))
        # the force that moves it so far as was meant
        p = np.zeros(plant.SIZE)
        scale = k * size * 0.4
        for _ in range(4):
            x, _ = plant.given_force(u * scale, held, dt, 0.0, 0.0, b, p)
            scale *= min(max(size / float(np.max(np.abs(x))), 0.2), 5.0)
        return _Rig(kind, b, dt, (u * scale,), held, (0.0,), none)
    travel, m = _between(rng, 0.05, 0.6), _between(rng, 1.0, 60.0)
    if kind == AXIS:
        dt, n = float(rng.choice([0.001, 0.002, 0.004])), int(rng.integers(4000, 7000))
        duration = n * dt
        fastest = 1.9 * travel / max(duration / rng.uniform(14.0, 24.0), 0.15)
        t: Array = np.arange(float(n)) * dt
        r, rv, ra = _moves(rng, t, travel, fastest)
        top = m * float(np.max(np.abs(ra)))
        f_k = top * _between(rng, 0.1, 1.0)
        c = f_k / fastest * _between(rng, 0.1, 1.0)
        band = min(_between(rng, 20.0, 60.0), 0.12 / dt)
        count = travel / _between(rng, 2e4, 4e5)
        share = min(1.0, dt * 10.0 * band)
        fed = float(rng.uniform() < 0.5)
        ahead = float(rng.uniform() < 0.3)
        gains = np.array([
            m * band**2, 2.0 * 0.8 * m * band, m * band**3 * rng.uniform(0.0, 0.15), share, m * fed, f_k * 0.8 * ahead,
            4.0 * (top + 2.0 * f_k + c * fastest), fastest,
        ])  # fmt: skip
        return _Rig(kind, np.array([m, c, 0.0, f_k, 0.0]), dt, (r, rv, ra), True, (count,), gains)
    dt, n = float(rng.choice([0.005, 0.01, 0.02])), int(rng.integers(2500, 4500))
    t = np.arange((n - 1.0) * plant._FINE + 1.0) * (dt / plant._FINE)
    fastest = 1.9 * travel / (n * dt / rng.uniform(14.0, 26.0))
    r, rv, ra = _moves(rng, t, travel, fastest)
    top = m * float(np.max(np.abs(ra)))
    f_k = top * _between(rng, 1.0, 20.0)
    c = f_k / fastest * _between(rng, 0.1, 1.0)
    stiff = m * (0.25 / dt) ** 2
    damp = 1.2 * math.sqrt(m * stiff)
    return _Rig(kind, np.array([m, c, 0.0, f_k, 0.0]), dt, (r, rv), False, (stiff, damp), none)


def _effect(rng: np.random.Generator, effect: str, rig: _Rig, x: Array) -> tuple[Array, int]:
    """Numbers of an effect at a moderate strength, and the place of the one that is its strength."""
    p, (m, c, k, f_k, _) = np.zeros(plant.SIZE), rig.b
    v = np.gradient(x, rig.dt)
    fast, far, span = float(np.percentile(np.abs(v), 98)), float(np.max(np.abs(x))), x.size * rig.dt
    slow = 1.0 / math.sqrt(k / m) if k else 0.5
    sides = 0.3 * max(c, 0.3 * f_k / fast)
    stop = 4.0 * max(k * far, f_k) / (0.2 * far) ** 1.5
    hum = 2.0 * math.pi / rig.dt / _between(rng, 12.0, 60.0)
    speed, form = fast * _between(rng, 0.03, 0.25), float(rng.integers(0, 2))
    length, phase = 2.0 * far / _between(rng, 2.0, 30.0), rng.uniform(0.0, 6.3)
    at = {
        "drag": (plant.DRAG, f_k / fast**2, {plant.DRAG_V: 3.0 * fast}),
        "stribeck": (plant.STRIBECK, 0.4 * f_k, {plant.STRIBECK_V: speed, plant.STRIBECK_FORM: form}),
        "hardening": (plant.HARD, 0.2 * k * far, {plant.HARD_X: 0.7 * far}),
        "cogging": (plant.COG, 0.3 * f_k, {plant.COG_L: length, plant.COG_P: phase}),
        "sides": (plant.SIDES, sides, {plant.SIDES_V: 0.05 * fast}),
        "slope": (plant.SLOPE, 0.3 * f_k, {plant.SLOPE_X: far}),
        "dip": (plant.DIP, 0.4 * f_k, {plant.DIP_X: 0.6 * far}),
        "warm": (plant.WARM, 0.4 * f_k, {plant.WARM_T: span * rng.uniform(0.3, 1.0)}),
        "bristle": (plant.BRISTLE, 0.02 * far, {}),
        "hum": (plant.HUM, 0.2 * f_k, {plant.HUM_W: hum}),
        "pulse": (plant.PULSE, 3.0 * f_k, {plant.PULSE_T: span * rng.uniform(0.2, 0.8), plant.PULSE_L: 3.0 * rig.dt}),
        "stop": (plant.STOP, stop, {plant.STOP_X: far * rng.uniform(0.7, 0.9)}),
        "tilt": (plant.TILT, 0.1 * k * far, {}),
        "creep": (plant.CREEP, 0.1 * k, {plant.CREEP_1: 2.0 * slow, plant.CREEP_2: 10.0 * slow}),
    }[effect]
    for place, number in at[2].items():
        p[place] = number
    p[at[0]] = at[1]
    return p, at[0]


def _worth(rig: _Rig, p: Array, sigma: float, sigma_u: float) -> float:
    """Effective samples: chi-square of what the effect does, beside the base model and its six numbers.

    The force that base numbers cannot say, as it moves the slider within a twelfth of the recording each (position and
    speed at the beginning of each unknown), under the sensors' noise; and that force itself beside its noise.
    """
    x, _ = rig.run(p)
    m, k, swings = rig.b[0], rig.b[2], rig.b[4]
    v = np.gradient(x, rig.dt)
    a = np.gradient(v, rig.dt)
    bare = np.zeros(plant.SIZE)
    t = np.arange(x.size) * rig.dt
    usual = np.array([plant._wet(x[i], v[i], t[i], rig.b, bare) for i in range(x.size)])
    extra = np.array([plant._wet(x[i], v[i], t[i], rig.b, p) for i in range(x.size)]) - usual
    if p[plant.BRISTLE] != 0.0 or p[plant.CREEP] != 0.0:
        # beside bristles that do not give, which turn with the same samples
        rigid = np.where(np.arange(p.size) == plant.BRISTLE, 1e-9 * p, 0.0)
        extra = plant.carried(x, rig.dt, rig.b[3], p) - plant.carried(x, rig.dt, rig.b[3], rigid)
    else:
        extra += np.sign(v) * np.array([plant._dry(x[i], v[i], t[i], rig.b[3], p) - rig.b[3] for i in range(x.size)])
    place = np.sin(x) if swings else x
    moving = np.abs(v) > 0.01 * float(np.max(np.abs(v)))
    columns = np.column_stack([v, np.sign(v), a, *([place] if k else [np.ones_like(x)])])
    extra = np.where(moving, extra, 0.0)
    extra[moving] -= columns[moving] @ np.linalg.lstsq(columns[moving], extra[moving], rcond=None)[0]
    by_force = float(np.sum(extra**2)) / sigma_u**2 if sigma_u > 0.0 else math.inf
    total = 0.0
    for part in np.array_split(np.arange(x.size), 12):
        s = t[part] - t[part[0]]
        y = np.cumsum(np.cumsum(extra[part])) * rig.dt**2 / m
        basis = np.column_stack([np.ones_like(s), s])
        total += float(np.sum((y - basis @ np.linalg.lstsq(basis, y, rcond=None)[0]) ** 2))
    return min(total / sigma**2, by_force)


def drawn(seed: int, number: int, control: bool, kind: str | None = None, effect: str | None = None) -> Drawn:
    """A recording by its number under a seed."""
    rng = np.random.default_rng([seed, number, int(control)])
    kind = kind or KINDS[number % len(KINDS)]
    rig = _rig(rng, kind)
    p = np.zeros(plant.SIZE)
    x, u = rig.run(p)
    far = float(np.std(x))
    encoder = kind == AXIS or rng.uniform() < 0.3
    count = rig.numbers[0] if kind == AXIS else far * _between(rng, 3e-5, 3e-3)
    sigma = count / math.sqrt(12.0) if encoder else far * _between(rng, 2e-5, 5e-3)
    held = rig.held
    noisy = (not held) or rng.uniform() < 0.3
    sigma_u = float(np.std(u)) * (_between(rng, 3e-4, 2e-2) if noisy else 0.0)
    worth, name = 0.0, "none"
    truth: tuple[str, ...] = ()
    if not control:
        possible = [e for e, (_, kinds) in EFFECTS.items() if kind in kinds]
        name = effect or possible[int(rng.integers(len(possible)))]
        truth = EFFECTS[name][0]
        p, at = _effect(rng, name, rig, x)
        usual, limit = p[at], 3.0 * p[at]
        wanted = _between(rng, 10.0, 1e5)
        power = 2.0
        for _ in range(4):
            worth = _worth(rig, p, sigma, sigma_u)
            p[at] = min(p[at] * min(max((wanted / max(worth, 1e-9)) ** (1.0 / power), 1e-3), 1e3), limit)
        worth = _worth(rig, p, sigma, sigma_u)
        if not math.isfinite(worth) or worth < 10.0:
            p[at] = usual
            worth = _worth(rig, p, sigma, sigma_u)
        x, u = rig.run(p)
    t: Array = np.arange(float(x.size)) * rig.dt
    seen = np.floor(x / count + 0.5) * count if encoder else x + sigma * rng.standard_normal(x.size)
    force = u + sigma_u * rng.standard_normal(u.size)
    how = f"{'held' if held else 'smooth'}{'+noise' if sigma_u else ''}, {'encoder' if encoder else 'noise'}"
    base = dict(zip(("m", "c", "k", "f_k"), rig.b[:4].tolist(), strict=True))
    return Drawn(kind, name, truth, worth, how, t, seen, force, x, base, kind == PENDULUM)
