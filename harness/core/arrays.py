"""Names for the array types that everything speaks in."""

from typing import TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]
BoolArray: TypeAlias = NDArray[np.bool_]
ModeArray: TypeAlias = NDArray[np.int8]
ComplexArray: TypeAlias = NDArray[np.complex128]

Real = TypeVar("Real", FloatArray, IntArray)


def read_only(values: Real) -> Real:
    """A contiguous view (or a copy) that no kernel can write to: one compiled form serves whatever callers have."""
    view = np.ascontiguousarray(values).view()
    view.flags.writeable = False
    return view
