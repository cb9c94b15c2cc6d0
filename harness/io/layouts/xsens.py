"""Xsens' text export: remarks that tell the rate, then counters, accelerations in m/s^2 and speeds in rad/s."""

from collections.abc import Sequence

from harness.io.layout import Head, Layout, rate_of

_RATE = "update rate:"
_UNITS = {"acc": "m/s^2", "freeacc": "m/s^2", "gyr": "rad/s", "roll": "deg", "pitch": "deg", "yaw": "deg"}
_COUNTERS = ("PacketCounter", "SampleTimeFine")


def _find(lines: Sequence[str], name: str) -> Head | None:
    at = next((i for i, line in enumerate(lines) if line.startswith(_COUNTERS[0])), None)
    if at is None or not all(line.startswith("//") for line in lines[:at] if line.strip()):
        return None
    separator = "\t" if "\t" in lines[at] else ","
    fields = [field.strip() for field in lines[at].rstrip("\r\t,").split(separator)]
    told = next((line.lower().partition(_RATE)[2] for line in lines[:at] if _RATE in line.lower()), "")
    units = [_UNITS.get(field.partition("_")[0].lower(), "") for field in fields]
    names = ["sample" if field in _COUNTERS else field for field in fields]
    return Head(first=at + 1, fields=tuple(names), units=tuple(units), separator=separator, rate=rate_of(told))


LAYOUT = Layout(name="Xsens", find=_find)
