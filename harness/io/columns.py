"""The ``--columns`` option: which column, times which constants, in which unit, gives which channel."""

import math
import re
from collections.abc import Container
from dataclasses import dataclass

from harness.core.errors import InputError

CHANNELS = ("t", "x", "v", "a", "u")
ACCEPTED = (
    "CHANNEL=PRODUCT[UNIT] with channel t, x, v, a or u and a product of column names, #N and numbers is accepted, "
    "e.g. \"t=t,x=qm[m],u=vir*35.15[N]\"; a name with other signs in it stands in quotes, t='Time (s)'"
)

_NUMBER = re.compile(r"^[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?$")
_POSITION = re.compile(r"^#[1-9]\d{0,5}$")
_QUOTED = re.compile(r"'([^']*)'|\"([^\"]*)\"")
_HELD = re.compile(r"^\x00(\d+)\x00$")
_NAME = re.compile(r"^[^\W\d][\w.]*(?: [\w.]+)*$")


@dataclass(frozen=True, slots=True)
class Mapping:
    """One channel as a product: ``factor`` times the columns ``names``, in ``unit`` (None: what the header says)."""

    channel: str
    names: tuple[str, ...]
    factor: float = 1.0
    unit: str | None = None


_LONGEST = 2000
"""Characters of ``--columns``."""


def _split(text: str) -> list[str]:
    """Split at the commas outside brackets."""
    parts, inside = [""], False
    for character in text:
        inside = character == "[" or (inside and character != "]")
        if character == "," and not inside:
            parts.append("")
        else:
            parts[-1] += character
    return parts


def _parts(entry: str) -> tuple[str, str, str | None] | None:
    """Channel, product and unit of an entry; None when it is none."""
    channel, equals, rest = entry.partition("=")
    product, bracket, unit = rest.partition("[")
    if not equals or set("[]") & set(channel + product) or (bracket and not unit.endswith("]")):
        return None
    if set("[]") & set(unit[:-1]):
        return None
    return channel.strip(), product.strip(), unit[:-1] if bracket else None


def _put_aside(text: str) -> tuple[str, list[str]]:
    """The text with a mark for each quoted name, and the names."""
    names: list[str] = []

    def mark(found: re.Match[str]) -> str:
        names.append((found[1] if found[1] is not None else found[2]).strip())
        return f"\x00{len(names) - 1}\x00"

    return _QUOTED.sub(mark, text.replace("\x00", "")), names


def _product(entry: str, text: str, quoted: list[str]) -> tuple[tuple[str, ...], float]:
    names: list[str] = []
    factor = 1.0
    for part in text.split("*"):
        item = part.strip()
        held = _HELD.match(item)
        if held and quoted[int(held[1])]:
            names.append(quoted[int(held[1])])
        elif _NUMBER.match(item):
            factor *= float(item)
        elif _POSITION.match(item) or _NAME.match(item):
            names.append(item)
        else:
            found = f"'{item or text}' in '{entry}' is no name, #N or number".replace("\x00", "'")
            raise InputError("--columns", found, ACCEPTED)
    if not names:
        raise InputError("--columns", f"'{entry}' names no column", ACCEPTED)
    if not math.isfinite(factor) or factor == 0.0:
        raise InputError("--columns", f"'{entry}' multiplies by {factor:g}", "a finite factor other than 0 is accepted")
    return tuple(names), factor


def parse_columns(text: str, channels: Container[str] = CHANNELS, accepted: str = ACCEPTED) -> dict[str, Mapping]:
    """Parse ``--columns``; nothing is evaluated.

    channels : those there are. accepted : what a message says of them. Raises InputError for anything but a list of
    CHANNEL=PRODUCT[UNIT].
    """
    if len(text) > _LONGEST:
        raise InputError("--columns", f"{len(text)} characters", f"at most {_LONGEST} are accepted")
    found: dict[str, Mapping] = {}
    aside, quoted = _put_aside(text)
    for entry in (part.strip() for part in _split(aside)):
        split = _parts(entry)
        if split is None:
            raise InputError("--columns", f"'{entry}'", accepted)
        channel, product, unit = split
        if channel not in channels:
            raise InputError("--columns", f"unknown channel '{channel}' in '{entry}'", accepted)
        if channel in found:
            raise InputError("--columns", f"channel {channel} given twice", "each channel once is accepted")
        names, factor = _product(entry, product, quoted)
        found[channel] = Mapping(channel, names, factor, None if unit is None else unit.strip())
    return found
