"""Arms whose joints all move, as their user has them: a log of every joint's torque, and the model."""

import math
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.proof.paths import chain, joints, plant
from harness.proof.paths.forms import ARM, OF_MODEL, Rng, Scales, _between
from harness.proof.paths.rigs import BARE, COMMANDED, NONE, _moves, followed, projected, unseen

NAMES = (
    ("joint1", "joint2", "joint3", "joint4", "joint5"),
    ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2"),
    ("j1", "j2", "j3", "j4", "j5"),
)
_SIZE = np.array([1.0, 1.0, 0.7, 0.35, 0.25])
"""Friction of the joints beside the first one's."""
_HARMONICS = 5
_STEP, _FINEST = 1e-3, 8
"""s of an integration, and in how many a controller's tick is divided at most."""
_CALM = 3.0
"""Times what the motion needs that a loop asks for at most."""


@dataclass(frozen=True, slots=True, eq=False)
class Arm:
    """What does not change when an effect is made larger.

    links : of n joints. tool : where the hand holds one, m. b (n, 5) : of each joint as a rig's, k none. offset (n,) :
    of its torque's zero. goal, speed, ahead (m, n) : of the controllers, gains (n, 4). rest (n,) : the middle of its
    way, that positions count from. joint : the one with an effect. sigma (n, 4) : noise of x, v and u, and of
    u for all that acts from one sample to the next.
    """

    names: tuple[str, ...]
    links: tuple[joints.Link, ...]
    tool: tuple[float, float, float]
    b: FloatArray
    offset: FloatArray
    goal: FloatArray
    speed: FloatArray
    ahead: FloatArray
    gains: FloatArray
    rest: FloatArray
    joint: int
    tick: float
    every: int
    count: float
    channels: str
    sigma: FloatArray
    path: str = ARM

    @property
    def dt(self) -> float:
        """s, between samples of the log."""
        return self.tick * self.every

    def bodies(self, tool: float = 0.0) -> FloatArray:
        """As ``chain`` has them; tool : its share of the last link's mass."""
        mass = tool * self.links[-1].mass
        held = [*self.tool, 0.0, 0.0, 0.0, mass, 0.0, 0.0, 0.0, *(mass * side for side in (2e-3, 2e-3, 1e-3)), 0.0]
        return np.array([*(link.numbers for link in self.links), held])

    def run(self, p: FloatArray, tables: FloatArray = NONE) -> FloatArray:
        """True motion (m, n, 4) where it is logged: x, v, a, u."""
        return self.ticks(p, tables)[:: self.every]

    def ticks(self, p: FloatArray, tables: FloatArray = NONE) -> FloatArray:
        """The same at every tick of the controllers."""
        every = np.zeros((len(self.links), p.size))
        every[self.joint] = p
        up = chain.G * np.array([0.0, math.sin(p[plant.TILT]), math.cos(p[plant.TILT])])
        fine = max(round(self.tick / _STEP), math.ceil(self.tick * self._stiff(p)))
        rows = chain.controlled(
            self.goal, self.speed, self.ahead, self.count, self.gains, self.tick, min(fine, _FINEST),
            self.rest, self.bodies(p[plant.TOOL]), up, self.b, every, tables,
        )  # fmt: skip
        return np.asarray(rows)

    def _stiff(self, p: FloatArray) -> float:
        """rad/s, of a joint on its bristles, twice as fast as where they give way."""
        if p[plant.BRISTLE] == 0.0:
            return 0.0
        inertia = 1.0 / np.linalg.inv(chain.masses(self.bodies(), self.rest))[self.joint, self.joint]
        return 2.0 * math.sqrt(float(self.b[self.joint, 3]) / p[plant.BRISTLE] / inertia)

    def scales(self, run: FloatArray) -> Scales:
        """Of the joint with the effect, in a motion without it."""
        m, c, _, f_k, _ = map(float, self.b[self.joint])
        x, v = run[:, self.joint, 0], run[:, self.joint, 1]
        fast, span = float(np.percentile(np.abs(v), 98)), self.dt * len(run)
        return Scales(m, c, 0.0, f_k, fast, float(np.max(np.abs(x))), span, 0.05 * span, self.dt)

    def shown(self, run: FloatArray, p: FloatArray) -> FloatArray:
        """x and u (m, n, 2) without noise, as encoders and amplifiers show them."""
        seen = run[:, :, (0, 3)].copy()
        seen[:, self.joint, 0] += p[plant.MARK]
        seen[:, self.joint, 1] *= 1.0 - p[plant.WEAK]
        if p[plant.FILTER] > 0.0:
            kept = math.exp(-self.dt / p[plant.FILTER])
            for i in range(1, len(seen)):
                seen[i, :, 1] += kept * (seen[i - 1, :, 1] - seen[i, :, 1])
        seen[:, :, 1] += self.offset
        return seen

    def _extra(self, run: FloatArray, p: FloatArray) -> FloatArray:
        """Torque (m, n) that the user's model and friction without effects lack."""
        seen, (v, a) = self.shown(run, p), (run[:, :, i].copy() for i in (1, 2))
        up = np.array([0.0, 0.0, chain.G])
        own = chain.rigid(self.bodies(), up, self.rest + seen[:, :, 0], v, a)
        return np.asarray(seen[:, :, 1] - own - self.b[:, 1] * v - self.b[:, 3] * np.sign(v) - self.offset)

    def loss(self, p: FloatArray, tables: FloatArray = NONE) -> float:
        """Log-likelihood that the base is expected to lose, in effective samples, as of a joint that moves alone."""
        if self.dt * self._stiff(p) > 1.0:
            # a joint that rings on its bristles from sample to sample looks like anything, and shows nothing
            return 0.0
        run = self.run(p, tables)
        if not np.all(np.isfinite(run)) or np.max(np.abs(run)) > 1e9:
            return math.nan
        extra, total = self._extra(run, p), 0.0
        for j in range(len(self.links)):
            v = run[:, j, 1]
            columns = [v, np.sign(v), np.ones_like(v)]
            total += followed(extra[:, j], v, columns, self.dt, float(self.b[j, 0]), *self.sigma[j, (0, 3)])
        return total

    def laws_of(self, p: FloatArray, tables: FloatArray) -> dict[str, float]:
        """The share of an unknown effect's squares that each law takes beside the base of its joint."""
        run = self.run(p, tables)
        x, v = run[:, self.joint, 0], run[:, self.joint, 1]
        columns = [v, np.sign(v), np.ones_like(v)]
        return projected(x, v, self.dt, self._extra(run, p)[:, self.joint], columns)

    def right(self, names: tuple[str, ...]) -> list[str]:
        """Names with the joint that they are of; errors of the model are of none but a motor's."""
        return [name if name in OF_MODEL else f"{self.names[self.joint]}: {name}" for name in names]

    def files(self, rng: Rng, p: FloatArray, tables: FloatArray) -> tuple[dict[str, str], list[str], bool]:
        """Log and model by the name of its file, the options, and whether they are more than necessary."""
        run = self.run(p, tables)
        seen, told = self.shown(run, p), {}
        for j, name in enumerate(self.names):
            x, v, u = self.rest[j] + seen[:, j, 0], run[:, j, 1], seen[:, j, 1]
            shown = {"x": np.floor(x / self.count + 0.5) * self.count, "v": v, "u": u}
            for c, sigma in (("v", self.sigma[j, 1]), ("u", self.sigma[j, 2])):
                shown[c] = shown[c] + sigma * rng.standard_normal(v.size)
            told[name] = {c: shown[c] for c in self.channels}
        log = joints.torques(joints.layout(rng), self.dt * np.arange(float(len(run))), told)
        file = "robot.urdf" if all(link.rotor == 0.0 for link in self.links) else "robot.xml"
        text = (joints.urdf if file.endswith("urdf") else joints.mjcf)(self.links)
        free = bool(rng.random() < 0.5)
        options = ["--robot", file, *([] if free else ["--joint", "all", "--sensor", "motor"])]
        return {"recording.csv": log, file: text}, options, not free


