"""Angles that wrap: an encoder that begins anew after a turn."""

import numpy as np

from harness.core.arrays import FloatArray


def unwrapped(x: FloatArray) -> tuple[FloatArray, str | None]:
    """An angle of shape (n,) in rad with its turns put together, and the sentence that says so; itself where none.

    A step counts as a wrap when it is nearer to a whole turn than a quarter turn; where any step lies between, the
    samples do not tell, and nothing is changed.
    """
    steps = np.diff(x)
    wraps = np.abs(steps) > np.pi
    if not np.any(wraps):
        return x, None
    whole = np.unwrap(x)
    whole = whole - 2.0 * np.pi * np.round(np.median(whole) / (2.0 * np.pi))  # the turn in which it swings is no turn
    if float(np.abs(np.diff(whole)).max()) > 0.5 * np.pi:
        return x, "The angle jumps by more than half a turn between samples, and not by whole turns: left as it is."
    count = int(np.count_nonzero(wraps))
    return whole, f"The angle wraps {count} time{'s' if count > 1 else ''}: put together to one course."
