"""Columns that may be added to the regression of a whole arm: laws of friction, errors of the rigid model."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.model.terms import (
    asymmetric_viscous,
    force_ripple,
    friction_drift,
    load_dependent_friction,
    position_dependent_friction_cosine,
    quadratic_drag,
    stribeck,
)
from harness.robot.arm import Arm
from harness.robot.whole_arm.differentiate import Filtered
from harness.robot.whole_arm.perturb import moving_bodies, tilted, with_load, with_mass
from harness.robot.whole_arm.rules import (
    COVERED,
    DELAY_SPREAD,
    FASTEST_RIPPLE,
    GAIN_SPREAD,
    LOAD_SPREAD,
    MASS_SPREAD,
    MOMENT_SPREAD,
    SLOWEST_RIPPLE,
    TILT_SPREAD,
)

FRICTION, MODEL = "friction", "model"


@dataclass(frozen=True, slots=True)
class Setting:
    """values : what is not linear in the columns, by name and unit (("v_s", "rad/s", .1), ...); may be empty.

    given : its columns, or what makes them where there are too many settings to keep.
    """

    values: tuple[tuple[str, str, float], ...]
    given: dict[int, FloatArray] | Callable[[], dict[int, FloatArray]]

    @property
    def columns(self) -> dict[int, FloatArray]:
        """By joint, (m, c) torque for one unit of each of c numbers; joints it does not touch are left out."""
        return self.given if isinstance(self.given, dict) else self.given()


@dataclass(frozen=True, slots=True)
class Candidate:
    """One thing that may be missing.

    name : as results call it. family : FRICTION or MODEL. joint : the one it is of, None for the whole arm. settings :
    all with the same number of columns. numbers : name and unit of what multiplies each column. spread (c,) : standard
    deviation expected of each number beforehand, inf where anything goes. partner, pair : what it can never be told

    """

    name: str
    family: str
    joint: int | None
    settings: tuple[Setting, ...]
    numbers: tuple[tuple[str, str], ...]
    spread: FloatArray
    partner: str = ""
    pair: str = ""
    shape: Callable[[float], FloatArray] | None = None
    looks: float = 1.0
    """Independent settings that this one is the best of, where it was chosen among them and polished."""

    @property
    def key(self) -> tuple[str, int | None]:
        """What tells it from the others."""
        return self.name, self.joint

    def around(self, setting: int, value: float, numbers: FloatArray, looks: float) -> "Candidate":
        """The candidate at one value near a setting of its own, with a further column: what a step of value changes.

        numbers (c,) : of the columns at that value; the further number is the step. looks : settings it was among.
        """
        assert self.shape is not None
        (joint,) = self.settings[setting].columns
        ((what, unit, _),) = self.settings[setting].values
        step = _STEP * value
        slope = (self.shape(value + step) - self.shape(value - step)) @ numbers / (2.0 * step)
        columns = np.column_stack((self.shape(value), slope))
        at = Setting(((what, unit, value),), {joint: columns})
        more, spread = (*self.numbers, (what, unit)), np.append(self.spread, np.inf)
        return replace(self, settings=(at,), numbers=more, spread=spread, looks=looks)


_STEP = 1e-3
"""Share of a value by which it is moved to see what it changes."""


def free(count: int) -> FloatArray:
    """Of numbers about which nothing is expected."""
    return np.full(count, np.inf)


STRIBECK, LOAD, RIPPLE = stribeck.TERM.name, load_dependent_friction.TERM.name, force_ripple.TERM.name
POSITION, ASYMMETRIC = position_dependent_friction_cosine.TERM.name, asymmetric_viscous.TERM.name
QUADRATIC, DRIFT = quadratic_drag.TERM.name, friction_drift.TERM.name

LOAD_OR_POSITION = "load- or position-dependent friction of a gravity joint"
_SPEEDS = 10
"""Stribeck speeds that are tried."""
_NOTHING = 1e-9
"""N m or N: a range of gravity below it is rounding."""


def signs(v: FloatArray) -> FloatArray:
    """Mean sign (M,) of a speed (M,) over each sample's own step, taken for straight."""
    change = np.abs(np.gradient(v)) / 2.0
    return np.asarray(np.clip(v / np.maximum(change, 1e-300), -1.0, 1.0))


def base_columns(filtered: Filtered, joint: int) -> FloatArray:
    """Coulomb, viscous, offset (m, 3) of a joint."""
    dof = filtered.dof[joint]
    sign = filtered.column(signs(filtered.v_fine[:, dof]), jumps=True)
    return np.stack((sign, filtered.v[:, dof], np.ones_like(sign)), axis=1)


