"""The --columns by which a recording was read, and what to paste where a column is in another unit, has the other sign
or another's name.
"""

import re
import shlex
from collections.abc import Mapping, Sequence

from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.alignment.consistency import Consistency

_UNIT = re.compile(r"\[[^][]*\]$")
"""That a column is read in, behind it."""


def in_unit(columns: Mapping[str, str], channel: str, unit: str) -> dict[str, str]:
    """Columns by channel, as a recording has them, of which one is read in another unit."""
    return {c: f"{_UNIT.sub('', of)}[{unit}]" if c == channel else of for c, of in columns.items()}


def mapping(columns: Mapping[str, str]) -> str:
    """As --columns takes them."""
    return ",".join(f"{c}={of}" for c, of in columns.items())


def refuse_misread(recording: Recording, channels: Sequence[Consistency], option: str = "--columns") -> None:
    """Raise InputError for channels that are not of one motion as they were read, with the option that mends it."""
    for one in channels:
        if not one.related or one.likelier or one.exchanged:
            columns = _meant(recording, one)
            accepted = f"try: {option} {shlex.quote(mapping(columns))}" if columns else "channels of one motion"
            raise InputError(f"{recording.file}: channels {' and '.join(one.pair)}", one.sentence, accepted)


def _meant(recording: Recording, one: Consistency) -> dict[str, str] | None:
    """Columns of which two channels are of one motion: the other sign, another unit, or each other's names.

    Of a recording whose columns nobody told those alone that are read otherwise.
    """
    columns = dict(recording.columns)
    (first, a), (second, b) = ((c, columns.get(c, c)) for c in one.pair)
    if one.likelier and (not columns or one.likelier[0] in columns):
        return in_unit(columns or {c: c for c in one.likelier[:1]}, *one.likelier)
    if one.exchanged:
        return columns | {first: b, second: a}
    return columns | {second: f"-1*{b}"} if one.mirrored else None
