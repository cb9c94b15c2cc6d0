"""Logs of ODrive, of several axes beside each other, and of moteus: turns, turns a second, currents in A."""

import re
from collections.abc import Sequence

from harness.io.layout import Head, Layout
from harness.io.units import split_header

_OURS = re.compile(r"odrive|axis\d\.|encoder\.(?:pos|vel)_estimate|\b(?:pos|vel)_estimate\b", re.IGNORECASE)
_UNITS = (("pos", "turn"), ("vel", "turn/s"), ("current", "A"), ("iq", "A"), ("torque", "N*m"))


def _find(lines: Sequence[str], name: str) -> Head | None:
    fields = [cell.strip().strip('"') for cell in lines[0].split(",")] if lines else []
    moteus = {"position", "velocity", "q_current"} <= set(fields)
    if len(fields) < 2 or not (moteus or all(_OURS.search(field) for field in fields[1:])):
        return None
    last = [field.lower().rpartition(".")[2] for field in fields[1:]]
    units = [next((unit for word, unit in _UNITS if word in field), "") for field in last]
    clock = "" if split_header(fields[0])[1] else "s"
    return Head(first=1, fields=tuple(fields), units=(clock, *units), separator=",")


LAYOUT = Layout(name="ODrive", find=_find)
