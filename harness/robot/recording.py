"""One joint of a log as a recording, in the terms of its own equation."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.robot.joint_log import JointLog
from harness.robot.reduction import Reduced

Pull = Literal["spring", "pendulum", "none"]
_LOAD = 100.0
"""Times what the rigid model asks for, above or below which an effort has hardly that unit."""


@dataclass(frozen=True, slots=True)
class OneJoint:
    """A joint's motion and, where it is driven, its torque, what the model knows besides taken off.

    recording : x is the position from ``rest`` (rad or m), v, and u. restoring : what pulls x back. inertia : kg m^2 or
    kg where no torque tells it, else None. notes : what was done, one sentence each. warnings : what looks wrong.
    """

    recording: Recording
    restoring: Pull
    rest: float
    inertia: float | None
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def driven(self) -> bool:
        """Whether a measured torque acts."""
        return self.inertia is None


def one_joint(log: JointLog, own: Reduced) -> OneJoint:
    """The recording of a joint whose equation is ``own``.

    Raises InputError for a free swing of a joint that nothing pulls back, or that gravity and a spring of its own do.
    """
    name = own.joint
    effort = log.effort.get(name)
    driven = effort is not None and float(np.ptp(effort)) > 0.0
    pull = _pull(own)
    where = f"{log.file}: {name}"
    if not driven:
        found = f"no {name}.effort" if effort is None else f"a {name}.effort that is {effort[0]:g} throughout"
        if pull == "none":
            why = "a slide" if own.slides else "an axis along gravity"
            raise InputError(where, f"{found}, and nothing pulls {why} back", "an effort in N m or N is accepted")
        if pull == "pendulum" and own.spring > 0.0:
            accepted = "an effort is accepted, which tells the two apart"
            raise InputError(where, f"{found}, and both gravity and a spring pull it back", accepted)
    q = log.position[name]
    rest = _rest(own, pull, q, driven)
    channels: dict[str, FloatArray] = {"x": q - rest}
    if name in log.velocity and float(np.ptp(log.velocity[name])) > 0.0:
        channels["v"] = log.velocity[name]
    notes, warnings = list(log.notes), []
    unit = "m" if own.slides else "rad"
    if pull != "none":
        notes.append(f"{name}.position is counted from {rest:.6g} {unit}, where it is at rest.")
    if driven and effort is not None:
        warnings += _scale(log, own, effort)
        channels["u"], taken = _drive(own, pull, q, effort)
        notes += taken
    recording = Recording(log.t, channels, log.file, log.sha256, angular=not own.slides, notes=tuple(notes))
    return OneJoint(recording, pull, rest, None if driven else own.moved, warnings=tuple(warnings))


def _pull(own: Reduced) -> Pull:
    if not own.slides and not own.upright:
        return "pendulum"
    return "spring" if own.spring > 0.0 else "none"


def _rest(own: Reduced, pull: Pull, q: FloatArray, driven: bool) -> float:
    """The position from which x is counted; of a pendulum the nearest of those a turn apart."""
    if pull == "spring":
        return own.q_ref
    if pull == "none":
        return 0.0
    near = float(np.mean(q)) if driven else float(q[-1])
    return own.q_eq + 2.0 * math.pi * round((near - own.q_eq) / (2.0 * math.pi))


def _drive(own: Reduced, pull: Pull, q: FloatArray, effort: FloatArray) -> tuple[FloatArray, list[str]]:
    """The effort without what the model knows and the fit has no word for."""
    taken, u = [], effort
    if pull == "pendulum" and own.spring > 0.0:
        u = u - own.spring * (q - own.q_ref)
        taken.append(f"The torque of the joint's own spring, {own.spring:.4g} N m/rad, is taken off its effort.")
    if own.slides and own.constant != 0.0:
        u = u - own.constant
        taken.append(f"Gravity's {own.constant:.4g} N are taken off its effort.")
    return u, taken


def _scale(log: JointLog, own: Reduced, effort: FloatArray) -> list[str]:
    """What an effort's size says of its unit."""
    load = own.load(log.position[own.joint])
    asked, given = (float(np.sqrt(np.mean(one**2))) for one in (load, effort))
    if asked == 0.0 or own.upright or asked / _LOAD < given < asked * _LOAD:
        return []
    unit = "N" if own.slides else "N m"
    return [
        f"the effort of {own.joint} is {given:.3g} rms, and its gravity alone asks for {asked:.3g} {unit}:"
        f" it is hardly in {unit}"
    ]
