"""Seven joints whose friction is known, moved along sums of sines: the logs that the figures are measured on.

The motion is prescribed, so that the torque is the rigid model's plus friction along it: exact, and cheap.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.core.robot import JointLog
from harness.robot.arm import Arm

JOINTS = 7
_LINKS = (
    ("0 0 .333", "1 0 0 0", 4.97, ".004 .002 -.048", ".703 .707 .0091 0 .0068 .0192"),
    ("0 0 0", "1 -1 0 0", 0.647, "-.003 -.029 .0035", ".008 .0281 .026 -.0039 .0103 .0007"),
    ("0 -.316 0", "1 1 0 0", 3.229, ".0275 .0393 -.0665", ".0372 .0362 .0108 -.0048 -.0114 -.0128"),
    ("-.0825 0 0", "1 1 0 0", 3.588, "-.0532 .1044 .0275", ".0259 .0196 .0283 .0078 -.0013 .0086"),
    ("-.0825 .384 0", "1 -1 0 0", 1.226, "-.012 .0411 -.0384", ".0355 .0295 .0086 -.0021 -.004 .0002"),
    ("0 0 0", "1 1 0 0", 1.667, ".0601 -.0141 -.0105", ".0020 .0044 .0054 .0001 -.0012 .0003"),
    (".088 0 0", "1 1 0 0", 0.736, ".0105 -.0043 .0616", ".0125 .01 .0048 -.0004 -.0012 -.0007"),
)
"""Place, turn, mass, centre of mass and inertia of each link, near those of a Panda."""
ARMATURE = 0.1
_SIZE = (1.0, 1.0, 0.8, 0.8, 0.4, 0.3, 0.2)
"""Friction of the joints beside the first one's."""

Friction = Callable[[FloatArray, FloatArray, FloatArray, FloatArray], FloatArray]
"""Torque (n,) that an effect adds along t, q, v and the joint's gravity torque."""


def seven_joints(armature: float = ARMATURE) -> Arm:
    """The arm, as its user's model has it."""
    text, tail = "", ""
    for i, (pos, quat, mass, centre, inertia) in enumerate(_LINKS):
        text += (
            f"<body pos='{pos}' quat='{quat}'><joint name='joint{i + 1}' axis='0 0 1' armature='{armature}'/>"
            f"<inertial mass='{mass}' pos='{centre}' fullinertia='{inertia}'/>"
        )
        tail += "</body>"
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><compiler balanceinertia='true'/><option gravity='0 0 -9.81'/>"
        f"<worldbody>{text}{tail}</worldbody></mujoco>"
    )
    none = np.zeros(JOINTS)
    return Arm("seven.xml", model, tuple(f"joint{i + 1}" for i in range(JOINTS)), np.full(JOINTS, armature), none, none)


