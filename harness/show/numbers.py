"""How what is shown is written: numbers, units, headings, colours, names of engines."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from harness.core.quantity import outweighs
from harness.core.trajectory import Source
from harness.results.common import P

REFERENCE = "#8a93a0"
_PAIRS = (  # (tuned and the like, as shipped): hues that stay apart for most colour-blind readers
    ("#e4632d", "#f2b087"),
    ("#2b7fd6", "#93c3f2"),
    ("#1f9e77", "#8fd3bd"),
    ("#a45bc2", "#d6b1e4"),
    ("#b58900", "#e3cf7c"),
)


def colors(sources: Sequence[Source]) -> list[str]:
    """Hex colours: grey for the first (the reference), a hue for each engine, pale for its as-shipped preset."""
    names = list(dict.fromkeys(source.name for source in sources[1:]))
    found = [REFERENCE]
    for source in sources[1:]:
        strong, pale = _PAIRS[names.index(source.name) % len(_PAIRS)]
        found.append(pale if source.preset == "as-shipped" else strong)
    return found[: len(sources)]


def of_engines(sources: Sequence[Source]) -> list[str]:
    """The same where there is no reference."""
    return colors([Source("reference"), *sources])[1:]


def of_names(count: int) -> list[str]:
    """So many hues, strong ones first; they begin anew where there are too few."""
    hues = [strong for strong, _ in _PAIRS] + [pale for _, pale in _PAIRS]
    return [hues[i % len(hues)] for i in range(count)]


@dataclass(frozen=True, slots=True)
class MotionUnits:
    """name, x, factor : of the position and what it is multiplied by. small : of a difference, times 1e3. v, a : SI."""

    name: str
    x: str
    factor: float
    small: str
    v: str
    a: str


SLIDES = MotionUnits("position", "mm", 1e3, "mm", "m/s", "m/s²")
TURNS = MotionUnits("angle", "rad", 1.0, "mrad", "rad/s", "rad/s²")


def units_of(scenario: Mapping[str, Any]) -> MotionUnits:
    """Those of a scenario's result: a pendulum turns."""
    turns = (scenario.get("model") or {}).get("restoring") == "pendulum"
    return TURNS if turns else SLIDES


def without_step(scenario: Mapping[str, Any]) -> str:
    """How the reference of a scenario's result moves: a slider by closed forms, any other model from event to event."""
    return "exact from event to event" if scenario.get("model") else "closed form"


MINUS = "\u2212"
NONE = "\u2013"

MOST_DIGITS = 9
"""Significant digits of a value at most, however small its standard error."""

SHOWN: dict[str, tuple[str, float]] = {"m": ("mm", 1e3), "m/s": ("mm/s", 1e3)}
"""SI unit -> the unit shown, and how many of it one SI unit is."""


_POWER = re.compile(r"\^(-?\d+)")
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def plain(text: str) -> str:
    """With a true minus sign, and powers of ten as people write them."""
    if "e" in text and text[0] in "-0123456789":
        mantissa, exponent = text.split("e")
        return f"{mantissa.replace('-', MINUS)}·10{str(int(exponent)).translate(_RAISED)}"
    return text.replace("-", MINUS)


def number(value: float | None, digits: int = 4) -> str:
    """``digits`` significant digits; a dash for None."""
    if value is None or not math.isfinite(value):
        return NONE
    if value == 0.0:
        return "0"
    power = int(f"{value:.{digits - 1}e}".partition("e")[2])  # of the rounded value: 0.9999 is 1.00 in three digits
    if -4 <= power < 7:
        return plain(f"{value:.{max(0, digits - 1 - power)}f}")
    return plain(f"{value:.{digits - 1}e}")


def with_error(value: float, stderr: float | None) -> tuple[str, str]:
    """The value to the second digit of its standard error, and that error; ("2.300", "0.012")."""
    if stderr is None:
        return number(value, 4), ""
    if stderr == 0.0:
        return number(value, 6), "0"
    finest = math.floor(math.log10(abs(value))) - MOST_DIGITS + 2 if value else -12
    decimals = 1 - max(math.floor(math.log10(stderr)), finest)
    if decimals > 12 or decimals < 0:
        return number(value, 6), number(stderr, 2)
    shown = f"{stderr:.{decimals}f}"
    return plain(f"{value:.{decimals}f}"), plain(shown) if float(shown) else number(stderr, 2)


def shown_unit(unit: str) -> str:
    """What stands at a number of this SI unit, "mm" for "m"; nothing at a pure number."""
    return _shown(unit)[0]


def shown_number(value: float | None, unit: str, digits: int = 4) -> str:
    """A number in the unit shown, without it."""
    return number(None if value is None else value * _shown(unit)[1], digits)


def squared(text: str) -> str:
    """Powers as people print them: "kg m²" for "kg m^2"."""
    return _POWER.sub(lambda found: found[1].translate(_RAISED), text)


def _shown(unit: str) -> tuple[str, float]:
    return SHOWN.get(unit, ("" if unit == "1" else squared(unit), 1.0))


