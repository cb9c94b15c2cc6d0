"""Ranges and ticks of axes that the viewer does not draw itself."""

from collections.abc import Sequence

import numpy as np

from harness.core.arrays import FloatArray
from harness.show.scene import Grid


def padded(values: Sequence[FloatArray], share: float) -> tuple[float, float]:
    """Smallest and largest finite value of all arrays, widened by ``share`` of their distance on either side."""
    ends = [end for array in values if (end := _ends(array)) is not None]
    low = min((end[0] for end in ends), default=0.0)
    high = max((end[1] for end in ends), default=0.0)
    margin = share * (high - low) if high > low else max(1e-12, 0.1 * abs(high))
    return low - margin, high + margin


def _ends(values: FloatArray) -> tuple[float, float] | None:
    low, high = float(values.min()), float(values.max())
    if np.isfinite(low) and np.isfinite(high):
        return low, high
    finite = values[np.isfinite(values)]
    return (float(finite.min()), float(finite.max())) if finite.size else None


def roomy(values: Sequence[FloatArray]) -> tuple[float, float]:
    """Like ``padded``, out to the next whole power of ten where that is near: there the viewer writes a number."""
    low, high = padded(values, 0.0)
    step = 10.0 ** np.floor(np.log10(high - low))
    further_low, further_high = step * np.floor(low / step), step * np.ceil(high / step)
    near = 0.3 * (high - low)
    low = float(further_low) if low - further_low < near else low
    high = float(further_high) if further_high - high < near else high
    return padded([np.array([low, high])], 0.06)


def ticks(low: float, high: float, about: int = 5) -> FloatArray:
    """Round numbers (1, 2 or 5 times a power of ten apart) within [low, high]."""
    rough = (high - low) / about
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * next(nice for nice in (1.0, 2.0, 5.0, 10.0) if rough <= nice * power)
    return np.asarray(np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step)


def plane_grid(
    path: str, x: tuple[float, float], y: tuple[float, float], x_axis: tuple[str, float], y_axis: tuple[str, float]
) -> Grid:
    """Axes through the origin with ticks. x_axis, y_axis : label, and label units for one unit drawn."""
    zero_x, zero_y = min(max(0.0, x[0]), x[1]), min(max(0.0, y[0]), y[1])
    strips = [np.array([[x[0], zero_y], [x[1], zero_y]]), np.array([[zero_x, y[0]], [zero_x, y[1]]])]
    labels, places = [], []
    size_x, size_y = 0.008 * (x[1] - x[0]), 0.012 * (y[1] - y[0])
    for value in ticks(x[0] * x_axis[1], x[1] * x_axis[1]) / x_axis[1]:
        strips.append(np.array([[value, zero_y - size_y], [value, zero_y + size_y]]))
        if value != 0.0:
            labels.append(f"{value * x_axis[1]:g}")
            places.append([value, zero_y - 3.0 * size_y])
    for value in ticks(y[0] * y_axis[1], y[1] * y_axis[1]) / y_axis[1]:
        strips.append(np.array([[zero_x - size_x, value], [zero_x + size_x, value]]))
        if value != 0.0:
            labels.append(f"{value * y_axis[1]:g}")
            places.append([zero_x + 5.0 * size_x, value])
    labels += [x_axis[0], y_axis[0]]
    places += [[x[1] - 8.0 * size_x, zero_y + 4.0 * size_y], [zero_x + 8.0 * size_x, y[1] - 2.0 * size_y]]
    return Grid(path, strips, labels, np.array(places))
