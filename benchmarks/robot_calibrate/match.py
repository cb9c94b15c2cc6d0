"""python -m benchmarks.robot_calibrate.match --draws N: logs that do not go together with their model.

Each log of the plant is compared as it is, and changed in every way below. Right is an answer whose option undoes the
change: with the columns that it gives, the log is the one before, up to a degree and a tenth of a scale. Where two
changes do the same to this arm, both are said, and one of them has to.
"""

import argparse
import math
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.robot_calibrate.plant import JOINTS, Motion, Plant, seven_joints
from harness.core.arrays import FloatArray
from harness.core.robot import JointLog
from harness.robot.arm import Arm
from harness.robot.match.compared import UNITS, compare
from harness.robot.whole_arm.perturb import moving_bodies, with_load, with_mass

_SECONDS, _RATE = 20.0, 250.0
"""s and Hz: of each log."""
_DEGREE = math.radians(1.0)
_SCALE = 0.1
"""Share to which a scale is right."""
_NAMES = [f"joint{i + 1}" for i in range(JOINTS)]
_LOADED = (1, 2, 3, 4, 5)
"""Joints whose zero gravity tells; it does little to the last one, whose centre of mass is near its axis."""


@dataclass(frozen=True, slots=True)
class Changed:
    """q, u (n, 7) : the log. right : whether options, by name, undo the change."""

    q: FloatArray
    u: FloatArray
    right: Callable[[Mapping[str, str]], bool]


Kind = Callable[[np.random.Generator, FloatArray, FloatArray], Changed]


def _scaled(scale: FloatArray | float) -> Kind:
    def change(rng: np.random.Generator, q: FloatArray, u: FloatArray) -> Changed:
        def right(options: Mapping[str, str]) -> bool:
            wanted = 1.0 / (np.asarray(scale) * np.ones(JOINTS))
            return set(options) == {"--gain"} and bool(
                np.all(np.abs(_gains(options["--gain"]) / wanted - 1.0) < _SCALE)
            )

        return Changed(q, u * scale, right)

    return change


def _gains(text: str) -> FloatArray:
    if "=" not in text:
        return np.full(JOINTS, float(text))
    given = dict(part.split("=") for part in text.split(","))
    return np.array([float(given.get(name, 1.0)) for name in _NAMES])


def _amperes(rng: np.random.Generator, q: FloatArray, u: FloatArray) -> Changed:
    return _scaled(1.0 / rng.uniform(3.0, 15.0, JOINTS))(rng, q, u)


def _one_sign(rng: np.random.Generator, q: FloatArray, u: FloatArray) -> Changed:
    sign = np.ones(JOINTS)
    sign[rng.integers(JOINTS)] = -1.0
    return _scaled(sign)(rng, q, u)


def _swapped(rng: np.random.Generator, q: FloatArray, u: FloatArray) -> Changed:
    i, k = rng.choice(JOINTS, 2, replace=False)
    order = np.arange(JOINTS)
    order[[i, k]] = k, i
    return Changed(q[:, order], u[:, order], lambda o: set(o) == {"--names"} and _pair(o["--names"], i, k, "="))


def _efforts(rng: np.random.Generator, q: FloatArray, u: FloatArray) -> Changed:
    i, k = rng.choice(JOINTS, 2, replace=False)
    order = np.arange(JOINTS)
    order[[i, k]] = k, i
    return Changed(q, u[:, order], lambda o: set(o) == {"--names"} and _pair(o["--names"], i, k, ".effort="))


def _pair(text: str, i: int, k: int, between: str) -> bool:
    return any(text.startswith(f"{_NAMES[a]}{between}{_NAMES[b]}") for a, b in ((i, k), (k, i)))


def _flipped(rng: np.random.Generator, q: FloatArray, u: FloatArray) -> Changed:
    i, sign = int(rng.choice(_LOADED)), np.ones(JOINTS)
    sign[i] = -1.0
    return Changed(q * sign, u * sign, lambda o: dict(o) == {"--flip": _NAMES[i]})


