"""A recording without samples that are no measurement, as long as enough are left."""

from collections.abc import Sequence

import numpy as np

from harness.core.arrays import BoolArray
from harness.core.errors import InputError
from harness.core.recording import MINIMUM_SAMPLES, Recording


def without(recording: Recording, lost: BoolArray, notes: Sequence[str], which: str) -> Recording:
    """The samples that are not ``lost`` (n,).

    notes : a sentence on each kind of them. which : those that are accepted, "within the sensor's range".
    Raises InputError where too few are left.
    """
    if not lost.any():
        return recording
    kept = int(np.count_nonzero(~lost))
    if kept < MINIMUM_SAMPLES:
        found = f"{notes[0]}, and {kept} stay"
        raise InputError(recording.file, found, f"at least {MINIMUM_SAMPLES} {which} are accepted")
    return recording.cut(~lost)
