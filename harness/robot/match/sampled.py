"""Motion and torque of a log at few samples, how much of a torque the rigid model explains, and what decides."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.robot import JointLog
from harness.diagnosis.rules import Rule
from harness.robot.arm import Arm
from harness.robot.smooth import Even, moving
from harness.robot.whole_arm.perturb import under

CORRELATED = Rule(
    "correlated",
    0.5,
    "correlation",
    "a joint's torque follows its model's; of one that does not, where that would show, nothing is named",
    "half of it: at .5 the model explains a quarter of what friction leaves",
)
BY_FRICTION = Rule(
    "by-friction",
    0.95,
    "share",
    "friction explains a joint's torque, so that it need not follow the model's",
    "a judgement: the rest is what a motor's ripple and the noise of a current are",
)
LARGEST_SCALE = Rule(
    "largest-scale",
    2.0,
    "1",
    "most joints' torques are so many times the model's, or that part of it: another unit",
    "ten of gain-spread (0.2) off: motor constants are right to a fifth",
)
UNIT_NEAR = Rule(
    "unit-near",
    0.04,
    "share",
    "torques are as near to a unit's factor, and to each other's",
    "a judgement: a motor's constant is known to a few per cent",
)

RULES = tuple(value for value in list(vars().values()) if isinstance(value, Rule))


_SAMPLES = 2500
_MOVING = 0.05
"""Of a joint's largest speed: the direction of slower samples is not sure, and they do not count."""
FEWEST = 40
"""Samples in motion, of which a regression of five numbers says something."""
_ROUNDING = 1e-9
SURE = 4.0
"""Standard errors: one in sixteen thousand by chance."""
_TENTHS = 10


@dataclass(frozen=True, slots=True)
class Sampled:
    """joints (k,) : that move and were logged with effort. dof (k,) : their places in the arm. q, v, a (m, nv) :
    low-passed, rad or m, per s, per s^2. torque (m, k) : low-passed alike, N m or N. jumps (k,) : mean square by which
    each logged torque changes from one sample to the next over twice its variance, 1 of what no sample foretells.
    gravity (3,) : m/s^2, where it is not the model's."""

    joints: tuple[str, ...]
    dof: tuple[int, ...]
    q: FloatArray
    v: FloatArray
    a: FloatArray
    torque: FloatArray
    jumps: tuple[float, ...]
    gravity: FloatArray | None = None

    @classmethod
    def of(cls, arm: Arm, log: JointLog) -> "Sampled":
        """At some 2500 times; joints that are not logged stand at the model's reference."""
        even = Even.of(log.t)
        thin = even.settled(_SAMPLES)
        q, v, a = (y[thin] for y in even.motion(arm, log, np.asarray(arm.model.qpos0, dtype=np.float64)))
        joints = tuple(name for name in moving(arm, log) if name in log.effort)
        torque = [even.low(log.t, log.effort[name])[0][thin] for name in joints]
        dof = tuple(arm.joints.index(name) for name in joints)
        jumps = tuple(_jumping(log.effort[name]) for name in joints)
        return cls(joints, dof, q, v, a, np.column_stack(torque) if torque else np.empty((q.shape[0], 0)), jumps)

    def every(self, step: int) -> "Sampled":
        """Every so manieth sample."""
        return replace(self, **{name: getattr(self, name)[::step] for name in ("q", "v", "a", "torque")})

    def rigid(self, arm: Arm) -> tuple[FloatArray, FloatArray]:
        """Torque (m, k) of gravity and springs, and of inertia, that the model needs."""
        arm = arm if self.gravity is None else under(arm, self.gravity)
        still = np.zeros_like(self.q)
        held = arm.inverse(self.q, still, still)
        return held[:, self.dof], (arm.inverse(self.q, self.v, self.a) - held)[:, self.dof]

    def moves(self, joint: int) -> tuple[BoolArray, FloatArray]:
        """Samples (m,) at which a joint's direction is sure; direction, speed and one at those, (n, 3)."""
        v = self.v[:, self.dof[joint]]
        kept = np.abs(v) > _MOVING * float(np.max(np.abs(v), initial=0.0))
        v = v[kept]
        return kept, np.column_stack((np.sign(v), v, np.ones_like(v)))