def _zero(rng: np.random.Generator, q: FloatArray, u: FloatArray) -> Changed:
    i, offset = int(rng.choice(_LOADED)), math.radians(float(rng.choice((-90.0, 45.0, 60.0, 90.0, 180.0))))

    def right(options: Mapping[str, str]) -> bool:
        name, _, value = options.get("--offset", "").partition("=")
        turned = math.remainder(float(value or "nan") - offset, 2.0 * math.pi) if value else math.inf
        return set(options) == {"--offset"} and name == _NAMES[i] and abs(turned) < _DEGREE

    shift = np.zeros(JOINTS)
    shift[i] = offset
    return Changed(q - shift, u, right)


def _degrees(rng: np.random.Generator, q: FloatArray, u: FloatArray) -> Changed:
    return Changed(np.degrees(q), u, lambda o: dict(o) == {"--angle-unit": "deg"})


KINDS: Mapping[str, Kind] = {
    "all signs": _scaled(-1.0),
    "amperes": _amperes,
    "mN m": _scaled(UNITS["mN m"]),
    "lbf ft": _scaled(UNITS["lbf ft"]),
    "two swapped": _swapped,
    "two efforts swapped": _efforts,
    "one sign": _one_sign,
    "one axis turned": _flipped,
    "a zero off": _zero,
    "degrees": _degrees,
}


def _another(rng: np.random.Generator, arm: Arm) -> Arm:
    """A robot with masses far from the plant's, its links turned by quarters."""
    other = arm
    for body in moving_bodies(arm):
        other = with_mass(other, body, float(np.exp(rng.uniform(-1.5, 1.5))))
    model = other.model
    turned = np.array(model.body_quat)
    for body in range(1, model.nbody):
        model.body_quat[body] = turned[int(rng.integers(1, model.nbody))]
    return other


def _logged(plant: Plant, motion: Motion, rng: np.random.Generator) -> JointLog:
    return plant.log(rng, motion, _SECONDS, _RATE)


def _of(log: JointLog, q: FloatArray, u: FloatArray) -> JointLog:
    position, effort = ({name: y[:, i].copy() for i, name in enumerate(_NAMES)} for y in (q, u))
    return JointLog(log.t, position, effort=effort)


def _options(text: str) -> dict[str, str]:
    words = text.split()
    return dict(zip(words[::2], words[1::2], strict=True))


def main(argv: Sequence[str] | None = None) -> int:
    """Draw, and print; exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.robot_calibrate.match")
    parser.add_argument("--draws", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--clean", action="store_true", help="unchanged logs alone")
    told = parser.parse_args(argv)
    count: dict[str, list[bool]] = {}
    for number in range(told.draws):
        rng = np.random.default_rng((told.seed, number))
        arm = seven_joints()
        plant = replace(Plant.drawn(rng, arm), memory=0.01 * (number % 2))
        motion = Motion.drawn(rng)
        log = _logged(plant, motion, rng)
        count.setdefault("clean, quiet", []).append(not compare(arm, log).statement)
        wrong = arm
        for body in moving_bodies(arm):
            wrong = with_mass(wrong, body, float(rng.choice((0.9, 1.1))))
        heavy = with_load(wrong, float(rng.uniform(0.5, 3.0)), rng.uniform(-0.05, 0.05, 3))
        log_of_heavy = _logged(replace(plant, arm=heavy), motion, rng)
        count.setdefault("masses 10 % off and a load, quiet", []).append(not compare(arm, log_of_heavy).statement)
        if told.clean:
            continue
        q, u = (np.column_stack([of[name] for name in _NAMES]) for of in (log.position, log.effort))
        for name, kind in KINDS.items():
            changed = kind(rng, q, u)
            found = compare(arm, _of(log, changed.q, changed.u))
            twins = re.findall(r"\((--\S+ \S+)\)", found.statement)
            undone = any(changed.right(_options(option)) for option in (found.option, *twins))
            count.setdefault(name, []).append(undone)
        found = compare(_another(rng, seven_joints()), log)
        count.setdefault("another robot, refused", []).append(bool(found.statement))
    for name, right in count.items():
        print(f"{name}: {sum(right)} of {len(right)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
