"""Numbers for people: as many digits as the uncertainty carries, units of a size to read."""

import math
from collections.abc import Mapping
from typing import Any

MINUS = "\u2212"
NONE = "\u2013"

MOST_DIGITS = 9
"""Significant digits of a value at most, however small its standard error."""

SHOWN: dict[str, tuple[str, float]] = {"m": ("mm", 1e3), "m/s": ("mm/s", 1e3)}
"""SI unit -> the unit shown, and how many of it one SI unit is."""


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
    power = math.floor(math.log10(abs(value)))
    if -4 <= power < 7:
        return plain(f"{value:.{max(0, digits - 1 - power)}f}")
    return plain(f"{value:.{digits - 1}e}")


def with_error(value: float, stderr: float | None) -> tuple[str, str]:
    """The value to the second digit of its standard error, and that error; ("2.300", "0.012")."""
    if stderr is None:
        return number(value, 5), ""
    if stderr == 0.0:
        return number(value, 6), "0"
    finest = math.floor(math.log10(abs(value))) - MOST_DIGITS + 2 if value else -12
    decimals = 1 - max(math.floor(math.log10(stderr)), finest)
    if decimals > 12 or decimals < 0:
        return number(value, 6), number(stderr, 2)
    shown = f"{stderr:.{decimals}f}"
    return plain(f"{value:.{decimals}f}"), plain(shown) if float(shown) else number(stderr, 2)


def quantity(p: Mapping[str, Any]) -> tuple[str, str, str]:
    """Value, standard error and unit of a P, in the unit shown; value "\u2013" when it was refused."""
    unit, factor = SHOWN.get(p["unit"], ("" if p["unit"] == "1" else p["unit"], 1.0))
    if p["value"] is None:
        return NONE, "", unit
    value, stderr = with_error(p["value"] * factor, None if p["stderr"] is None else p["stderr"] * factor)
    return value, stderr, unit


def sentence_quantity(p: Mapping[str, Any]) -> str:
    """For running text: "30.00 \u00b1 0.02 mm"."""
    value, stderr, unit = quantity(p)
    shown = f"{value} \u00b1 {stderr}" if stderr else value
    return f"{shown} {unit}".strip()


def shown_value(value: float, unit: str, digits: int = 3) -> str:
    """A value in SI with its unit, in the unit shown: "12.3 mm"."""
    name, factor = SHOWN.get(unit, ("" if unit == "1" else unit, 1.0))
    return f"{number(value * factor, digits)} {name}".strip()