def friction_candidates(filtered: Filtered, joint: int, gravity: FloatArray, kept: BoolArray) -> Iterator[Candidate]:
    """What is judged on guarded samples ``kept`` (m,); gravity (M,) : torque of gravity on the joint, N m."""
    dof = filtered.dof[joint]
    q, v = filtered.q_fine[:, dof], filtered.v_fine[:, dof]
    sign, time = signs(v), (filtered.t_fine - filtered.t_fine[0]) / filtered.seconds - 0.5

    def one(*columns: FloatArray, jumps: bool = True) -> tuple[Setting, ...]:
        return (Setting((), {joint: filtered.column(np.stack(columns, axis=1), jumps)}),)

    slow = np.abs(filtered.v[kept, dof])
    if slow.size:
        least, most = np.quantile(slow, COVERED.value), np.quantile(slow, 0.7)
        speeds = np.geomspace(least, most, _SPEEDS) if least > 0.0 else np.empty(0)

        def fallen(v_s: float) -> FloatArray:
            return filtered.column((sign * np.exp(-((v / v_s) ** 2)))[:, None], jumps=True)

        settings = tuple(Setting((("v_s", "rad/s", float(v_s)),), {joint: fallen(float(v_s))}) for v_s in speeds)
        if settings:
            yield Candidate(STRIBECK, FRICTION, joint, settings, (("f_s - f_c", "N m"),), free(1), shape=fallen)
    if np.ptp(gravity) > _NOTHING:
        load = one(sign * np.abs(gravity))
        yield Candidate(LOAD, FRICTION, joint, load, (("share of load", "1"),), free(1))
    yield Candidate(
        ASYMMETRIC, FRICTION, joint, one(np.abs(v), jumps=False), (("half difference", "N m s/rad"),), free(1)
    )
    yield Candidate(QUADRATIC, FRICTION, joint, one(v * np.abs(v), jumps=False), (("c_2", "N m s^2/rad^2"),), free(1))
    numbers = (("rise of Coulomb", "N m"), ("rise of viscous", "N m s/rad"))
    yield Candidate(DRIFT, FRICTION, joint, one(sign * time, v * time), numbers, free(2))
    span = float(np.ptp(filtered.q[:, dof]))
    if span > 0.0:
        typical = float(np.median(np.abs(filtered.v[:, dof])))
        fastest = min(FASTEST_RIPPLE.value, math.pi * filtered.band.lowpass / max(typical, 1e-9))
        step = math.pi / (2.0 * span)
        waves = np.arange(max(SLOWEST_RIPPLE.value, 2.0 * math.pi / span), fastest, step)
        yield from _of_waves(RIPPLE, filtered, joint, np.ones_like(sign), q, waves)
        yield from _of_waves(POSITION, filtered, joint, sign, q, np.arange(step, fastest, step))


def _of_waves(
    name: str, filtered: Filtered, joint: int, by: FloatArray, q: FloatArray, waves: FloatArray
) -> Iterator[Candidate]:
    """Sine and cosine of the position at every wave number, 1/rad, times ``by`` (M,)."""
    if not waves.size:
        return
    middle = (np.max(q) + np.min(q)) / 2.0

    def waved(wave: float) -> FloatArray:
        angle = wave * (q - middle)
        return filtered.column(np.stack((by * np.sin(angle), by * np.cos(angle)), axis=1), jumps=name == POSITION)

    def at(wave: float) -> Setting:
        return Setting((("wave", "1/rad", wave),), lambda: {joint: waved(wave)})

    settings = tuple(at(float(wave)) for wave in waves)
    yield Candidate(name, FRICTION, joint, settings, (("sine", "N m"), ("cosine", "N m")), free(2), shape=waved)


INERTIA, PAYLOAD, MOTOR, DELAY = "inertia-error", "payload", "motor-constant", "torque-delay"
SENSOR, TILT, ARMATURE = "sensor-side", "tilt", "armature-error"

SCALE_OR_MASS = "scale of torque against mass"
MASS_AT_END = "extra mass at the end"
ROTOR_OR_AXIS = "armature or inertia about the axis"
WHICH_IS_LATE = "which of position and torque is late"
ROTOR_OR_SENSOR = "side of the sensor or a rotor's inertia"

_MODEL_STEP, _TURN, _BESIDE = 0.1, 0.01, 0.05
"""kg, rad and m: how far the model is moved to see what a load, a tilt and a place change; all but linear in them."""


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
        middle = changed(with_load(arm, _MODEL_STEP), _MODEL_STEP)
        beside = [changed(with_load(arm, _MODEL_STEP, _BESIDE * axis), _MODEL_STEP) - middle for axis in np.eye(3)]
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
    columns = np.stack([changed(with_mass(arm, body, 1.0 + _MODEL_STEP), _MODEL_STEP) for body in bodies], axis=2)
    numbers = tuple((f"{arm.model.body(body).name or f'body {body}'}", "1") for body in bodies)
    spread = np.full(len(bodies), MASS_SPREAD.value)
    settings = (Setting((), by_joint(columns)),)
    yield Candidate(INERTIA, MODEL, None, settings, numbers, spread, MOTOR, SCALE_OR_MASS)
