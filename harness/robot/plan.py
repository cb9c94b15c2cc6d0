"""A motion that tells friction: Fourier series within a robot's limits by which the errors of friction are least.

Ds-optimal (Atkinson, Donev and Tobias 2007, Optimum Experimental Designs, section 10.3): the errors of every joint's
Coulomb and viscous friction beside every inertial number of the rigid model, at the samples that an answer would keep.
Each joint's series is first brought to its best by itself (scipy's L-BFGS from motions of two speeds, gravity and
inertia about its own axis beside); of what comes out, the joints' series are then exchanged for the best of all
together.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import InputError
from harness.robot.arm import Arm, moved_with
from harness.robot.bare import with_included
from harness.robot.whole_arm.perturb import inertials
from harness.robot.whole_arm.rules import BODY_SPREAD, GUARD, RESTING

_HARMONICS, _PERIOD, _RAMP = 8, 10.0, 1.0
"""Of a series, whose period is ten seconds; s over which it begins and ends."""
_GRID, _ALONE, _COARSE = 30.0, 15.0, 6.0
"""Samples a second at which limits are judged, a joint's own errors, and those of all joints."""
_SHAPES, _FAST = tuple((turns, slow) for turns in (1, 2, 3) for slow in (0.2, 0.35)), 0.4
"""To and fro in a period, and the slow speed over the fast one, at which a joint's searches begin; share of time that
is fast."""
_KEPT, _ROUNDS, _STEPS, _STEP = 4, 2, 60, 1e-4
"""How many of a joint's ends are kept, rounds of exchange, steps of a search, its step for slopes."""
_MARGIN, _LOWPASS = 0.95, 15.0
"""Share of a limit that is used; Hz of the filter that an answer has."""
_SPEED, _TURN = 1.5, math.pi
"""rad/s or m/s, and rad, where a model has no limit."""
_SLOWER = 0.9
"""Ratio by which a motion is slowed down, or narrowed, until its torque is within the limits."""
_TRIES = 40


@dataclass(frozen=True, slots=True)
class Limits:
    """Of k joints: low, high, speed, torque (k,), rad or m, per s, N m or N. home (k,) : about which a motion is made
    narrow where torque asks for it. notes : what a model does not say.
    """

    low: FloatArray
    high: FloatArray
    speed: FloatArray
    torque: FloatArray
    home: FloatArray
    notes: tuple[str, ...] = ()

    @classmethod
    def of(cls, path: Path, arm: Arm, joints: Sequence[str], speed: float | None, torque: float | None) -> "Limits":
        """As a model's file has them; speed, torque : of every joint, in place of its.

        Raises InputError for a slide without a range.
        """
        model, dofs, notes = arm.model, [arm.index(name) for name in joints], []
        root = with_included(path)[0].root
        said = {
            element.get("name"): float(limit.get("velocity", "nan"))
            for element in root.iter("joint")
            if (limit := element.find("limit")) is not None
        }
        found = np.empty((4, len(joints)))
        for k, (name, i) in enumerate(zip(joints, dofs, strict=True)):
            low, high = model.jnt_range[i] if model.jnt_limited[i] else (-_TURN, _TURN)
            if not model.jnt_limited[i]:
                if arm.slides(name):
                    raise InputError(f"{path}: {name}", "a slide without a range", "a range of every slide")
                notes.append(f"{name} has no range: half a turn either way is taken")
            for j, (ratio, start) in moved_with(arm.ties, i).items():
                if model.jnt_limited[j] and j != i:
                    ends = sorted(float(end - start) / ratio for end in model.jnt_range[j])
                    low, high = max(low, ends[0]), min(high, ends[1])
            fastest = speed or said.get(name, math.nan)
            if not fastest > 0.0 or not math.isfinite(fastest):
                fastest = _SPEED
                notes.append(f"{name} has no limit of speed: {_SPEED:g} is taken (--speed)")
            strongest = torque or (float(model.jnt_actfrcrange[i, 1]) if model.jnt_actfrclimited[i] else math.inf)
            for a in range(model.nactuator):
                if not torque and model.actuator_forcelimited[a] and model.actuator_trnid[a, 0] == i:
                    strongest = min(strongest, float(model.actuator_forcerange[a, 1] * abs(model.actuator_gear[a, 0])))
            found[:, k] = low, high, fastest, strongest if strongest > 0.0 else math.inf
        home, moved = _home(arm, dofs, found[0], found[1], found[3])
        if moved:
            notes.append("gravity alone asks too much of the pose the model rests in: the motion is about another")
        return cls(found[0], found[1], found[2], found[3], home, tuple(notes))


