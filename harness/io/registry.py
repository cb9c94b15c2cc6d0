"""Formats by the suffix of a file, and layouts of text: those of harness.io.readers and harness.io.layouts, then those
that other packages register.

A package adds one by an entry point of group ``harness.readers`` whose value is the Reader ("package.module:READER"),
or of group ``harness.layouts``, the Layout.
"""

import json
import pkgutil
import re
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TypeVar

from harness.core.errors import InputError
from harness.core.registered import registered
from harness.io import layouts, readers
from harness.io.layout import Layout
from harness.io.reader import Reader

K = TypeVar("K")
GROUP, LAYOUTS = "harness.readers", "harness.layouts"
OURS = ".rrd"
"""Our own traces, read by another room."""
_LOOKED = 1 << 12
"""Bytes in which rows of numbers are looked for."""
_ROW = re.compile(rb"\s*[+-]?\.?\d[\d.,;:eE+\-\s]*")
BAGS = (".bag", ".db3", ".mcap")
"""Of robots: what is in them hangs on a robot's model, so that they are read as logs."""


def _own(folder: ModuleType, kind: type[K]) -> list[K]:
    """What the files of a folder make of this kind."""
    files = [import_module(f"{folder.__name__}.{found.name}") for found in pkgutil.iter_modules(folder.__path__)]
    return list(dict.fromkeys(one for file in files for one in vars(file).values() if isinstance(one, kind)))


@cache
def all_layouts() -> tuple[Layout, ...]:
    """Every layout of text."""
    return (*_own(layouts, Layout), *(one for _, one in registered(LAYOUTS, Layout, "layout")))


@cache
def by_suffix() -> Mapping[str, Reader]:
    """Every reader by each of its suffixes. Raises InputError for a suffix that is taken."""
    found: dict[str, Reader] = {}
    for reader in (
        *sorted(_own(readers, Reader), key=lambda r: (not r.text, r.name)),
        *(r for _, r in registered(GROUP, Reader, "reader")),
    ):
        for suffix in reader.suffixes:
            if suffix in found or suffix == OURS:
                raise InputError(f"reader {reader.name}", f"the suffix {suffix} is taken", "another")
            found[suffix] = reader
    return found


def kind_of(path: Path) -> str:
    """The suffix that says the format, in small letters, that of packing left out; "" where there is none."""
    suffixes = [s.lower() for s in path.suffixes]
    if suffixes and suffixes[-1] == ".gz":
        suffixes.pop()
    return suffixes[-1] if suffixes else ""


def reader_for(path: Path) -> Reader | None:
    """The reader of a file by its suffix; where that says none, or a format of numbers in binary, that of text for one
    that holds rows of numbers as text, and that of JSON for a text of its objects. None where there is none.
    """
    reader = by_suffix().get(kind_of(path))
    if reader is not None and reader.text and _holds_objects(path):
        return by_suffix()[".jsonl"]
    if (reader is None or not reader.text) and kind_of(path) not in (OURS, *BAGS) and _holds_rows(path):
        return by_suffix()[".csv"]
    return reader


def _holds_objects(path: Path) -> bool:
    """Whether its first lines are objects of JSON, each whole."""
    try:
        with path.open("rb") as file:
            first, *more = file.read(_LOOKED).split(b"\n")
        return bool(more) and first.startswith(b"{") and isinstance(json.loads(first), dict)
    except (OSError, ValueError, RecursionError):
        return False


def _holds_rows(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            head = file.read(_LOOKED)
    except OSError:
        return False
    lines = head.split(b"\n")[:-1]
    rows = [line for line in lines if _ROW.fullmatch(line)]
    marked = b"\x00" in head or head.lstrip()[:1] in (b"<", b"{", b"[")
    return not marked and len(rows) > max(0.5 * len(lines), 1)


def formats() -> str:
    """The formats there are, for a message."""
    return f"{', '.join(dict.fromkeys(r.said for r in by_suffix().values()))} and our own {OURS}"
