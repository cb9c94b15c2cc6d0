"""A joint under its servo, from its logs: what is known of it, from where it is fitted, and what comes out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import uniform_filter1d

from harness.core.arrays import FloatArray
from harness.robot.servo.fit import Logs, ServoFit
from harness.robot.servo.plant import Run
from harness.robot.servo.presets import Preset
from harness.robot.servo.search import Search, search

_RIPPLE = 0.5
"""s over which a logged voltage is averaged: switching shows in single readings, a supply that sags in their mean."""
_FREQUENCIES = (5.0, 10.0, 20.0, 40.0)
"""rad/s, of a joint on its servo, from which an unknown one is looked for."""
_DELAYS = (0.0, 0.03)
_ZETA = 0.8
_PULLED = 0.05
"""Least torque of gravity over the motion's own by which it gives a scale."""
_OFF = 0.02
"""Share of samples without drive from which the motor's brake is told from the gears' damping."""


@dataclass(frozen=True, slots=True)
class Known:
    """What is known of a joint before it is fitted.

    servo : None where nobody names it. loaded : the model's inertia and gravity are used. scale : what torques are in:
    "N m" by gravity's torque or by the servo's data sheet, else N m for each kg m^2 of all that turns.
    """

    servo: Preset | None
    loaded: bool
    scale: str


@dataclass(frozen=True)
class Servo:
    """What a servo's logs say. said : what each number stands for and what it cannot be told from."""

    known: Known
    found: Search
    sayable: ServoFit

    @property
    def best(self) -> ServoFit:
        return self.found.best


def averaged(t: FloatArray, volts: FloatArray) -> FloatArray:
    """A logged voltage without what changes from reading to reading."""
    width = max(round(_RIPPLE / float(np.median(np.diff(t)))), 1)
    return np.asarray(uniform_filter1d(volts, width, mode="nearest"))


def identified(
    runs: Sequence[Run], servo: Preset | None, loaded: bool, progress: Callable[[str], None] = lambda said: None
) -> Servo:
    """Numbers of a joint's servo and friction, with the terms that its logs ask for.

    runs : of one joint. loaded : their loads are the model's; else they are not used. Raises SimulationError where no
    start can be simulated.
    """
    gravity = max(float(np.max(np.hypot(run.load[:, 1], run.load[:, 2]))) for run in runs) if loaded else 0.0
    inertia = float(np.median(np.concatenate([run.load[:, 0] for run in runs]))) if loaded else 0.0
    weighs = gravity > _PULLED * inertia * max(_FREQUENCIES) if loaded else False
    if loaded and not weighs and servo is None:
        # an inertia alone gives no scale: the rotor's, which is as large, is in no model
        runs, loaded = [replace(run, load=np.zeros_like(run.load)) for run in runs], False
    known: dict[str, float] = {}
    if servo is not None and servo.gain is not None:
        known |= {"gain": servo.gain, "limit": servo.limit}
    elif servo is None:
        known |= {"gain": 1.0}
    if not weighs and servo is not None:
        known["stall"] = servo.stall
    if not _switched_off(runs):
        # friction under load needs the motor's torque without what its own voltage takes of it
        known |= {"c": 0.0} if servo is None else {"brake": servo.brake}
    ratio = servo is None and not loaded
    if ratio:
        known["armature"] = 1.0
    scale = "gravity" if weighs else "data sheet" if servo is not None else "inertia"
    torque = servo.stall * servo.volts if servo is not None else max(gravity, inertia * 100.0, 100.0 if ratio else 0.0)
    logs = Logs.of(runs, known, torque)
    found = search(logs, _starts(logs, servo, inertia if loaded else 0.0, not loaded), progress)
    return Servo(Known(servo, loaded, scale), found, found.base)


def _switched_off(runs: Sequence[Run]) -> bool:
    """Whether the servo does not drive for long enough to part its damping from the gears'."""
    return float(np.mean(np.concatenate([run.on for run in runs]) == 0.0)) > _OFF


def _starts(logs: Logs, servo: Preset | None, inertia: float, free: bool) -> list[dict[str, float]]:
    """Where a fit may begin, the numbers that it fits; free : of a load that no model gives."""
    more = {"sine": 0.0, "cosine": 0.0} if free else {"zero": 0.0}
    tries = []
    if servo is not None:
        own = {"stall": servo.stall, "armature": servo.armature, "f_k": servo.f_k, **more}
        own |= {"brake": servo.brake, "c": servo.c}
        if servo.gain is None:
            own["gain"] = 0.166 if servo.kp < 100.0 else 0.003
        for factor in (1.0, 4.0) if free else (1.0,):
            tries += [{**own, "armature": factor * own["armature"], "delay": delay} for delay in _DELAYS]
    else:
        kp, volts = logs.runs[0].kp, float(np.median(logs.runs[0].volts))
        whole = inertia or 1.0
        for omega in _FREQUENCIES:
            stiff = whole * omega**2
            own = {"stall": stiff / (kp * volts), "armature": 0.3 * whole, "f_k": 0.02 * stiff, **more}
            own |= {"brake": 2.0 * _ZETA * whole * omega, "c": 0.2 * whole * omega}
            tries += [{**own, "delay": delay} for delay in _DELAYS]
    return [{name: value for name, value in one.items() if name not in logs.known} for one in tries]
