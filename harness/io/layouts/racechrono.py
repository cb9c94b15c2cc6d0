"""RaceChrono's CSV: what is known of the session, then lines of names, of units and of the sources, and the rows."""

from collections.abc import Sequence

from harness.io.layout import Head, Layout

_DEEP = 40
"""Lines of a header at most."""


def _find(lines: Sequence[str], name: str) -> Head | None:
    if not lines or "created using RaceChrono" not in lines[0]:
        return None
    at = next((i for i, line in enumerate(lines[:_DEEP]) if line.startswith("timestamp,")), None)
    if at is None or at + 2 >= len(lines):
        return None
    fields, units = (line.split(",") for line in lines[at : at + 2])
    known = ["" if unit in ("unix time", "sats") else unit.strip() for unit in units]
    return Head(first=at + 3, fields=tuple(fields), units=tuple(known), separator=",")


LAYOUT = Layout(name="RaceChrono", find=_find)
