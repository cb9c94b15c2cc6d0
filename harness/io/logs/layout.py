"""Where the numbers stand in the bytes of a joint state, so that those of the same layout are not unpacked anew.

The formats are CDR (OMG, XCDR version 1, as ROS 2 writes it) and the serialisation of ROS 1, which aligns nothing.
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray

_HEAD, _STAMP = 4, 8
"""Bytes before the stamp (of the encapsulation, or the sequence number), and of the stamp."""


@dataclass(frozen=True, slots=True)
class Layout:
    """One layout. kept : places of bytes that are those of ``like``. numbers : place and count of each array."""

    like: bytes
    kept: tuple[slice, ...]
    numbers: tuple[tuple[int, int], ...]

    def read(self, data: bytes) -> tuple[tuple[int, int], list[FloatArray]] | None:
        """Seconds and nanoseconds of the stamp, and the arrays; None for bytes of another layout."""
        if len(data) != len(self.like) or any(data[part] != self.like[part] for part in self.kept):
            return None
        return struct.unpack_from("<iI", data, _HEAD), [np.frombuffer(data, "<f8", n, at) for at, n in self.numbers]


def layout_of(data: bytes, frame: str, names: Sequence[str], values: Sequence[FloatArray], old: bool) -> Layout | None:
    """The layout of a message that was unpacked to this; None where its bytes are not as expected.

    frame : frame_id of its header. values : position, velocity, effort. old : of ROS 1.
    """
    end = _HEAD + _STAMP

    def after(size: int, alignment: int) -> int:
        at = end if old else _HEAD + -(-(end - _HEAD) // alignment) * alignment
        return at + size

    for text in (frame, None, *names):  # None: how many names there are
        end = after(4, 4) + (0 if text is None else len(text.encode()) + (0 if old else 1))
    numbers, kept = [], [slice(_HEAD + _STAMP, end)]
    for array in values:
        begin, end = end, after(4, 4)
        start = after(0, 8) if array.size else end
        kept.append(slice(begin, start))
        numbers.append((start, array.size))
        end = start + 8 * array.size
    found = Layout(data, (*kept, *([] if old else [slice(0, _HEAD)])), tuple(numbers))
    if end != len(data) or not (old or data[:2] == b"\x00\x01"):
        return None
    read = found.read(data)
    alike = read is not None and all(a.tobytes() == b.tobytes() for a, b in zip(read[1], values, strict=True))
    return found if alike else None