@dataclass(frozen=True, slots=True)
class Motion:
    """arm, joints : whose motion it is, the others at rest where the model has them. limits : of these joints.

    series (k, 2 h) : of sines and cosines. seconds : long. slow : times the period. narrow : share of the range. size :
    how much of the largest that its limits allow; a number for every joint where they differ.
    """

    arm: Arm
    joints: tuple[str, ...]
    limits: Limits
    series: FloatArray
    seconds: float
    slow: float = 1.0
    narrow: float = 1.0
    size: tuple[float, ...] = ()

    def at(self, rate: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """t (n,), and q, v, a (n, nv) at so many samples a second."""
        t = np.arange(round(self.seconds * rate) + 1) / rate
        q = np.tile(np.asarray(self.arm.model.qpos0, dtype=np.float64), (t.size, 1))
        v, a = np.zeros_like(q), np.zeros_like(q)
        bases = _bases(t, self.seconds, self.slow)
        for k, name in enumerate(self.joints):
            i = self.arm.index(name)
            q[:, i], v[:, i], a[:, i] = _scaled(bases, self.series[k], *self._of(k))
        return t, q, v, a

    def _of(self, k: int) -> tuple[float, float, float]:
        """Middle of a joint's way, half its length, and its speed, within the margin of its limits."""
        low, high, home = (float(of[k]) for of in (self.limits.low, self.limits.high, self.limits.home))
        middle = home + self.narrow * ((low + high) / 2.0 - home)
        size = _MARGIN * (self.size[k] if self.size else 1.0)
        return middle, self.narrow * size * (high - low) / 2.0, size * float(self.limits.speed[k]) / self.slow

    def torque(self, rate: float = _GRID) -> FloatArray:
        """Largest torque (k,) that its joints need, the friction of the model's file among it."""
        _, q, v, a = self.at(rate)
        arm = self.arm
        needed = arm.inverse(q, v, a) + arm.frictionloss * np.sign(v) + arm.damping * v
        return np.asarray(np.max(np.abs(needed[:, [arm.index(name) for name in self.joints]]), axis=0))

    def feasible(self) -> "Motion":
        """This motion, slower and narrower as far as its torque asks. Raises InputError where rest asks for more."""
        found = self
        for _ in range(_TRIES):
            if np.all(found.torque() <= _MARGIN * found.limits.torque):
                return found
            # what slowing down does not mend is gravity's
            if found.slow < 2.0:
                found = replace(found, slow=found.slow / _SLOWER)
            else:
                found = replace(found, narrow=found.narrow * _SLOWER)
        over = [n for n, u, most in zip(self.joints, found.torque(), self.limits.torque, strict=True) if u > most]
        accepted = "--joints without them, or a larger --torque"
        raise InputError(self.arm.file, f"gravity alone asks more of {', '.join(over)} than its limit", accepted)

    def errors(self, noise: FloatArray) -> FloatArray:
        """Standard errors (k, 2) of Coulomb and viscous friction for so much torque noise (k,), N m, at each of the
        samples that an answer would keep, beside every inertial number of the model."""
        dofs = [self.arm.index(name) for name in self.joints]
        rows, spread = _regressors(self, dofs, noise)
        count = len(dofs)
        information = sum(one.T @ one for one in rows)
        information = information + np.diag(np.concatenate((np.full(3 * count, 1e-12), 1.0 / spread**2)))
        scale = np.sqrt(np.diag(information))
        inverse = np.linalg.inv(information / np.outer(scale, scale)) / np.outer(scale, scale)
        own = np.sqrt(np.diag(inverse)[: 3 * count]).reshape(count, 3)
        return np.asarray(own[:, :2])

    def condition(self, noise: FloatArray) -> float:
        """Condition number of all columns, each of length one."""
        rows, _ = _regressors(self, [self.arm.index(name) for name in self.joints], noise)
        matrix = np.vstack(rows)
        size = np.sqrt(np.sum(matrix**2, axis=0))
        values = np.linalg.svd(matrix[:, size > 0.0] / size[size > 0.0], compute_uv=False)
        seen = values[values > 1e-9 * values[0]]
        return float(seen[0] / seen[-1])


def _home(
    arm: Arm, dofs: Sequence[int], low: FloatArray, high: FloatArray, torque: FloatArray
) -> tuple[FloatArray, bool]:
    """The pose (k,) that the model rests in, or, where gravity asks too much there, that of many in which it asks the
    least share of a limit; whether it is another."""
    rest = np.clip(np.asarray(arm.model.qpos0, dtype=np.float64)[dofs], low, high)
    poses = np.vstack((rest, np.random.default_rng(0).uniform(low, high, (_POSES, len(dofs)))))
    q = np.tile(np.asarray(arm.model.qpos0, dtype=np.float64), (poses.shape[0], 1))
    q[:, dofs] = poses
    still = np.zeros_like(q)
    share = np.max(np.abs(arm.inverse(q, still, still)[:, dofs]) / torque, axis=1)
    best = int(np.argmin(share)) if share[0] > _MARGIN else 0
    return poses[best], best > 0


_POSES = 500


def _bases(t: FloatArray, seconds: float, slow: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Sines and cosines (n, 2 h), their first and second derivatives, begun and ended at rest."""
    w = 2.0 * math.pi * np.arange(1, _HARMONICS + 1) / (min(_PERIOD, seconds) * slow)
    angle = np.outer(t, w)
    q = np.hstack((np.sin(angle), np.cos(angle))) / np.tile(w, 2)
    v = np.hstack((np.cos(angle), -np.sin(angle)))
    a = -np.hstack((np.sin(angle), np.cos(angle))) * np.tile(w, 2)
    x = np.clip(np.minimum(t, seconds - t) / _RAMP, 0.0, 1.0)[:, None]
    side = np.where(t < seconds / 2.0, 1.0, -1.0)[:, None] / _RAMP
    r = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    dr = 30.0 * x**2 * (1.0 - x) ** 2 * side
    ddr = 60.0 * x * (1.0 - 3.0 * x + 2.0 * x**2) / _RAMP**2
    return r * q, r * v + dr * q, r * a + 2.0 * dr * v + ddr * q


def _scaled(
    bases: tuple[FloatArray, FloatArray, FloatArray], series: FloatArray, middle: float, half: float, fastest: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """q, v, a (n,) or (n, m) of series (2 h,) or (2 h, m) as large as range and speed allow."""
    q, v, a = (base @ series for base in bases)
    low, high = np.min(q, axis=0), np.max(q, axis=0)
    quickest = np.max(np.abs(v), axis=0)
    by = np.minimum(half / np.maximum((high - low) / 2.0, 1e-12), fastest / np.maximum(quickest, 1e-12))
    return middle + by * (q - (high + low) / 2.0), by * v, by * a


def _kept(v: FloatArray, rate: float) -> BoolArray:
    """Samples (n,) that the guard of an answer leaves."""
    slow = np.abs(v) < RESTING.value * float(np.quantile(np.abs(v), 0.95))
    slow[1:] |= np.sign(v[1:]) != np.sign(v[:-1])
    reach = math.ceil(GUARD.value / _LOWPASS * rate)
    return np.asarray(np.convolve(slow, np.ones(2 * reach + 1), "same") < 0.5)


def _regressors(motion: Motion, dofs: Sequence[int], noise: FloatArray) -> tuple[list[FloatArray], FloatArray]:
    """By joint its kept rows over the noise: Coulomb, viscous and offset of every joint, then inertial numbers; how far
    each of these is expected from the model."""
    _, q, v, a = motion.at(_COARSE)
    rigid = motion.arm.inverse(q, v, a)
    columns, spread = [], []
    for other, step, size in inertials(motion.arm):
        columns.append((other.inverse(q, v, a) - rigid)[:, dofs] / step)
        spread.append(BODY_SPREAD.value * size)
    body, rows = np.stack(columns, axis=2), []
    _, _, fine, _ = motion.at(_GRID)
    step = round(_GRID / _COARSE)
    for k, i in enumerate(dofs):
        kept = _kept(fine[:, i], _GRID)[::step]
        own = np.zeros((q.shape[0], 3 * len(dofs)))
        own[:, 3 * k : 3 * k + 3] = np.column_stack((np.sign(v[:, i]), v[:, i], np.ones(q.shape[0])))
        rows.append(np.hstack((own, body[:, k]))[kept] / noise[k])
    return rows, np.array(spread)


def random_motion(
    arm: Arm, joints: Sequence[str], limits: Limits, seconds: float, rng: np.random.Generator, largest: bool = True
) -> Motion:
    """A series with random numbers, as large as the limits allow, or as drawn: each number uniform, within bounds by
    which every draw keeps within its joint's limits."""
    if largest:
        series = rng.standard_normal((len(joints), 2 * _HARMONICS))
        return Motion(arm, tuple(joints), limits, series, seconds).feasible()
    series = rng.uniform(-1.0, 1.0, (len(joints), 2 * _HARMONICS))
    found = Motion(arm, tuple(joints), limits, series, seconds)
    t = np.arange(round(seconds * _GRID) + 1) / _GRID
    bases, size = _bases(t, seconds, 1.0), []
    most = [float(np.sum(np.max(np.abs(base), axis=0))) for base in bases[:2]]
    for k in range(len(joints)):
        _, half, fastest = found._of(k)
        q, v, _ = (base @ series[k] for base in bases)
        by = min(half / (float(np.ptp(q)) / 2.0), fastest / float(np.max(np.abs(v))))
        size.append(min(half / most[0], fastest / most[1]) / by)
    return replace(found, size=tuple(size)).feasible()


def planned(
    arm: Arm, joints: Sequence[str], limits: Limits, seconds: float, noise: FloatArray, seed: int = 0
) -> Motion:
    """The motion of ``joints`` by which friction has the least errors; noise (k,) : of the torque, N m or N.

    Raises InputError where gravity alone asks for more than a joint's torque.
    """
    rng = np.random.default_rng(seed)
    start = random_motion(arm, joints, limits, seconds, rng)
    ends = [_alone(start, k, rng) for k in range(len(joints))]
    best = replace(start, series=np.array([own[0] for own in ends]), slow=1.0, narrow=1.0).feasible()
    worth = _worth(best, noise)
    for _ in range(_ROUNDS):
        for k in range(len(joints)):
            for other in ends[k]:
                series = best.series.copy()
                series[k] = other
                trial = replace(best, series=series, slow=1.0, narrow=1.0).feasible()
                if (found := _worth(trial, noise)) < worth:
                    best, worth = trial, found
    return best


def _worth(motion: Motion, noise: FloatArray) -> float:
    """Sum of the logarithms of friction's errors."""
    return float(np.sum(np.log(motion.errors(noise))))


def _alone(motion: Motion, k: int, rng: np.random.Generator) -> list[FloatArray]:
    """Series of one joint that are best by themselves, the best first.

    The search begins at two speeds in either direction, which is what tells a line's slope and its start best, and
    leaves samples out gradually, so that it has slopes to follow.
    """
    from scipy.optimize import minimize

    t = np.arange(round(motion.seconds * _ALONE) + 1) / _ALONE
    bases, where = _bases(t, motion.seconds, 1.0), motion._of(k)

    def worth(series: FloatArray) -> FloatArray:
        """Of columns (2 h, m)."""
        q, v, a = _scaled(bases, series, *where)
        least = RESTING.value * np.max(np.abs(v), axis=0)
        near = np.minimum(np.abs(v) / (3.0 * least), 1.0)
        columns = np.stack((np.tanh(v / least), v, np.ones_like(v), a, np.sin(q), np.cos(q)))
        columns = np.moveaxis(columns * (near * np.sqrt(3.0 - 2.0 * near)), (0, 2), (2, 0))
        scale = np.sqrt(np.sum(columns**2, axis=1, keepdims=True) + 1e-12)
        unit = columns / scale
        gram = np.swapaxes(unit, 1, 2) @ unit + 1e-6 * np.eye(unit.shape[2])
        own = np.diagonal(np.linalg.inv(gram), axis1=1, axis2=2)[:, :2] / scale[:, 0, :2] ** 2
        return np.asarray(np.sum(np.log(own), axis=1) / 2.0)

    steps = np.column_stack((np.zeros(2 * _HARMONICS), _STEP * np.eye(2 * _HARMONICS)))

    def sloped(series: FloatArray) -> tuple[float, FloatArray]:
        found = worth(series[:, None] + steps)
        return float(found[0]), (found[1:] - found[0]) / _STEP

    ends = []
    for turns, slow in _SHAPES:
        phase = (turns * t / min(_PERIOD, motion.seconds) + rng.random()) % 1.0
        v = np.where(phase < 0.5, 1.0, -1.0) * np.where((2.0 * phase) % 1.0 < _FAST, 1.0, slow)
        first = np.linalg.lstsq(bases[1], v, rcond=None)[0]
        first /= np.linalg.norm(first)
        found = minimize(sloped, first, jac=True, method="L-BFGS-B", options={"maxiter": _STEPS})
        ends.append((float(found.fun), np.asarray(found.x / np.linalg.norm(found.x), dtype=np.float64)))
    return [series for _, series in sorted(ends, key=lambda one: one[0])[:_KEPT]]
