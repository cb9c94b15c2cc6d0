"""Positions in shares of a calibrated range, as LeRobot's motors write them, to angles by their calibration file.

lerobot/motors/motors_bus.py: -100 to 100 of the range that was passed at calibration, 0 to 100 for grippers, of a turn
of 4096 steps. Signs are the log's.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from harness.core.bounded import MOST_DOCUMENT_BYTES, parse_json, read_bytes
from harness.core.errors import InputError
from harness.io.logs.raw import SI_UNITS, Field, Raw

_TURN = 4096.0
"""Steps of a turn of every such motor."""
_FIELDS: tuple[Field, ...] = ("position", "goal", "velocity")
_GRIPPER = "gripper"
_ACCEPTED = 'a calibration as LeRobot keeps it, {"elbow_flex": {"range_min": 805, "range_max": 3100, ..}, ..}'


def calibrated(raw: Raw, path: Path | None) -> Raw:
    """Angles in rad from the middle of each joint's calibrated range. Raises InputError for a file that is none, and
    for a log whose joints it has not."""
    if path is None:
        return raw
    ranges = _ranges(path)
    have = list(raw.fields.get("position", {}))
    if missing := [joint for joint in have if joint not in ranges]:
        raise InputError(str(path), f"no {', '.join(missing)}, but {', '.join(ranges)}", "the log's own")
    fields = dict(raw.fields)
    for kind in _FIELDS:
        of = fields.get(kind, {})
        shift = {joint: 50.0 if joint == _GRIPPER and kind != "velocity" else 0.0 for joint in of}
        scale = {joint: ranges[joint] / (100.0 if joint == _GRIPPER else 200.0) for joint in of}
        fields[kind] = {joint: (y - shift[joint]) * scale[joint] for joint, y in of.items()}
    said = (
        f"Positions are read as shares of the ranges in {path.name} (--calibration), -100 to 100 (a gripper's 0 to"
        " 100), and are angles from the middle of these."
    )
    told = dict(raw.told)
    told |= {kind: SI_UNITS[kind] for kind in _FIELDS if fields.get(kind)}
    return replace(raw, fields={k: of for k, of in fields.items() if of}, told=told, notes=(*raw.notes, said))


def _ranges(path: Path) -> Mapping[str, float]:
    """Angle of the whole range by joint, rad."""
    try:
        told: Any = parse_json(read_bytes(path, MOST_DOCUMENT_BYTES))
        turns = {str(name): (float(one["range_max"]) - float(one["range_min"])) / _TURN for name, one in told.items()}
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(str(path), f"unreadable ({type(error).__name__}: {error})", _ACCEPTED) from None
    if bad := [name for name, size in turns.items() if not 0.0 < size <= 1.0]:
        raise InputError(str(path), f"the range of {bad[0]} is not within one turn", _ACCEPTED)
    return {name: 2.0 * math.pi * size for name, size in turns.items()}
