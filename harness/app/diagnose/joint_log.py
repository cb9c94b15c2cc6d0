"""The log of a robot's joints that a diagnosis is of."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.joint_log import JointLog
from harness.io.recording import ReadOptions


def read_log(path: Path, joints: Sequence[str], gain: float | None, reading: ReadOptions) -> JointLog:
    """Read a log; joints : those of the model, in its order. Raises InputError naming what is wrong, and where."""
    rows = np.genfromtxt(path, delimiter=",", names=True, deletechars="")
    found: dict[str, dict[str, FloatArray]] = {"position": {}, "velocity": {}, "effort": {}}
    for column in rows.dtype.names or ():
        name, dot, kind = column.rpartition(".")
        if dot and kind in found:
            found[kind][name] = (gain or 1.0) * rows[column] if kind == "effort" else rows[column]
    t = rows["t"]
    keep = np.ones(t.size, dtype=bool)
    if reading.start is not None:
        keep &= t >= reading.start
    if reading.stop is not None:
        keep &= t <= reading.stop
    kept = {kind: {name: y[keep] for name, y in by.items()} for kind, by in found.items()}
    return JointLog(t[keep], kept["position"], kept["velocity"], kept["effort"], str(path))
