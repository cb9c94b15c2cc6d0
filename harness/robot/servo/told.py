"""What a servo's fit says in numbers with errors and sentences: units, what is told, what cannot be parted."""

import math
from collections.abc import Mapping

import numpy as np

from harness.core.quantity import Quantity
from harness.robot.servo.fit import ServoFit
from harness.robot.servo.plant import NUMBERS, Run
from harness.robot.servo.servo import Servo

_WEAK, _NONE = 0.03, 0.3
"""Relative standard errors up to which a number is told (6 % is two of them), and from which it is not."""
_NOT = "no part of the log shows it"
PLAIN = ("zero", "sine", "cosine")
"""Numbers whose size says nothing of how well they are known."""


def unit_of(name: str, scale: str) -> str:
    """Unit of a number; where nothing gives a scale, for each kg m^2 that turns."""
    unit = NUMBERS[name].unit
    if scale != "inertia" or not ("N m" in unit or "kg" in unit):
        return unit
    return "1" if unit == "kg m^2" else f"{unit} per kg m^2"


def quantities(found: ServoFit, scale: str) -> dict[str, Quantity]:
    """Numbers of a fit with their errors."""
    said = {}
    for name in found.free:
        error = found.errors[name]
        known = math.isfinite(error) and error > 0.0
        why = None if known else "it stands on its bound" if found.bound(name) else _NOT
        said[name] = Quantity(found.values[name], error if known else None, unit_of(name, scale), why)
    given = {name: value for name, value in found.logs.known.items() if math.isfinite(value)}
    return said | {name: Quantity(value, None, unit_of(name, scale), "given") for name, value in given.items()}


def verdicts(found: ServoFit) -> list[tuple[str, str, str]]:
    """Of each number whether the log tells it, and why not."""
    said = []
    partners = found.partners
    for name in found.free:
        error = found.errors[name]
        share = error / abs(found.values[name]) if found.values[name] else math.inf
        if name in PLAIN and math.isfinite(error):
            share = 0.0
        verdict = "identifiable" if share <= _WEAK else "weak" if share <= _NONE else "not"
        other, together = partners.get(name, ("", 0.0))
        why = "on its bound, without effect" if found.bound(name) else f"standard error of {100.0 * share:.2g} %"
        if verdict != "identifiable" and abs(together) > 0.9:
            why += f"; correlated with {other} ({together:.2f})"
        said.append((name, verdict, "" if verdict == "identifiable" else why))
    return said


def confounded(servo: Servo, runs: tuple[Run, ...]) -> list[str]:
    """What goal and position cannot part in these logs."""
    values, known = servo.best.values, servo.known
    said = []
    if "brake" in values and "c" in values:
        said.append("brake is the damping that the motor adds while it drives: k_t^2/R and kd together")
    else:
        given = "brake is the data sheet's, c what is more" if "c" in values else "all of it is written as brake"
        those = "the gears' damping and k_t^2/R" if "kd" in values else "the gears' damping, k_t^2/R and kd"
        said.append(f"{those} are one number ({given}): only a log with torque off separates them")
    if "gain" in servo.best.logs.known and known.servo is None:
        said.append(
            "torque and duty are one product: without a preset (--servo) the voltage's share is not identifiable"
        )
    if known.scale == "inertia":
        said.append(
            "without gravity's torque or a data sheet all torques are ratios to the inertia: --servo, or --robot where"
            " gravity turns the joint"
        )
    elif known.scale == "data sheet":
        said.append("all torques, the inertia too, are as large as the data sheet's torque at rest says")
    elif "zero" in values and all(np.ptp(run.q) < 0.5 for run in runs):
        said.append("over so small angles gravity's torque and the sensor's zero are nearly one")
    return said


def _fading(values: Mapping[str, float]) -> str:
    """Speed over which friction at rest fades, and how where it is not as a Gaussian."""
    shape = f", exponent {values['exponent']:.2g}" if "exponent" in values else ""
    return f"{values['v_s']:.2g} rad/s{shape}"


def dry_friction(values: Mapping[str, float]) -> list[str]:
    """What dry friction has besides Coulomb's, as numbers in words."""
    said = []
    if "f_s" in values:
        said.append(f"{values['f_s']:.3g} N m more at rest, fading over {_fading(values)}")
    if "load" in values:
        said.append(f"{100.0 * values['load']:.3g} % of what the gears carry")
    if "load_motor" in values:
        said.append(
            f"{100.0 * values['load_motor']:.3g} % of the motor's torque and {100.0 * values['load_external']:.3g} %"
            " of the load's"
        )
    if "load_rest" in values:
        said.append(
            f"{100.0 * values['load_rest']:.3g} % of the motor's torque more at rest, fading over {_fading(values)}"
        )
    return said
