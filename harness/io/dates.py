"""Times written as dates and times of day, ISO 8601: what a logger or a spreadsheet puts in its first column."""

import re
from datetime import date

from harness.core.errors import InputError
from harness.io.columns import Mapping
from harness.io.table import Table

_DAY, _HOUR, _MINUTE = 86_400.0, 3600.0, 60.0
_STAMP = re.compile(
    r"(?:(?P<day>\d{4}-\d\d-\d\d)[T ])?(?P<h>\d\d?):(?P<m>\d\d):(?P<s>\d\d(?:[.,]\d{1,12})?)"
    r"(?P<zone>Z|[+-]\d\d:?\d\d)?"
)


class Clock:
    """Turns stamps into seconds from the first."""

    def __init__(self) -> None:
        self.first = ""
        self._day, self._seconds = 0, 0.0

    def seconds(self, text: str) -> float | None:
        """From the first stamp that was asked for; None for what is no date with a time of day, nor a time of day.

        Days and seconds are subtracted apart: seconds since 1970 have no more than seven digits behind the point.
        """
        found = _STAMP.fullmatch(text.strip())
        if found is None:
            return None
        try:
            day = date.fromisoformat(found["day"]).toordinal() if found["day"] else 0
        except ValueError:
            return None
        seconds = _HOUR * int(found["h"]) + _MINUTE * int(found["m"]) + float(found["s"].replace(",", "."))
        if found["zone"] not in (None, "Z"):
            zone = found["zone"].replace(":", "")
            ahead = _HOUR * int(zone[1:3]) + _MINUTE * int(zone[3:5])
            seconds += -ahead if zone[0] == "+" else ahead
        if not self.first:
            self.first, self._day, self._seconds = text.strip(), day, seconds
        return (day - self._day) * _DAY + (seconds - self._seconds)


def counted_from(table: Table, mappings: dict[str, Mapping]) -> str | None:
    """The first stamp, where times are dates; None where they are numbers. Raises InputError for dates elsewhere."""
    first = None
    for channel, mapping in mappings.items():
        dated = [table.dated[i] for i in map(table.position, mapping.names) if i in table.dated]
        if dated and (channel != "t" or len(mapping.names) > 1):
            where = f"{table.path}: channel {channel}"
            raise InputError(where, f"the time '{dated[0]}'", "numbers are accepted; times are for t alone")
        first = dated[0] if dated else first
    return first
