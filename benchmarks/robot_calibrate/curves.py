"""python -m benchmarks.robot_calibrate.curves: friction curves against what was put in and against plain regressions.

Arms of seven joints whose friction has one of six laws a joint, half of them with a wrong model (masses 10 % off and a
load). A plain regression knows no guard and no noise: every inertial number, friction over speed in straight pieces and
an offset by least squares, torque and position through one Butterworth filter. The full regression of the held-out
figure has every inertial number, Coulomb, viscous friction and offset.
"""

import argparse
import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path

import numpy as np

from benchmarks.robot_calibrate.plant import JOINTS, Friction, Motion, Plant, seven_joints
from harness.core.arrays import BoolArray, FloatArray
from harness.core.quantity import Quantity
from harness.core.robot import JointLog
from harness.robot.arm import Arm, load_arm
from harness.robot.fleet import Compared, over_speed
from harness.robot.fleet import compared as compared_logs
from harness.robot.whole_arm.columns import signs
from harness.robot.whole_arm.differentiate import differentiate
from harness.robot.whole_arm.perturb import inertials, moving_bodies, with_load, with_mass
from harness.robot.whole_arm.result import WholeArm
from harness.robot.whole_arm.whole import whole_arm

SECONDS, RATE, LOWPASS = 20.0, 500.0, 15.0
_ASKED, _HELD_OUT = 0.05, 1.02
Shape = Callable[[FloatArray], FloatArray]
SHAPES: dict[str, Callable[[float, float], Shape]] = {
    "none": lambda f, s: np.zeros_like,
    "Stribeck": lambda f, s: lambda v: 0.4 * f * np.sign(v) * np.exp(-((v / s) ** 2)),
    "Lorentzian": lambda f, s: lambda v: 0.6 * f * np.sign(v) / (1.0 + (v / s) ** 2),
    "saturating": lambda f, s: lambda v: 0.8 * f * np.tanh(v / (2.0 * s)),
    "power": lambda f, s: lambda v: f * np.sign(v) * np.abs(v) ** 0.5,
    "quadratic": lambda f, s: lambda v: 0.5 * f * v * np.abs(v),
}


@dataclass(frozen=True, slots=True)
class Drawn:
    """A robot with its true friction by joint, and the arm as its user has it."""

    plant: Plant
    arm: Arm
    shapes: tuple[Shape, ...]
    names: tuple[str, ...]

    def friction(self, joint: int, v: FloatArray) -> FloatArray:
        """Of a joint at speeds (m,)."""
        base = self.plant.coulomb[joint] * np.sign(v) + self.plant.viscous[joint] * v
        return np.asarray(base + self.shapes[joint](v))


def robot(rng: np.random.Generator, wrong: bool) -> Drawn:
    """One robot; wrong : its user's model is."""
    arm = seven_joints()
    plant = replace(Plant.drawn(rng, arm), memory=0.01 * float(rng.integers(2)))
    names = tuple(str(rng.choice(list(SHAPES))) for _ in range(JOINTS))
    shapes = tuple(SHAPES[n](float(plant.coulomb[j]), float(rng.uniform(0.1, 0.4))) for j, n in enumerate(names))
    effects = {j: _over_speed(shape) for j, shape in enumerate(shapes)}
    true = arm
    if wrong:
        for body in moving_bodies(arm):
            true = with_mass(true, body, float(rng.choice((0.9, 1.1))))
        true = with_load(true, float(rng.uniform(0.3, 2.0)), rng.uniform(-0.05, 0.05, 3))
    return Drawn(replace(plant, arm=true, effects=effects), arm, shapes, names)


def _over_speed(shape: Shape) -> Friction:
    return lambda t, q, v, g: shape(v)


