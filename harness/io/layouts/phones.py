"""Sensor Logger's files: x, y, z of a sensor that the name of the file tells, behind stamps in ns and seconds."""

from collections.abc import Sequence

from harness.io.layout import Head, Layout

_UNITS = {"gyroscope": "rad/s", "orientation": "rad", "accelerometer": "m/s^2", "gravity": "m/s^2"}


def _find(lines: Sequence[str], name: str) -> Head | None:
    fields = lines[0].replace('"', "").split(",") if lines else []
    if fields[:2] != ["time", "seconds_elapsed"]:
        return None
    unit = next((unit for word, unit in _UNITS.items() if word in name.lower()), "")
    units = ["ns", "s", *(unit if field in ("x", "y", "z") else "" for field in fields[2:])]
    return Head(first=1, fields=tuple(fields), units=tuple(units), separator=",", own=False)


LAYOUT = Layout(name="Sensor Logger", find=_find)