def _jumping(u: FloatArray) -> float:
    """Of a torque (n,); see ``Sampled`` (von Neumann 1941)."""
    known = u[np.isfinite(u)]
    varies = float(np.var(known)) if known.size > 1 else 0.0
    return float(np.mean(np.diff(known) ** 2)) / (2.0 * varies) if varies > 0.0 else 0.0


def fitted(columns: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Numbers of columns (n, c) in y (n, ...), and what they leave of it."""
    numbers = np.linalg.lstsq(columns, y, rcond=1e-10)[0]
    return np.asarray(numbers), np.asarray(y - columns @ numbers)


def _with_error(of: Callable[[IntArray], float], size: int) -> tuple[float, float]:
    """A number that is had of samples, and its error by leaving out a tenth of them at a time."""
    rows: IntArray = np.arange(size)
    without = np.array([of(np.setdiff1d(rows, part)) for part in np.array_split(rows, _TENTHS)])
    return of(rows), float(np.sqrt((_TENTHS - 1) / _TENTHS * np.sum((without - without.mean()) ** 2)))


@dataclass(frozen=True, slots=True)
class Slope:
    """Logged over modelled torque, what else the joint's torque holds fitted beside it.

    value, error : of the ratio, its error from tenths of the log. correlation : of both, the rest taken off. size : rms
    of the modelled torque, the rest taken off, N m or N. left : rms of what nothing explains.
    """

    value: float
    error: float
    correlation: float
    size: float
    left: float

    @property
    def seen(self) -> bool:
        """Whether the log tells it from none."""
        return self.error > 0.0 and abs(self.value) > SURE * self.error

    @property
    def follows(self) -> bool:
        """Whether the log's torque goes with the model's, or against it."""
        return self.seen and abs(self.correlation) > CORRELATED.value


def slope(torque: FloatArray, modelled: FloatArray, beside: FloatArray) -> Slope | None:
    """The slope of torque (n,) on modelled (n,) beside columns (n, c); None where those hold all of the latter."""
    if torque.size < FEWEST:
        return None
    scale = np.sqrt(np.mean(beside**2, axis=0))
    u, m = fitted(beside[:, scale > 0.0] / scale[scale > 0.0], np.column_stack((torque, modelled)))[1].T
    size = float(np.sqrt(np.mean(m**2)))
    if size <= 1e-3 * float(np.sqrt(np.mean(modelled**2))) or size < _ROUNDING:
        return None
    value, error = _with_error(lambda rows: float(m[rows] @ u[rows] / max(m[rows] @ m[rows], 1e-300)), u.size)
    spread = float(np.sqrt((m @ m) * (u @ u)))
    left = float(np.sqrt(np.mean((u - value * m) ** 2)))
    return Slope(value, error, float(m @ u) / spread if spread > 0.0 else 0.0, size, left)


def loss(torque: FloatArray, rigid: FloatArray, friction: FloatArray) -> tuple[float, float]:
    """Mean power that friction takes, W, and its error from tenths of the log; friction (n, 3) as of ``Sampled``."""
    columns = np.column_stack((rigid, friction))

    def lost(rows: IntArray) -> float:
        numbers = fitted(columns[rows], torque[rows])[0]
        return float(np.mean((columns[:, -3:-1] @ numbers[-3:-1]) * friction[:, 1]))

    return _with_error(lost, torque.size)


def unexplained(sampled: Sampled, arm: Arm) -> FloatArray:
    """Share (k,) of each joint's squared torque that neither friction nor the rigid model times a factor explains.

    A factor that turns the model's torque counts only where friction is turned with it: then the torque's sign is.
    """
    rigid, shares = np.add(*sampled.rigid(arm)), np.zeros(len(sampled.joints))
    for j in range(shares.size):
        kept, friction = sampled.moves(j)
        u = sampled.torque[kept, j]
        if u.size < FEWEST or float(np.ptp(u)) == 0.0:
            continue
        numbers, left = fitted(np.column_stack((friction, rigid[kept, j])), u)
        power = float(np.mean((friction[:, :2] @ numbers[:2]) * friction[:, 1]))
        if numbers[-1] * power < 0.0:
            left = fitted(friction, u)[1]
        shares[j] = float(np.sum(left**2)) / float(np.sum((u - np.mean(u)) ** 2))
    return shares
