"""What a likelihood that knew everything could tell of a joint: bounds of errors, and the gain of an effect."""

import math
from dataclasses import dataclass

import numpy as np

from benchmarks.robot_calibrate.plant import JOINTS, Motion, Plant
from harness.core.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Path:
    """What an arm went through: t (n,), q, v (n, 7), torque of gravity, and noise of the torque (7,) and its memory.

    inertia (7, 7) : kg m^2, at the first sample.
    """

    plant: Plant
    t: FloatArray
    q: FloatArray
    v: FloatArray
    gravity: FloatArray
    sigma: FloatArray
    inertia: FloatArray

    @classmethod
    def of(cls, plant: Plant, motion: Motion, seconds: float, rate: float) -> "Path":
        """Along a motion, at the log's own samples."""
        t = np.arange(round(seconds * rate) + 1) / rate
        q, v, a = motion.at(t)
        still = np.zeros_like(q)
        torque = plant.arm.inverse(q, v, a) + plant.friction(t, q, v)
        middle, none = np.repeat(q[:1], JOINTS, axis=0), np.zeros((JOINTS, JOINTS))
        inertia = plant.arm.inverse(middle, none, np.eye(JOINTS)) - plant.arm.inverse(middle, none, none)
        return cls(plant, t, q, v, plant.arm.inverse(q, still, still), plant.sigma(torque), inertia)


class Limit:
    """Information of a log about one joint, within the filter's band, its noise known at every frequency."""

    def __init__(self, path: Path, lowpass: float, joint: int) -> None:
        self.t, self.q, self.v = path.t, path.q[:, joint], path.v[:, joint]
        self.gravity = path.gravity[:, joint]
        plant, rate = path.plant, 1.0 / float(path.t[1])
        f = np.fft.rfftfreq(self.t.size, 1.0 / rate)
        kept = np.exp(-1.0 / (rate * plant.memory)) if plant.memory > 0.0 else 0.0
        turn = 2 * math.pi * f / rate
        density = float(path.sigma[joint]) ** 2 * (1 - kept**2) / np.abs(1 - kept * np.exp(-1j * turn)) ** 2
        # the encoders' steps, through the accelerations of all joints
        step = 2 * math.pi / plant.counts if plant.counts else 0.0
        density = density + (2 * math.pi * f) ** 4 * step**2 / 12.0 * float(np.sum(path.inertia[:, joint] ** 2))
        self._weight = np.where(f < lowpass, 1.0 / np.sqrt(density * self.t.size / 2.0), 0.0)
        self._weight[0] /= math.sqrt(2.0)
        self._base = self._seen(np.stack((np.sign(self.v), self.v, np.ones_like(self.v)), axis=1))

    def _seen(self, columns: FloatArray) -> FloatArray:
        """Columns (n, c) in units of the noise, real and imaginary parts apart."""
        spectrum = np.fft.rfft(columns, axis=0) * self._weight[:, None]
        spectrum = spectrum[self._weight > 0.0]
        return np.concatenate((spectrum.real, spectrum.imag))

    @property
    def bounds(self) -> FloatArray:
        """Least standard errors (3,) of Coulomb, viscous and offset."""
        return np.asarray(np.sqrt(np.diag(np.linalg.inv(self._base.T @ self._base))))

    def gain(self, torque: FloatArray) -> float:
        """Expected gain, twice the logarithm of a likelihood, of an added torque (n,)."""
        seen = self._seen(torque[:, None])
        left = seen - self._base @ np.linalg.lstsq(self._base, seen, rcond=None)[0]
        return float(np.sum(left**2))
