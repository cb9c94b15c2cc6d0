"""Columns of what sliding friction may have beside Coulomb, viscous and offset, through the filter of the torque."""

import math
from collections.abc import Iterator

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
from harness.robot.whole_arm.candidate import FRICTION, Candidate, Setting, free
from harness.robot.whole_arm.differentiate import Filtered
from harness.robot.whole_arm.rules import COVERED, FASTEST_RIPPLE, SLOWEST_RIPPLE

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
