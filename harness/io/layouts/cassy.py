"""CASSY Lab's text export: names, symbols and units in a line ``DEF="Zeit" t / s<tab>"Winkel" a / rad``."""

import re
from collections.abc import Sequence

from harness.io.layout import Head, Layout, separator_of

_FIELD = re.compile(r'^\s*"?(?P<name>[^"]*)"?\s*(?P<symbol>[^/]*?)\s*(?:/\s*(?P<unit>.+))?$')


def _find(lines: Sequence[str], name: str) -> Head | None:
    at = next((i for i, line in enumerate(lines) if line.startswith("DEF=")), None)
    if at is None or at + 1 >= len(lines):
        return None
    parts = [found for cell in lines[at][len("DEF=") :].split("\t") if (found := _FIELD.match(cell))]
    fields = tuple(f"{one['name']} {one['symbol']}".strip() for one in parts)
    decimal = separator_of(["", lines[at + 1].strip()])[1]
    return Head(first=at + 1, fields=fields, units=tuple(one["unit"] or "" for one in parts), decimal=decimal)


LAYOUT = Layout(name="CASSY", find=_find)
