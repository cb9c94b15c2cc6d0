"""A joint under a servo: what is known of its log, and the numbers that its free run depends on."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from harness.core.arrays import FloatArray, read_only
from harness.robot.servo.kernel import GAUSSIAN, NAMES, free_run


class Number(NamedTuple):
    """A number of the plant: unit, an ordinary size of it where torques are of order 1 N m, its bounds."""

    unit: str
    size: float
    lower: float = 0.0
    upper: float = np.inf


NUMBERS: Mapping[str, Number] = {
    "stall": Number("N m/V", 0.1, 1e-9),
    "gain": Number("1/rad", 0.1, 1e-9),
    "kd": Number("s/rad", 0.02),
    "limit": Number("1", 1.0, 1e-3),
    "brake": Number("N m s/rad", 0.05),
    "armature": Number("kg m^2", 0.005, 1e-7),
    "c": Number("N m s/rad", 0.05, -np.inf),
    "f_k": Number("N m", 0.05),
    "f_s": Number("N m", 0.05),
    "v_s": Number("rad/s", 0.2, 0.02, 5.0),
    "load": Number("1", 0.1, 0.0, 0.95),
    "load_motor": Number("1", 0.1, 0.0, 0.95),
    "load_external": Number("1", 0.1, 0.0, 0.95),
    "load_rest": Number("1", 0.1, 0.0, 0.95),
    "delay": Number("s", 0.01, 0.0, 0.3),
    "dead": Number("rad", 0.01, 0.0, 0.2),
    "play": Number("rad", 0.01, 0.0, 0.2),
    "zero": Number("rad", 0.02, -np.inf),
    "sine": Number("N m", 0.2, -np.inf),
    "cosine": Number("N m", 0.2, -np.inf),
    "ramp": Number("rad/s", 5.0, 0.05),
    "haste": Number("rad/s^2", 1000.0, 1.0),
    "most": Number("N m", 0.5, 1e-4),
    "concave": Number("1", 0.1, 0.0, 0.8),
    "exponent": Number("1", 1.0, 0.3, 4.0),
    "concave_power": Number("1", 1.0, 1.0, 8.0),
    "dead_power": Number("1", 1.0, 1.0, 8.0),
}
"""stall : torque at rest a volt. gain : duty over the error of position and over the servo's own gain. kd : duty
over speed. limit : of the duty. brake : of the motor's own voltage, while it drives (k_t^2/R). c : of the gears,
or what is more than a given brake. f_k : dry friction at speed, f_s : more at rest, fading over v_s. load :
friction over what the gears carry; of the motor's torque and of the load's, where they differ; load_rest : more
of it at rest. delay : of goals. dead : error without effect. play : of the gears. zero : what the sensor shows at
the model's zero. sine, cosine : of gravity without a model's. ramp : speed at which a goal moves at most, haste :
how fast it takes that up and leaves it. most : torque, by the current's limit. concave : share of the torque that
is lost at full duty, by a power concave_power of the duty, 1 where it is not given. exponent : of how friction at
rest fades, 2 where it is not given. dead_power : of the error e over a dead band d of which a share 1/(1 + (e/d)^p)
is lost; where it is not given, all within and as much beyond."""
_AT = {name: i for i, name in enumerate(NAMES)}
_STARTS = 3
"""Samples on each side of a start from which its speed is read."""


@dataclass(frozen=True)
class Run:
    """A log of one joint; arrays (n,).

    t : s. q, goal : rad. volts : V. on : 1 where the servo drives. load (n, 3) : as the kernel has it. kp : the servo's
    own gain in force, 1 where nobody says it.
    """

    t: FloatArray
    q: FloatArray
    goal: FloatArray
    volts: FloatArray
    on: FloatArray
    load: FloatArray
    kp: float = 1.0
    file: str = "log"

    @cached_property
    def step(self) -> float:
        """Least difference of two positions, rad: the sensor's step where it has one."""
        values = np.unique(self.q)
        return float(np.min(np.diff(values))) if values.size > 1 else 0.0

    def windows(self, longest: float, first: int = 0, last: int | None = None) -> list[tuple[int, int]]:
        """First and last sample + 1 of stretches of at most ``longest`` seconds, each of its own start.

        first, last : between which samples, the last not among them; all of the log.
        """
        last = self.t.size if last is None else last
        begin, end = self.t[first], self.t[last - 1]
        count = max(round((end - begin) / longest), 1)
        edges = np.searchsorted(self.t, np.linspace(begin, end, count + 1))
        edges[0], edges[-1] = first, last
        return [(int(a), int(b)) for a, b in pairwise(edges) if b - a > 2 * _STARTS]

    def start(self, at: int) -> tuple[float, float]:
        """Position and speed at a sample, rad and rad/s, by a parabola through its neighbours; at rest, none."""
        if at not in self._starts:
            self._starts[at] = self._start(at)
        return self._starts[at]

    @cached_property
    def _starts(self) -> dict[int, tuple[float, float]]:
        return {}

    def _start(self, at: int) -> tuple[float, float]:
        low = min(max(at - _STARTS, 0), self.t.size - 2 * _STARTS - 1)
        t, q = self.t[low : low + 2 * _STARTS + 1] - self.t[at], self.q[low : low + 2 * _STARTS + 1]
        if np.ptp(q) <= 2.5 * self.step:
            return float(np.mean(q)), 0.0
        _, slope, level = np.polyfit(t, q, 2)
        return float(level), float(slope)

    def simulated(self, values: Mapping[str, float], windows: list[tuple[int, int]]) -> FloatArray:
        """Positions (n,) by these numbers, window by window; as logged where no window is."""
        theta, found = numbers(values, self.kp), self.q.copy()
        t, goal = read_only(self.t), read_only(self.goal)
        for first, last in windows:
            state = np.tile(self.start(first), 2)
            free_run(theta, t, goal, self.volts, self.on, self.load, first, state, found[first:last])
        return found


def numbers(values: Mapping[str, float], kp: float) -> FloatArray:
    """The kernel's array; what is not given is without effect. kp : the servo's own gain."""
    theta = np.zeros(len(NAMES))
    theta[_AT["limit"]], theta[_AT["v_s"]], theta[_AT["exponent"]] = np.inf, 0.1, GAUSSIAN
    theta[_AT["concave_power"]] = 1.0
    for name, value in values.items():
        if name == "gain":
            theta[_AT["kp"]] = value * kp
        elif name == "load":
            theta[_AT["load_motor"]] = theta[_AT["load_external"]] = value
        else:
            theta[_AT[name]] = value
    return theta
