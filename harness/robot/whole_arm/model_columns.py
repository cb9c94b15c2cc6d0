"""Columns of what may be wrong beside friction: masses, a load, a tilt, rotors, scale and lateness of the torque."""

from collections.abc import Callable, Iterator

import numpy as np

from harness.core.arrays import FloatArray
from harness.robot.arm import Arm
from harness.robot.whole_arm.candidate import MODEL, Candidate, Setting, free
from harness.robot.whole_arm.differentiate import Filtered
from harness.robot.whole_arm.perturb import moving_bodies, tilted, with_load, with_mass
from harness.robot.whole_arm.rules import (
    DELAY_SPREAD,
    GAIN_SPREAD,
    LOAD_SPREAD,
    MASS_SPREAD,
    MOMENT_SPREAD,
    TILT_SPREAD,
)

INERTIA, PAYLOAD, MOTOR, DELAY = "inertia-error", "payload", "motor-constant", "torque-delay"
SENSOR, TILT, ARMATURE = "sensor-side", "tilt", "armature-error"

SCALE_OR_MASS = "scale of torque against mass"
MASS_AT_END = "extra mass at the end"
ROTOR_OR_AXIS = "armature or inertia about the axis"
WHICH_IS_LATE = "which of position and torque is late"
ROTOR_OR_SENSOR = "side of the sensor or a rotor's inertia"

_STEP, _TURN, _BESIDE = 0.1, 0.01, 0.05
"""kg, rad and m: how far the model is moved to see what a load, a tilt and a place change; all but linear in them."""
_NOTHING = 1e-9
"""N m or N: a change below it is rounding."""


def model_candidates(
    filtered: Filtered, arm: Arm, payload_known: bool, sensor_known: bool, gain_known: bool
) -> Iterator[Candidate]:
    """Errors of the model and of the torque's record that stand beside friction."""
    rigid = arm.inverse(filtered.q, filtered.v, filtered.a)
    joints, dofs = range(len(filtered.dof)), np.array(filtered.dof)

    def by_joint(columns: FloatArray) -> dict[int, FloatArray]:
        return {j: np.ascontiguousarray(columns[:, j]) for j in joints}

    def changed(other: Arm, step: float) -> FloatArray:
        return np.asarray((other.inverse(filtered.q, filtered.v, filtered.a) - rigid)[:, dofs] / step)

    yield from _masses(arm, changed, by_joint)
    if not payload_known:
        middle = changed(with_load(arm, _STEP), _STEP)
        beside = [changed(with_load(arm, _STEP, _BESIDE * axis), _STEP) - middle for axis in np.eye(3)]
        columns = np.stack((middle, *(c / _BESIDE for c in beside)), axis=2)
        numbers = (("mass", "kg"), *((f"moment {axis}", "kg m") for axis in "xyz"))
        spread = np.array([LOAD_SPREAD.value, *[MOMENT_SPREAD.value] * 3])
        partner = "mass of the last link"
        settings = (Setting((), by_joint(columns)),)
        yield Candidate(PAYLOAD, MODEL, None, settings, numbers, spread, partner, MASS_AT_END)
    turned = np.stack([changed(tilted(arm, _TURN, axis), _TURN) for axis in (0, 1)], axis=2)
    if np.max(np.abs(turned)) > _NOTHING:
        numbers = (("about x", "rad"), ("about y", "rad"))
        yield Candidate(TILT, MODEL, None, (Setting((), by_joint(turned)),), numbers, np.full(2, TILT_SPREAD.value))
    late = -np.gradient(rigid[:, dofs], 1.0 / filtered.out.rate, axis=0)[:, :, None]
    settings = (Setting((), by_joint(late)),)
    yield Candidate(
        DELAY, MODEL, None, settings, (("delay", "s"),), np.full(1, DELAY_SPREAD.value), "early position", WHICH_IS_LATE
    )
    if not sensor_known and np.any(arm.armature[dofs] > 0.0):
        unseen = -(arm.armature * filtered.a)[:, dofs][:, :, None]
        settings = (Setting((), by_joint(unseen)),)
        share = (("share of rotors unseen", "1"),)
        yield Candidate(SENSOR, MODEL, None, settings, share, np.ones(1), ARMATURE, ROTOR_OR_SENSOR)
    for j, dof in enumerate(filtered.dof):
        about = {j: filtered.a[:, dof : dof + 1]}
        numbers = (("inertia", "kg m^2"),)
        partner = "inertia of the link about the axis"
        yield Candidate(ARMATURE, MODEL, j, (Setting((), about),), numbers, free(1), partner, ROTOR_OR_AXIS)
        if not gain_known:
            more = (Setting((), {j: rigid[:, dof : dof + 1]}),)
            yield Candidate(
                MOTOR, MODEL, j, more, (("gain - 1", "1"),), np.full(1, GAIN_SPREAD.value), INERTIA, SCALE_OR_MASS
            )
    if not gain_known:
        more = (Setting((), by_joint(rigid[:, dofs, None])),)
        yield Candidate(
            MOTOR, MODEL, None, more, (("gain - 1", "1"),), np.full(1, GAIN_SPREAD.value), INERTIA, SCALE_OR_MASS
        )


def _masses(
    arm: Arm, changed: Callable[[Arm, float], FloatArray], by_joint: Callable[[FloatArray], dict[int, FloatArray]]
) -> Iterator[Candidate]:
    """Every body's mass and inertia times a factor of its own."""
    bodies = moving_bodies(arm)
    columns = np.stack([changed(with_mass(arm, body, 1.0 + _STEP), _STEP) for body in bodies], axis=2)
    numbers = tuple((f"{arm.model.body(body).name or f'body {body}'}", "1") for body in bodies)
    spread = np.full(len(bodies), MASS_SPREAD.value)
    settings = (Setting((), by_joint(columns)),)
    yield Candidate(INERTIA, MODEL, None, settings, numbers, spread, MOTOR, SCALE_OR_MASS)