def draw_arm(rng: Rng) -> Arm:
    """An arm of three to five hinges, the first upright, from small ones of 3 kg to ones of 30 kg."""
    n, size = int(rng.integers(3, 6)), _between(rng, 0.4, 1.4)
    names = NAMES[int(rng.integers(len(NAMES)))][:n]
    rotors = rng.random() < 0.5
    links = list[joints.Link]()
    for j, name in enumerate(names):
        long, thick = size * rng.uniform(0.15, 0.4), size * rng.uniform(0.05, 0.1)
        mass = 8.0 * size**2 * float(_SIZE[j]) * rng.uniform(0.5, 1.5)
        # along z, the first two joints' axes across one another, those behind in any of three
        axis = ("z", "y", "yx"[int(rng.integers(2))], "xyz"[int(rng.integers(3))], "xyz"[int(rng.integers(3))])[j]
        across = mass / 12.0 * (long**2 + thick**2)
        links.append(
            joints.Link(
                body=f"link{j + 1}", joint=name, at=(0.0, 0.0, links[-1].long if links else 0.3), long=long,
                axis=(float(axis == "x"), float(axis == "y"), float(axis == "z")), mass=mass,
                centre=(thick * rng.uniform(-0.5, 0.5), thick * rng.uniform(-0.5, 0.5), long * rng.uniform(0.3, 0.6)),
                turning=(across, across, mass / 6.0 * thick**2),
                rotor=mass * size**2 * rng.uniform(0.02, 0.08) if rotors else 0.0,
            )
        )  # fmt: skip
    tick = float(rng.choice([0.001, 0.002]))
    every = int(rng.choice([1, 2, 4] if tick == 0.002 else [2, 4, 8]))
    seconds = rng.uniform(12.0, 24.0)
    m = int(seconds / tick / every) * every + 1
    goal, speed, bend = _way(rng, tick * np.arange(float(m)), n)
    rest = np.concatenate(([rng.uniform(-1.0, 1.0)], rng.uniform(0.3, 1.2, n - 1) * rng.choice([-1.0, 1.0], n - 1)))
    count = 2.0 * math.pi / 2.0 ** int(rng.integers(14, 21))
    arm = Arm(
        names, tuple(links), (0.0, 0.03 * size, links[-1].long), np.zeros((n, 5)), np.zeros(n), goal, speed,
        np.zeros_like(goal), np.zeros((n, 4)), rest, int(rng.integers(n)), tick, every, count,
        "xvu" if rng.random() < 0.5 else "xu", np.zeros((n, 4)),
    )  # fmt: skip
    bodies, up = arm.bodies(), np.array([0.0, 0.0, chain.G])
    needed = chain.rigid(bodies, up, rest + goal, speed, bend)
    inertia = chain.masses(bodies, rest)
    # of a joint while the others give way, to which loops of their own must be set
    inertia, least = np.diag(inertia).copy(), 1.0 / np.diag(np.linalg.inv(inertia))
    b, top = arm.b, np.max(np.abs(needed), axis=0)
    b[:, 0] = inertia
    band = min(_between(rng, 20.0, 50.0), 0.1 / tick)
    level = np.maximum(top, 0.1 * np.max(top) * _SIZE[:n]) * np.exp(rng.uniform(math.log(0.05), math.log(0.5), n))
    # what a loop so stiff moves all the same
    b[:, 3] = np.minimum(level, 0.03 * least * band**2)
    b[:, 1] = b[:, 3] / np.max(np.abs(speed), axis=0) * np.exp(rng.uniform(math.log(0.1), 0.0, n))
    slow, fed = rng.uniform(0.0, 0.15), float(rng.random() < 0.5)
    ahead = needed * fed + 0.8 * b[:, 3] * np.tanh(50.0 * speed) * float(rng.random() < 0.3)
    arm = replace(arm, ahead=ahead, offset=b[:, 3] * rng.uniform(-0.1, 0.1, n) * float(rng.random() < 0.5))
    while True:
        each = (least * band**2, 1.6 * least * band, least * band**3 * slow, np.full(n, min(1.0, tick * 10.0 * band)))
        arm.gains[:] = np.column_stack(each)
        run = arm.ticks(BARE)
        # loops of their own on joints that move one another are stable where they are slow enough
        if np.all(np.max(np.abs(run[:, :, 3]), axis=0) < _CALM * (top + 2.0 * b[:, 3] + 0.1 * np.max(top))):
            break
        band *= 0.7
    spread = np.std(run, axis=0)
    share = _between(rng, 3e-4, 2e-2) if rng.random() < 0.6 else COMMANDED
    between = [unseen(u, every) for u in run[:, :, 3].T]
    noise = spread[:, 3] * share
    of_x, of_v = np.full(n, count / math.sqrt(12.0)), spread[:, 1] * _between(rng, 1e-3, 1e-2)
    arm.sigma[:] = np.column_stack((of_x, of_v, noise, np.hypot(noise, between)))
    return arm


