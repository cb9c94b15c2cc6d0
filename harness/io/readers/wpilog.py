"""Logs of WPILib (.wpilog): records of an entry, a time in us and a value; entries are begun by records of their own.

The format is WPILib's "Data Log File Format Specification", version 1.0: little endian, a header WPILOG, then records
whose first byte says how many bytes entry, size and time take.
"""

import struct
from pathlib import Path

import numpy as np

from harness.core.bounded import read_bytes
from harness.core.errors import InputError
from harness.io.reader import Reader
from harness.io.table import ArrayTable, on_one_clock

_MARK, _START = b"WPILOG", 0
_KINDS = {"double": "<d", "float": "<f", "int64": "<q"}
_ARRAYS = {"double[]": "<f8", "float[]": "<f4", "int64[]": "<i8"}


def open_wpilog(path: Path) -> ArrayTable:
    """The entries of numbers, on the clock of the one that has most. Raises InputError for a file that is none."""
    data = read_bytes(path)
    if data[:6] != _MARK or len(data) < 12:
        raise InputError(str(path), "not a log of WPILib", "a whole .wpilog file")
    at = 12 + int.from_bytes(data[8:12], "little")
    entries: dict[int, tuple[str, str]] = {}
    signals: dict[str, tuple[list[float], list[float]]] = {}
    while at < len(data):
        first = data[at]
        one, two, three = (first & 3) + 1, ((first >> 2) & 3) + 1, ((first >> 4) & 7) + 1
        body = at + 1 + one + two + three
        entry = int.from_bytes(data[at + 1 : at + 1 + one], "little")
        size = int.from_bytes(data[at + 1 + one : at + 1 + one + two], "little")
        if body + size > len(data):  # the robot was switched off
            break
        payload, us = data[body : body + size], int.from_bytes(data[body - three : body], "little")
        at = body + size
        if entry == 0 and payload[:1] == bytes([_START]):
            began = _began(payload)
            entries |= {} if began is None else {began[0]: began[1:]}
        elif entry in entries:
            name, kind = entries[entry]
            for part, value in _values(kind, payload):
                t, y = signals.setdefault(name + part, ([], []))
                t.append(us * 1e-6)
                y.append(value)
    return on_one_clock(path, {name: (np.array(t), np.array(y)) for name, (t, y) in signals.items()})


def _began(payload: bytes) -> tuple[int, str, str] | None:
    """Number, name and type of an entry that begins; None for a record that is cut short."""
    texts, at = [], 5
    for _ in range(2):
        size = int.from_bytes(payload[at : at + 4], "little")
        texts.append(payload[at + 4 : at + 4 + size].decode("utf-8", "replace"))
        at += 4 + size
    return (int.from_bytes(payload[1:5], "little"), texts[0], texts[1]) if at <= len(payload) else None


def _values(kind: str, payload: bytes) -> list[tuple[str, float]]:
    """What a record holds, by the part of the entry; nothing for what is no number."""
    if kind in _KINDS and len(payload) == struct.calcsize(_KINDS[kind]):
        return [("", float(struct.unpack(_KINDS[kind], payload)[0]))]
    if kind in _ARRAYS and len(payload) % 8 == 0:
        return [(f"[{k}]", float(value)) for k, value in enumerate(np.frombuffer(payload, _ARRAYS[kind]))]
    return []


WPILOG = Reader(name="WPILib", suffixes=(".wpilog",), open=open_wpilog)
