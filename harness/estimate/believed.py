"""What of a recording is believed to show the motion: neither the end of a sensor's range nor samples that stray."""

from collections.abc import Sequence

from harness.core.recording import Recording
from harness.estimate.saturation import within_range
from harness.estimate.stray import without_stray


def believed(recording: Recording, channels: Sequence[str]) -> tuple[Recording, tuple[str, ...]]:
    """A recording without samples of these channels that are no measurement, and a sentence on each kind of them.

    Raises InputError where too few samples are left.
    """
    # a short stop at the end of a range would count as straying
    recording, beyond = within_range(recording, channels)
    recording, stray = without_stray(recording, channels)
    return recording, (*beyond, *stray)