def _way(rng: Rng, t: FloatArray, n: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Goals (m, n), speeds and accelerations: a Fourier series that begins at rest, or moves to and fro, each joint its
    own (Swevers and others 1997)."""
    found = np.zeros((3, t.size, n))
    series = rng.random() < 0.6
    for j in range(n):
        travel = rng.uniform(0.6, 2.0)
        if not series:
            fastest = 1.9 * travel / (t[-1] / rng.uniform(12.0, 24.0))
            found[:, :, j] = _moves(rng, t, travel, fastest)
            continue
        turn = 2.0 * math.pi * rng.uniform(0.08, 0.16) * np.arange(1.0, _HARMONICS + 1.0)
        size, phase = rng.standard_normal(_HARMONICS) / np.sqrt(turn), rng.uniform(0.0, 6.3, _HARMONICS)
        angle = np.outer(t, turn) + phase
        q, v, a = np.sin(angle) @ size, np.cos(angle) @ (size * turn), -np.sin(angle) @ (size * turn**2)
        by = travel / np.ptp(q)
        # taken up within the first second, by a smooth step
        s = np.clip(t, 0.0, 1.0)
        up, up1, up2 = s**3 * (10 - 15 * s + 6 * s**2), 30 * s**2 * (1 - s) ** 2, 60 * s * (1 - s) * (1 - 2 * s)
        found[:, :, j] = by * np.stack((up * q, up1 * q + up * v, up2 * q + 2.0 * up1 * v + up * a))
    return found[0], found[1], found[2]
