"""Checks of numbers and arrays that several of the core types share."""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError


def finite(where: str, value: float) -> float:
    """Return ``value`` as a float, or raise InputError when it is not a finite number."""
    try:
        number = float(value)
    except OverflowError:
        raise InputError(where, "a number of more than 308 digits", "a finite number") from None
    except (TypeError, ValueError):
        raise InputError(where, f"{value!r}", "a finite number") from None
    if not math.isfinite(number):
        raise InputError(where, f"{number}", "a finite number")
    return number


def positive(where: str, value: float, unit: str = "") -> float:
    """Return ``value``, or raise InputError when it is not finite and above zero."""
    number = finite(where, value)
    if number <= 0.0:
        raise InputError(where, f"{number:g}", f"a number above 0{' ' + unit if unit else ''}")
    return number


def not_negative(where: str, value: float, unit: str = "") -> float:
    """Return ``value``, or raise InputError when it is not finite and at least zero."""
    number = finite(where, value)
    if number < 0.0:
        raise InputError(where, f"{number:g}", f"0 or more{' ' + unit if unit else ''}")
    return number


def vector(where: str, values: object, length: int | None = None) -> FloatArray:
    """Return a read-only contiguous float64 vector of finite numbers.

    Raises InputError naming the first row that is not finite, or a wrong shape.
    """
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim != 1 or (length is not None and array.size != length):
        wanted = f"a vector of {length} numbers" if length is not None else "a vector"
        raise InputError(where, f"an array of shape {array.shape}", wanted)
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        raise InputError(f"{where}, row {bad[0] + 1}", f"{array[bad[0]]}", "a finite number")
    if array.flags.writeable:
        array = array.copy() if array is values else array
        array.flags.writeable = False
    return array


def increasing(where: str, times: FloatArray) -> None:
    """Raise InputError at the first time stamp that does not lie after the one before it."""
    bad = np.flatnonzero(np.diff(times) <= 0.0)
    if bad.size:
        row = int(bad[0]) + 1
        raise InputError(
            f"{where}, row {row + 1}",
            f"time {times[row]:.9g} s does not come after {times[row - 1]:.9g} s",
            "times that increase",
        )
