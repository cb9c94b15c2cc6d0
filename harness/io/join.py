"""Signals that lie in files of their own, one motion: put together on the clock of the first (--join)."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import PurePath

import numpy as np

from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.io.times import Clock


def joined(first: Recording, others: Sequence[Recording]) -> Recording:
    """A recording with the channels of others, on the lines between their samples, while all of them last.

    Times count from 1970 in all files, are times of day in all, or begin together. Raises InputError where two files
    hold one channel, where one turns and another slides, and where they have no time in common.
    """
    for other in others:
        t = other.t + _later(first, other)
        both = (first.t >= t[0]) & (first.t <= t[-1])
        again = next((channel for channel in other.channels if channel in first), None)
        if again is not None:
            accepted = f"another channel by its header, as in '{again}' for one of them, or its file's name"
            raise InputError("--join", f"{first.file} and {other.file} both hold {again}", accepted)
        if not np.any(both) or first.angular != other.angular:
            found = "no time in common" if not np.any(both) else "lengths and angles"
            raise InputError("--join", f"{found} in {first.file} and {other.file}", "files of one motion")
        beside = {name: np.interp(first.t[both], t, values) for name, values in other.channels.items()}
        first = first.cut(both)
        said = f"{', '.join(beside)} from {PurePath(other.file).name}, at the times of {PurePath(first.file).name}."
        first = replace(
            first,
            channels={**first.channels, **beside},
            units={**first.units, **other.units},
            columns={**other.columns, **first.columns},
            notes=(*first.notes, *(f"{PurePath(other.file).name}: {note}" for note in other.notes), said),
            mended=(*first.mended, *other.mended),
        )
    return first


def _later(first: Recording, other: Recording) -> float:
    """By how much the clock of another recording begins after the first's, s."""
    days = [str(one.extra.get("dated", "")) for one in (first, other)]
    if all(days):
        clock = Clock()
        clock.seconds(days[0])
        return clock.seconds(days[1]) or 0.0
    return float(other.extra.get("since", 0.0)) - float(first.extra.get("since", 0.0))
