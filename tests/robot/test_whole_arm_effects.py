"""Each effect of friction beside the base, put in strongly, is named in its joint and nowhere else."""

import math

import numpy as np
import pytest
from whole_arm_logs import LOWPASS, arm, log_of, machine, with_effect

from benchmarks.robot_calibrate.draws import loose
from benchmarks.robot_calibrate.plant import Friction
from harness.robot.whole_arm.friction_columns import (
    ASYMMETRIC,
    DRIFT,
    LOAD,
    LOAD_OR_POSITION,
    POSITION,
    QUADRATIC,
    RIPPLE,
    STRIBECK,
)
from harness.robot.whole_arm.result import Grade
from harness.robot.whole_arm.turning import BACKLASH, PRESLIDING, STATIC, bristles
from harness.robot.whole_arm.whole import whole_arm

JOINT = 3
COULOMB = float(machine()[0].coulomb[JOINT])
CASES: dict[str, tuple[Friction, dict[str, float]]] = {
    STRIBECK: (
        lambda t, q, v, g: 0.4 * COULOMB * np.sign(v) * np.exp(-((v / 0.25) ** 2)),
        {"f_s - f_c": 0.4 * COULOMB, "v_s": 0.25},
    ),
    LOAD: (lambda t, q, v, g: 0.05 * np.abs(g) * np.sign(v), {"share of load": 0.05}),
    RIPPLE: (lambda t, q, v, g: 0.2 * np.sin(9.0 * q), {"wave": 9.0}),
    POSITION: (lambda t, q, v, g: 0.3 * np.sign(v) * np.sin(5.0 * q), {"wave": 5.0}),
    ASYMMETRIC: (lambda t, q, v, g: 0.3 * np.abs(v), {"half difference": 0.3}),
    QUADRATIC: (lambda t, q, v, g: 0.3 * v * np.abs(v), {"c_2": 0.3}),
    DRIFT: (lambda t, q, v, g: 0.3 * np.sign(v) * t / 12.0, {"rise of Coulomb": 0.3}),
    PRESLIDING: (lambda t, q, v, g: COULOMB * (bristles(q, 0.004) - np.sign(v)), {"length": 0.004, "held": COULOMB}),
    STATIC: (lambda t, q, v, g: 0.5 * COULOMB * np.sign(v) * np.exp(-((v / 0.05) ** 2)), {"v_s": 0.05}),
    BACKLASH: (loose(0.01), {"share": 1.0}),
}


@pytest.mark.parametrize("name", CASES)
def test_an_effect_is_named_with_its_numbers_in_its_joint_alone(name: str) -> None:
    plant, motion = machine()
    effect, numbers = CASES[name]
    found = whole_arm(log_of(with_effect(plant, JOINT, effect), motion), arm(), lowpass=LOWPASS)
    assert found.named == ((name, f"joint{JOINT + 1}"),)
    (told,) = found.joints[JOINT].effects
    # what is pasted is the line through all of the friction that acts, whatever its law
    t = np.linspace(0.0, 12.0, 3000)
    q, v, _ = motion.at(t)
    slides = np.abs(v[:, JOINT]) > 0.15
    friction = with_effect(plant, JOINT, effect).friction(t, q, v)[slides, JOINT]
    columns = np.column_stack((np.sign(v[slides, JOINT]), v[slides, JOINT], np.ones(int(slides.sum()))))
    line = found.joints[JOINT].line
    assert line is not None

    def left(coulomb: float, viscous: float) -> float:
        rest = friction - columns[:, :2] @ (coulomb, viscous)
        return float(np.std(rest))

    best = left(*np.linalg.lstsq(columns, friction, rcond=None)[0][:2])
    assert left(line[0].value or 0.0, line[1].value or 0.0) < 1.1 * best + 0.02 * COULOMB
    values = dict(told.parameters)
    for what, truth in numbers.items():
        assert values[what].value == pytest.approx(truth, rel=0.1)
    assert told.share > 0.5
    assert told.grade in (Grade.EXPLAINS, Grade.MAIN)
    before, after = found.joints[JOINT].held_out or (0.0, 0.0)
    assert after < before or name in (PRESLIDING, STATIC, BACKLASH)
    for _, value in told.parameters:
        assert str(value) in told.statement or name == BACKLASH


def test_load_and_position_of_one_gravity_joint_are_a_pair() -> None:
    """Alone in its plane, a joint's load is a function of its position: neither can be named without the other."""
    plant, motion = machine()
    still = motion.amplitude.copy()
    still[[i for i in range(7) if i != 1]] = 0.0
    middle = motion.middle.copy()
    middle[1] = 1.0
    alone = type(motion)(middle, still, motion.frequency, motion.phase)
    effect: Friction = lambda t, q, v, g: 0.05 * np.abs(g) * np.sign(v)  # noqa: E731
    found = whole_arm(log_of(with_effect(plant, 1, effect), alone), arm(), joints=("joint2",), lowpass=LOWPASS)
    told = [e for e in found.joint("joint2").effects if e.name in (LOAD, POSITION)]
    assert told, found.joint("joint2")
    assert all(e.pair == LOAD_OR_POSITION for e in told)


def test_bristles_turn_over_their_length() -> None:
    q = np.concatenate((np.linspace(0.0, 0.1, 1000), np.linspace(0.1, 0.0, 1000)))
    state = bristles(q, 0.01)
    after = np.abs(q - 0.1)
    exact = -1.0 + 2.0 * np.exp(-after / 0.01)
    assert state[1000:] == pytest.approx(exact[1000:], abs=1e-9 + 2.0 * math.exp(-9.0))