@dataclass(frozen=True, slots=True)
class Motion:
    """Sums of sines: middle (7,) rad; amplitude, frequency, phase (7, m): rad, Hz, rad."""

    middle: FloatArray
    amplitude: FloatArray
    frequency: FloatArray
    phase: FloatArray

    @classmethod
    def drawn(cls, rng: np.random.Generator, fast: bool = True) -> "Motion":
        """Four sines of .1 to .6 Hz a joint, and where ``fast`` two small ones of 1.5 to 3 Hz."""
        slow = rng.uniform(0.1, 0.6, (JOINTS, 4))
        quick = rng.uniform(1.5, 3.0, (JOINTS, 2))
        speed = np.hstack((rng.uniform(0.2, 0.6, slow.shape), rng.uniform(0.05, 0.2, quick.shape) * fast))
        frequency = np.hstack((slow, quick))
        middle = np.array([0.0, 0.2, 0.0, -1.8, 0.0, 1.8, 0.0]) + rng.uniform(-0.3, 0.3, JOINTS)
        return cls(middle, speed / (2 * math.pi * frequency), frequency, rng.uniform(0, 2 * math.pi, frequency.shape))

    def at(self, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """q, v, a (n, 7) at times (n,)."""
        found = [np.empty((t.size, JOINTS)) for _ in range(3)]
        for j in range(JOINTS):
            turn = 2 * math.pi * self.frequency[j]
            angle = np.outer(t, turn) + self.phase[j]
            found[0][:, j] = self.middle[j] + np.sin(angle) @ self.amplitude[j]
            found[1][:, j] = np.cos(angle) @ (self.amplitude[j] * turn)
            found[2][:, j] = -np.sin(angle) @ (self.amplitude[j] * turn**2)
        return found[0], found[1], found[2]


@dataclass(frozen=True, slots=True)
class Plant:
    """The machine behind a log, as the arm's file does not know it.

    arm : the true one. coulomb, viscous, offset (7,) : N m, N m s/rad, N m. effects : by joint, what friction has
    beside them. gain (7,) : measured over true torque. late : s, of the torque's record. noise : share of the rms
    torque. memory : s, of that noise; 0 for white at the log's rate. counts : of the encoder, a turn.
    """

    arm: Arm
    coulomb: FloatArray
    viscous: FloatArray
    offset: FloatArray
    effects: dict[int, Friction] = field(default_factory=dict)
    gain: FloatArray = field(default_factory=lambda: np.ones(JOINTS))
    late: float = 0.0
    noise: float = 0.01
    memory: float = 0.0
    counts: int = 2**16

    @classmethod
    def drawn(cls, rng: np.random.Generator, arm: Arm) -> "Plant":
        """A clean machine: Coulomb friction of 1 to 8 N m in the first joint, less further out."""
        size = np.array(_SIZE)
        coulomb = size * np.exp(rng.uniform(0.0, math.log(8.0), JOINTS))
        viscous = size * np.exp(rng.uniform(math.log(0.5), math.log(10.0), JOINTS))
        return cls(arm, coulomb, viscous, size * rng.uniform(-0.5, 0.5, JOINTS))

    def friction(self, t: FloatArray, q: FloatArray, v: FloatArray, base: bool = True) -> FloatArray:
        """Torque (n, 7) of friction; ``base`` : with Coulomb, viscous and offset."""
        found = np.zeros_like(q)
        if base:
            found += self.coulomb * np.sign(v) + self.viscous * v + self.offset
        still = np.zeros_like(q)
        gravity = self.arm.inverse(q, still, still) if self.effects else still
        for j, effect in self.effects.items():
            found[:, j] += effect(t, q[:, j], v[:, j], gravity[:, j])
        return found

    def sigma(self, torque: FloatArray) -> FloatArray:
        """Standard deviation (7,) of the torque's noise."""
        return np.asarray(self.noise * np.sqrt(np.mean(torque**2, axis=0)), dtype=np.float64)

    def log(self, rng: np.random.Generator, motion: Motion, seconds: float = 20.0, rate: float = 1000.0) -> JointLog:
        """What somebody records of it."""
        t = np.arange(round(seconds * rate) + 1) / rate
        q = motion.at(t)[0]
        q_then, v_then, a_then = motion.at(t - self.late)
        torque = self.arm.inverse(q_then, v_then, a_then) + self.friction(t - self.late, q_then, v_then)
        noise = rng.standard_normal(torque.shape)
        if self.memory > 0.0:
            noise = _remembering(noise, math.exp(-1.0 / (rate * self.memory)))
        measured = self.gain * torque + self.sigma(torque) * noise
        count = 2 * math.pi / max(self.counts, 1)
        seen = np.round(q / count) * count if self.counts else q
        names = [f"joint{i + 1}" for i in range(JOINTS)]
        return JointLog(
            t,
            {name: seen[:, i].copy() for i, name in enumerate(names)},
            effort={name: measured[:, i].copy() for i, name in enumerate(names)},
            file="simulated",
        )


def _remembering(white: FloatArray, kept: float) -> FloatArray:
    """Noise (n, k) of unit variance that keeps this share from sample to sample."""
    found = np.empty_like(white)
    found[0] = white[0]
    for i in range(1, white.shape[0]):
        found[i] = kept * found[i - 1] + math.sqrt(1.0 - kept**2) * white[i]
    return found