def _torques(
    arm: Arm, q: FloatArray, v: FloatArray, a: FloatArray, dof: Sequence[int]
) -> tuple[FloatArray, FloatArray]:
    """Torque (m, k) of the model, and of each inertial number (m, k, p)."""
    rigid = arm.inverse(q, v, a)
    columns = [(other.inverse(q, v, a) - rigid)[:, list(dof)] / step for other, step, _ in inertials(arm)]
    rotors = []
    for i in dof:
        one = np.zeros((q.shape[0], len(dof)))
        one[:, list(dof).index(i)] = a[:, i]
        rotors.append(one)
    return rigid[:, list(dof)], np.stack([*columns, *rotors], axis=2)


def plain(log: JointLog, arm: Arm, at: Sequence[FloatArray], lowpass: float = LOWPASS) -> list[FloatArray]:
    """Friction of every joint at speeds at[j] (2 k,) by a plain regression; knots of its straight pieces are these."""
    from scipy.signal import butter, filtfilt

    rate = (log.t.size - 1) / float(log.t[-1] - log.t[0])
    low = butter(4, lowpass / (rate / 2.0))
    q, u = (np.column_stack([of[name] for name in arm.joints]) for of in (log.position, log.effort))
    q, u = (np.asarray(filtfilt(*low, one, axis=0)) for one in (q, u))
    v = np.gradient(q, 1.0 / rate, axis=0)
    a = np.gradient(v, 1.0 / rate, axis=0)
    some = slice(round(rate / 2.0), -round(rate / 2.0), max(round(rate / (6.0 * lowpass)), 1))
    q, v, a, u = q[some], v[some], a[some], u[some]
    rigid, columns = _torques(arm, q, v, a, range(q.shape[1]))
    kept = [np.abs(v[:, j]) > 0.5 * float(np.min(np.abs(at[j]))) for j in range(q.shape[1])]
    blocks, rows = [], []
    for j in range(q.shape[1]):
        own = np.hstack([_pieces(v[:, j], at[j]), np.ones((v.shape[0], 1))])
        wide = [own if i == j else np.zeros((own.shape[0], speeds.size + 1)) for i, speeds in enumerate(at)]
        blocks.append(np.hstack([columns[:, j], *wide]))
        rows.append(u[:, j] - rigid[:, j])
    matrix = np.vstack([block[k] for block, k in zip(blocks, kept, strict=True)])
    y = np.concatenate([row[k] for row, k in zip(rows, kept, strict=True)])
    scale = np.sqrt(np.sum(matrix**2, axis=0))
    scale[scale == 0.0] = 1.0
    numbers = np.linalg.lstsq(matrix / scale, y, rcond=1e-8)[0] / scale
    found, first = [], columns.shape[2]
    for speeds in at:
        own = numbers[first : first + speeds.size]
        half = speeds.size // 2
        even = np.mean(own[:half][::-1] + own[half:]) / 2.0
        found.append(own - even)
        first += speeds.size + 1
    return found


def _pieces(v: FloatArray, speeds: FloatArray) -> FloatArray:
    """Straight pieces (m, 2 k) between speeds (2 k,), going straight on at their ends."""
    on = speeds[speeds > 0.0]
    s, side = np.abs(v), v > 0.0
    above = np.clip(np.searchsorted(on, s), 1, on.size - 1)
    share = (s - on[above - 1]) / (on[above] - on[above - 1])
    rows, half = np.arange(v.size), np.zeros((v.size, on.size))
    half[rows, above - 1], half[rows, above] = 1.0 - share, share
    return np.hstack((half[:, ::-1] * ~side[:, None], half * side[:, None]))