def quantity(p: P) -> tuple[str, str, str]:
    """Value, standard error and unit, in the unit shown; value "\u2013" when it was refused."""
    unit, factor = _shown(p.unit)
    if p.value is None:
        return NONE, "", unit
    value, stderr = with_error(p.value * factor, None if p.stderr is None else p.stderr * factor)
    return value, stderr, unit


def systematic(p: P) -> str:
    """A systematic error that is larger than the standard one, in the unit shown: "\u00b1 0.19 syst."; else nothing."""
    if p.systematic is None or not outweighs(p.systematic, p.stderr):
        return ""
    return f"\u00b1 {shown_number(p.systematic, p.unit, 2)} syst."


def sentence_quantity(p: P) -> str:
    """For running text: "30.00 \u00b1 0.02 mm"."""
    value, stderr, unit = quantity(p)
    shown = " ".join(filter(None, (f"{value} \u00b1 {stderr}" if stderr else value, systematic(p))))
    return f"{shown} {unit}".strip()


def shown_value(value: float, unit: str, digits: int = 3) -> str:
    """A value in SI with its unit, in the unit shown: "12.3 mm"."""
    return f"{shown_number(value, unit, digits)} {shown_unit(unit)}".strip()


@dataclass(frozen=True, slots=True)
class Heading:
    """head : name. unit : shown. factor : how many of it one SI unit is. hint : what it means, in a sentence."""

    head: str
    unit: str = ""
    factor: float = 1.0
    hint: str = ""


_KNOWN = {
    "max_error_m": Heading("largest position error", "mm", 1e3, "largest |x - exact x| over the run"),
    "rest_error_m": Heading("error at rest", "mm", 1e3, "last position minus the exact rest position"),
    "stick_time_s": Heading("stops at", "s", 1.0, "time from which the slider does not move any more"),
    "creep_m_s": Heading("creep", "mm/s", 1e3, "mean speed while the exact slider rests"),
    "half_cycles": Heading("half-cycles", "", 1.0, "until it rests"),
    "reversal_lead_s": Heading("friction leads by", "ms", 1e3, "by how much friction reverses before the speed does"),
    "energy_error": Heading("energy error", "", 1.0, "largest error of the energy balance over the starting energy"),
    "lift_m": Heading("lift", "mm", 1e3, "largest height of the box above the floor"),
    "drift_m": Heading("drift", "mm", 1e3, "distance from the start at the end, elastic give included"),
    "period_s": Heading("period", "s", 1.0, "mean time from slip to slip"),
    "stick_fraction": Heading("share that sticks", "", 1.0, "share of whole periods with friction below its limit"),
    "near_belt_fraction": Heading("share that rides", "", 1.0, "share of whole periods within 1 % of the belt's speed"),
    "stick_deviation_m_s": Heading("slip while it sticks", "mm/s", 1e3, "median |v - belt speed| over what sticks"),
    "amplitude_m": Heading("amplitude", "mm", 1e3, "half of the distance between the turning points"),
    "stop_fraction": Heading("share that stops", "", 1.0, "share of the last periods with friction below its limit"),
    "normal_error": Heading("normal force error", "", 1.0, "largest |N/(m g) - 1|; 1: it leaves what bears it"),
    "mu_v_over_g_s": Heading("mu v / g", "ms", 1e3, "friction coefficient x largest speed / g"),
}
_UNITS = {"_m_s2": ("m/s²", 1.0), "_m_s": ("mm/s", 1e3), "_m": ("mm", 1e3), "_s": ("s", 1.0)}
DECAY = tuple(_KNOWN)[:7]
"""Metrics of a free decay, shown even where there is no such figure."""


def heading(metric: str) -> Heading:
    """What a metric is called; one that is not known here is called by its name, in the unit at its end."""
    if metric in _KNOWN:
        return _KNOWN[metric]
    for ending, (unit, factor) in _UNITS.items():
        if metric.endswith(ending):
            return Heading(metric.removesuffix(ending).replace("_", " "), unit, factor)
    return Heading(metric.replace("_", " "))


AT_REST = 1e-6
"""Creep below this speed in m/s is rest."""


def mm(metres: float, angular: bool = False) -> str:
    """A length (m) in mm; an angle (rad) in mrad."""
    unit = "mrad" if angular else "mm"
    return f"{metres * 1e3:.3g} {unit}" if abs(metres) >= 1e-6 else f"less than 0.001 {unit}"


_ENGINES = {
    "mujoco": "MuJoCo",
    "pybullet": "PyBullet",
    "dart": "DART",
    "rapier": "Rapier",
    "drake": "Drake",
    "physx": "PhysX",
    "newton": "Newton",
    "mjx": "MJX",
    "warp": "MuJoCo Warp",
    "reference": "the reference",
}


def engine_name(name: str) -> str:
    """An engine as its makers write it; one that is not known here by its own name."""
    return _ENGINES.get(name, name)
