"""What of a recording is believed to show the motion: neither the end of a sensor's range nor samples that stray."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.estimate.noise import channel_noise
from harness.estimate.saturation import limit_said, limits, within_range
from harness.estimate.stray import without_stray


def believed(recording: Recording, channels: Sequence[str]) -> tuple[Recording, tuple[str, ...]]:
    """A recording without samples of these channels that are no measurement, and a sentence on each kind of them.

    Raises InputError where too few samples are left.
    """
    # a short stop at the end of a range would count as straying
    recording, beyond = within_range(recording, channels)
    recording, stray = without_stray(recording, channels)
    return recording, (*beyond, *stray)


def without_limited(recording: Recording) -> tuple[Recording, tuple[str, ...]]:
    """A recording without an acceleration whose sensor stood at its limit, and a sentence on it.

    Friction makes an acceleration jump at its extremes, which then lie beyond the limit: what is left of it says little
    of friction, and says it wrongly. Raises InputError where nothing else was recorded.
    """
    ends = limits(recording.t, recording["a"], channel_noise(recording.t, recording["a"])) if "a" in recording else ()
    if not ends:
        return recording, ()
    at = np.isin(recording["a"], ends)
    stops, many = limit_said(ends, recording.angular), int(np.count_nonzero(at))
    others = {c: y for c, y in recording.channels.items() if c != "a"}
    if not any(c in others for c in ("x", "v")):
        found = f"{stops}: {many} samples, and its reversals lie beyond"
        # a diagnosis fits the limit beside the motion
        raise InputError(f"{recording.file}: channel a", found, f"try: harness diagnose {recording.file}")
    return replace(recording, channels=others), (f"{stops}: {many} samples, and it was not used",)