def full_left(log: JointLog, arm: Arm, found: WholeArm, block: float = 1.0, folds: int = 5) -> FloatArray:
    """rms (k,) of held-out torque by a full regression, on the samples that the answer was judged on."""
    filtered = differentiate(log, arm, [one.joint for one in found.joints if one.guard], found.lowpass)
    rigid, columns = _torques(arm, filtered.q, filtered.v, filtered.a, filtered.dof)
    guards = [one.guard or 0.0 for one in found.joints if one.guard]
    kept = [filtered.away(j, guard) for j, guard in enumerate(guards)]
    count = len(guards)
    matrices, torques = [], []
    for j, dof in enumerate(filtered.dof):
        v = filtered.v[:, dof]
        sign = filtered.column(signs(filtered.v_fine[:, dof]), jumps=True)
        own = np.zeros((v.size, 3 * count))
        own[:, 3 * j : 3 * j + 3] = np.column_stack((sign, v, np.ones_like(v)))
        matrices.append(np.hstack((columns[:, j], own)))
        torques.append(filtered.torque[:, j] - rigid[:, j])
    fold = ((filtered.t - filtered.t[0]) // block).astype(np.int64) % folds
    squares = np.zeros(count)
    for one in range(folds):
        inside = [k & (fold != one) for k in kept]
        weight = [1.0 / float(np.std(u[k])) for u, k in zip(torques, kept, strict=True)]
        matrix = np.vstack([m[k] * w for m, k, w in zip(matrices, inside, weight, strict=True)])
        y = np.concatenate([u[k] * w for u, k, w in zip(torques, inside, weight, strict=True)])
        scale = np.sqrt(np.sum(matrix**2, axis=0))
        scale[scale == 0.0] = 1.0
        numbers = np.linalg.lstsq(matrix / scale, y, rcond=1e-6)[0] / scale
        for j in range(count):
            out: BoolArray = kept[j] & (fold == one)
            squares[j] += float(np.sum((torques[j][out] - matrices[j][out] @ numbers) ** 2))
    return np.sqrt(squares / [np.sum(k) for k in kept])


def compared(log: JointLog, arm: Arm, lowpass: float | None) -> tuple[WholeArm, list[float], list[float]]:
    """Of a log: what is found; by joint with a curve the mean distance from the plain one over its own size, and what
    is left of held-out torque over what the full regression leaves."""
    found = whole_arm(log, arm, lowpass=lowpass)
    curves = [one.curve for one in found.joints]
    asked = [np.array([-1.0, -0.5, 0.5, 1.0]) if c is None else c.v for c in curves]
    others = plain(log, arm, asked, found.lowpass)
    far = [
        float(np.mean(np.abs(c.friction - other)) / np.mean(np.abs(other)))
        for c, other in zip(curves, others, strict=True)
        if c is not None
    ]
    full = iter(full_left(log, arm, found))
    ratios = [
        min(one.held_out[1], one.curve.left if one.curve and one.curve.left else math.inf) / float(next(full))
        for one in found.joints
        if one.held_out
    ]
    return found, far, ratios


def between_logs(seed: int, number: int, logs: int, varies: float) -> list[Compared]:
    """Curves of several logs of one robot, each with another motion and another load that its user does not know.

    varies : standard deviation of the logarithm of a joint's friction from log to log.
    """
    rng = np.random.default_rng((seed, number))
    one = robot(rng, wrong=False)
    values: list[dict[str, dict[str, Quantity]]] = [{} for _ in range(logs)]
    found = []
    for _ in range(logs):
        times = np.exp(varies * rng.standard_normal(JOINTS))
        effects = {j: _over_speed(_scaled(shape, times[j])) for j, shape in enumerate(one.shapes)}
        loaded = with_load(one.arm, float(rng.uniform(0.0, 2.0)), rng.uniform(-0.05, 0.05, 3))
        plant = replace(one.plant, arm=loaded, effects=effects)
        plant = replace(plant, coulomb=plant.coulomb * times, viscous=plant.viscous * times)
        found.append(whole_arm(plant.log(rng, Motion.drawn(rng), SECONDS, RATE), one.arm, lowpass=LOWPASS))
    for name in one.arm.joints:
        _, told = over_speed([each.joint(name).curve for each in found])
        for own, mine in zip(values, told, strict=True):
            own[name] = mine
    return list(compared_logs(values))


def _scaled(shape: Shape, by: float) -> Shape:
    return lambda v: by * shape(v)


def _said_between(rows: Sequence[Sequence[Compared]]) -> None:
    """rows : by robot."""
    inside, shares, differ = list[bool](), list[float](), list[bool]()
    for own in rows:
        share = math.sqrt(float(np.mean([(one.between / (one.mean.value or 1.0)) ** 2 for one in own])))
        shares.append(share)
        for one in own:
            differ.append(one.differs)
            spread = share * abs(one.mean.value or 0.0)
            there = [(q.value or 0.0, q.stderr or 0.0) for q in one.values if q is not None]
            for (x, e), (y, f) in combinations(there, 2):
                inside.append(abs(x - y) < 1.96 * math.sqrt(e**2 + f**2 + 2.0 * spread**2))
    print(f"between logs: {np.mean(shares):.2%} of friction (root mean square of each robot, mean)")
    print(f"bands of two logs hold their difference: {_share(np.array(inside))}")
    print(f"said to differ: {_share(np.array(differ))} of speeds of joints")


def main(argv: Sequence[str] | None = None) -> int:
    """Draw, and print; exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.robot_calibrate.curves")
    parser.add_argument("--draws", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--each", action="store_true", help="a line for every joint")
    parser.add_argument("--log", type=Path, help="a log of one's own, with --robot")
    parser.add_argument("--robot", type=Path)
    parser.add_argument("--logs", type=int, help="compare so many logs of each robot instead")
    parser.add_argument("--varies", type=float, default=0.0, help="by which friction differs from log to log, a share")
    told = parser.parse_args(argv)
    if told.logs is not None:
        _said_between([between_logs(told.seed, n, told.logs, told.varies) for n in range(told.draws)])
        return 0
    if told.log is not None:
        return _own(told.log, told.robot)
    far, ratios, inside = list[float](), list[float](), list[BoolArray]()
    for number in range(told.draws):
        rng = np.random.default_rng((told.seed, number))
        one = robot(rng, wrong=bool(number % 2))
        log = one.plant.log(rng, Motion.drawn(rng), SECONDS, RATE)
        found, apart, left = compared(log, one.arm, LOWPASS)
        far += apart
        ratios += left
        for j, joint in enumerate(found.joints):
            if joint.curve is None:
                continue
            c, true = joint.curve, one.friction(j, joint.curve.v)
            inside.append((c.low < true) & (true < c.high))
            if told.each:
                off = float(np.mean(np.abs(c.friction - true)) / np.mean(np.abs(true)))
                law = c.laws[0]
                print(
                    f"{number} {joint.joint} {one.names[j]}: {apart[j]:.1%} from a plain regression, {off:.1%} from",
                    end="",
                )
                print(
                    f" what was put in; held out {left[j]:.3f} of a full one; {law.name} {law.probability:.2f};", end=""
                )
                print(f" {np.mean(inside[-1]):.0%} in the band", flush=True)
    print(f"{told.draws} draws, seed {told.seed}")
    near, held = np.array(far), np.array(ratios)
    print(f"within {_ASKED:.0%} of a plain regression: {_share(near < _ASKED)}, median {np.median(far):.1%}")
    print(f"held out at most {_HELD_OUT} of a full regression: {_share(held < _HELD_OUT)}, worst {held.max():.3f}")
    print(f"the band of 95 % holds what was put in: {_share(np.concatenate(inside))}")
    return 0


def _own(path: Path, model: Path) -> int:
    """The same figures of somebody's log."""
    from harness.io.logs.read import read_joint_log

    arm = load_arm(model)
    found, far, ratios = compared(read_joint_log(path, joints=arm.joints), arm, None)
    curved = iter(far)
    for one, ratio in zip([one for one in found.joints if one.held_out], ratios, strict=True):
        apart = f"{next(curved):.1%}" if one.curve else "no curve"
        print(f"{one.joint}: {apart} from a plain regression; held out {ratio:.3f} of a full one; {one.line}")
    return 0


def _share(true: BoolArray) -> str:
    """A share with its 95 % interval (Wilson)."""
    from scipy.stats import binomtest

    low, high = binomtest(int(true.sum()), true.size).proportion_ci(0.95, "wilson")
    return f"{np.mean(true):.1%} of {true.size} ({low:.1%} to {high:.1%})"


if __name__ == "__main__":
    sys.exit(main())
