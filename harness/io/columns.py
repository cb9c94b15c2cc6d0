"""The ``--columns`` option: which column, times which constants, in which unit, gives which channel."""

import math
import re
from dataclasses import dataclass

from harness.core.errors import InputError

CHANNELS = ("t", "x", "v", "a", "u")
ACCEPTED = (
    "CHANNEL=PRODUCT[UNIT] with channel t, x, v, a or u and a product of column names, #N and numbers is accepted, "
    'e.g. "t=t,x=qm[m],u=vir*35.15[N]"'
)

_ENTRY = re.compile(r"^\s*(?P<channel>[^=\[\]]*?)\s*=\s*(?P<product>[^\[\]]*?)\s*(?:\[(?P<unit>[^\[\]]*)\])?\s*$")
_NUMBER = re.compile(r"^[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?$")
_POSITION = re.compile(r"^#[1-9]\d{0,5}$")
_NAME = re.compile(r"^[^\W\d][\w.]*(?: [\w.]+)*$")


@dataclass(frozen=True, slots=True)
class Mapping:
    """One channel as a product: ``factor`` times the columns ``names``, in ``unit`` (None: what the header says)."""

    channel: str
    names: tuple[str, ...]
    factor: float = 1.0
    unit: str | None = None


def _split(text: str) -> list[str]:
    """Split at the commas outside brackets."""
    return re.split(r",(?![^\[]*\])", text)


def _product(entry: str, text: str) -> tuple[tuple[str, ...], float]:
    names: list[str] = []
    factor = 1.0
    for part in text.split("*"):
        item = part.strip()
        if _NUMBER.match(item):
            factor *= float(item)
        elif _POSITION.match(item) or _NAME.match(item):
            names.append(item)
        else:
            raise InputError("--columns", f"'{item or text}' in '{entry}' is no name, #N or number", ACCEPTED)
    if not names:
        raise InputError("--columns", f"'{entry}' names no column", ACCEPTED)
    if not math.isfinite(factor) or factor == 0.0:
        raise InputError("--columns", f"'{entry}' multiplies by {factor:g}", "a finite factor other than 0 is accepted")
    return tuple(names), factor


def parse_columns(text: str) -> dict[str, Mapping]:
    """Parse ``--columns``; nothing is evaluated.

    Raises InputError for anything but a list of CHANNEL=PRODUCT[UNIT].
    """
    found: dict[str, Mapping] = {}
    for entry in (part.strip() for part in _split(text)):
        match = _ENTRY.match(entry)
        if match is None:
            raise InputError("--columns", f"'{entry}'", ACCEPTED)
        channel = match["channel"]
        if channel not in CHANNELS:
            raise InputError("--columns", f"unknown channel '{channel}' in '{entry}'", ACCEPTED)
        if channel in found:
            raise InputError("--columns", f"channel {channel} given twice", "each channel once is accepted")
        names, factor = _product(entry, match["product"])
        unit = match["unit"]
        found[channel] = Mapping(channel, names, factor, None if unit is None else unit.strip())
    return found
