"""Servos as their makers and others measured them: from where a fit starts, and what a log need not tell."""

import math
from dataclasses import dataclass

from harness.core.errors import InputError, did_you_mean

_KG_CM = 0.0980665
_RPM = math.pi / 30.0
_PULSES = 4096 / (2.0 * math.pi)


@dataclass(frozen=True, slots=True)
class Preset:
    """A servo. volts : nominal, V. stall : torque at rest a volt, N m/V. k_t : V s/rad, from the speed without load.
    kp : gain as it is shipped. gain : duty over the error of position (rad) and over kp; None where nobody has measured
    it. limit : of the duty. most : torque at the limit of the current, N m, None for none. armature : kg m^2. f_k, c :
    of the gears, N m and N m s/rad. source : of all of these.
    """

    name: str
    volts: float
    stall: float
    k_t: float
    kp: float
    gain: float | None
    limit: float
    armature: float
    f_k: float
    c: float
    source: str
    most: float | None = None

    @property
    def brake(self) -> float:
        """k_t^2/R, N m s/rad."""
        return self.stall * self.k_t


def _by_sheet(volts: float, torque: float, speed: float) -> tuple[float, float, float]:
    """Volts, stall torque a volt and k_t of a data sheet's stall torque (N m) and speed without load (rad/s)."""
    return volts, torque / volts, volts / speed


_BAM = "Rhoban/bam (Apache-2.0)"
_EMANUAL = "emanual.robotis.com"
_X = _PULSES / 256.0 / 885.0
"""Duty over rad and kp of an XL330: present PWM over error in sixteen logs of four gains, 885 for all of it."""
PRESETS = {
    one.name: one
    for one in (
        Preset(
            *("sts3215", 7.4, 1.2116 / 2.6762, 1.2116, 32.0, 0.166, 0.97, 0.0284, 0.0524, 0.0591),
            f"{_BAM}: params/feetech_sts3215_7_4V/m1.json, gain by oscilloscope",
        ),
        Preset(
            *("sts3215-12v", 12.0, 1.4440 / 2.0296, 1.4440, 32.0, 0.1619, 0.97, 0.0325, 0.1959, 0.0305),
            f"{_BAM}: params/feetech_sts3215_12V/m1.json",
        ),
        Preset(
            *("sts3250", *_by_sheet(12.0, 50.0 * _KG_CM, math.pi / 3.0 / 0.133), 32.0, None, 0.97, 0.03, 0.2, 0.03),
            "data sheet of 2024-01-16 (50 kg cm, 0.133 s/60 deg at 12 V); rotor and friction about an STS3215's",
        ),
        Preset(
            *("xl330", *_by_sheet(5.0, 0.52, 103.0 * _RPM), 400.0, _X, 1.0, 0.0017, 0.02, 0.008),
            f"{_EMANUAL}: XL330-M288-T (0.52 N m and 1.47 A, 103 rpm at 5 V; limit of 1.75 A); rotor by {_BAM}",
            1.75 * 0.52 / 1.47,
        ),
        Preset(
            *("xl430", *_by_sheet(11.1, 1.4, 57.0 * _RPM), 800.0, None, 1.0, 0.005, 0.05, 0.02),
            f"{_EMANUAL}: XL430-W250-T (1.4 N m, 57 rpm at 11.1 V); rotor and friction guessed, where a fit starts",
        ),
        Preset(
            *("xc330", *_by_sheet(5.0, 0.93, 81.0 * _RPM), 400.0, _X, 1.0, 0.002, 0.02, 0.01),
            f"{_EMANUAL}: XC330-M288-T (0.93 N m, 81 rpm at 5 V); gain, rotor and friction as the XL330's",
        ),
    )
}


def preset(name: str) -> Preset:
    """The servo of this name, in capitals or not. Raises InputError that lists those there are."""
    found = PRESETS.get(name.lower())
    if found is None:
        listed = ", ".join(PRESETS)
        raise InputError("--servo", f"{name!r}", f"one of {listed}{did_you_mean(name.lower(), PRESETS)}")
    return found
