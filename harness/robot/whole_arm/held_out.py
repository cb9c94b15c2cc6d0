"""What a model predicts of blocks of time that were left out of its fit."""

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.robot.whole_arm.design import Design

BLOCK = 1.0
"""s: longer than the memory of the noise, shorter than a period of the motion."""
FOLDS = 5


def folds(t: FloatArray) -> IntArray:
    """Which fold each time (m,) is in: every fifth block of a second."""
    return np.asarray(((t - t[0]) // BLOCK).astype(np.int64) % FOLDS)


def errors(design: Design, t: FloatArray) -> FloatArray:
    """Errors (rows,) of held-out whitened samples, fold by fold; t (m,) : times of all samples."""
    fold = np.concatenate([folds(t)[part.stretches.kept] for part in design.parts])
    matrix, y = design.matrix, design.y
    scale = np.sqrt(np.sum(matrix**2, axis=0))
    scale[scale == 0.0] = 1.0
    scaled = matrix / scale
    normal, pull = scaled.T @ scaled, scaled.T @ y
    found = np.empty(design.rows)
    for one in range(FOLDS):
        out = np.flatnonzero(fold == one)
        part = scaled[out]
        numbers = np.linalg.pinv(normal - part.T @ part, rcond=1e-12, hermitian=True) @ (pull - part.T @ y[out])
        found[out] = y[out] - part @ numbers
    return found
