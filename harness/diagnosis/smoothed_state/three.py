"""Products of matrices of three rows and columns, written out: a library's are compiled ten times as long as these."""

from harness.core.arrays import FloatArray
from harness.core.jit import compiled


def _times(a: FloatArray, b: FloatArray, out: FloatArray) -> None:
    """out = a b, each (3, 3); out is neither."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


def _times_turned(a: FloatArray, b: FloatArray, out: FloatArray) -> None:
    """out = a b^T, each (3, 3); out is neither."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[j, 0] + a[i, 1] * b[j, 1] + a[i, 2] * b[j, 2]


def _at(a: FloatArray, v: FloatArray, out: FloatArray) -> None:
    """out (3,) = a (3, 3) v (3,); out is not v."""
    for i in range(3):
        out[i] = a[i, 0] * v[0] + a[i, 1] * v[1] + a[i, 2] * v[2]


def _over(a: FloatArray, b: FloatArray, out: FloatArray) -> None:
    """out = a b^-1, each (3, 3); b symmetric and positive, by its factors L D L^T, which no scale of its rows harms."""
    l10, l20 = b[1, 0] / b[0, 0], b[2, 0] / b[0, 0]
    d1 = b[1, 1] - l10 * b[1, 0]
    l21 = (b[2, 1] - l20 * b[1, 0]) / d1
    d2 = b[2, 2] - l20 * b[2, 0] - l21 * l21 * d1
    for i in range(3):
        y1 = a[i, 1] - l10 * a[i, 0]
        y2 = a[i, 2] - l20 * a[i, 0] - l21 * y1
        out[i, 2] = y2 / d2
        out[i, 1] = y1 / d1 - l21 * out[i, 2]
        out[i, 0] = a[i, 0] / b[0, 0] - l10 * out[i, 1] - l20 * out[i, 2]


times, times_turned, at, over = compiled(_times), compiled(_times_turned), compiled(_at), compiled(_over)
