"""What a model predicts of blocks of time that were left out of its fit."""

from collections.abc import Iterator

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.robot.whole_arm.design import Design

BLOCK = 1.0
"""s: longer than the memory of the noise, shorter than a period of the motion."""
FOLDS = 5
"""Every fifth block is left out at a time."""


def folds(t: FloatArray) -> IntArray:
    """Which fold each time (m,) is in: every fifth block of a second."""
    return np.asarray(((t - t[0]) // BLOCK).astype(np.int64) % FOLDS)


def errors(design: Design, t: FloatArray) -> FloatArray:
    """Errors (rows,) of held-out whitened samples, fold by fold; t (m,) : times of all samples."""
    found = np.empty(design.rows)
    for out, numbers in _without(design, t):
        found[out] = design.y[out] - design.matrix[out] @ numbers
    return found


def rms(design: Design, t: FloatArray) -> FloatArray:
    """Root mean square (k,) of the held-out error of each joint's torque, guarded, N m or N."""
    squares = np.zeros(len(design.parts))
    fold = folds(t)
    for one, (_, numbers) in enumerate(_without(design, t)):
        for j, part in enumerate(design.parts):
            rows = part.stretches.kept & (fold == one)
            left = part.torque[rows] - part.base[rows] @ numbers[design.places[j]]
            for named, place in zip(design.named, design.places[len(design.parts) :], strict=True):
                columns = named.candidate.settings[named.setting].columns
                if j in columns:
                    left = left - columns[j][rows] @ numbers[place]
            squares[j] += float(left @ left)
    return np.sqrt(squares / [np.sum(part.stretches.kept) for part in design.parts])


def _without(design: Design, t: FloatArray) -> Iterator[tuple[IntArray, FloatArray]]:
    """By fold: its whitened rows, and the numbers fitted to all others."""
    fold = np.concatenate([folds(t)[part.stretches.kept] for part in design.parts])
    matrix, y = design.matrix, design.y
    scale = np.sqrt(np.sum(matrix**2, axis=0))
    scale[scale == 0.0] = 1.0
    scaled = matrix / scale
    normal, pull = scaled.T @ scaled, scaled.T @ y
    for one in range(FOLDS):
        out = np.flatnonzero(fold == one)
        part = scaled[out]
        numbers = np.linalg.pinv(normal - part.T @ part, rcond=1e-12, hermitian=True) @ (pull - part.T @ y[out])
        yield out, numbers / scale
