"""Formats by the suffix of a file: those of harness.io.readers, then those that other packages register.

A package adds one by an entry point of group ``harness.readers`` whose value is the Reader ("package.module:READER").
"""

import pkgutil
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pathlib import Path

from harness.core.errors import InputError
from harness.core.registered import registered
from harness.io import readers
from harness.io.reader import Reader

GROUP = "harness.readers"
OURS = ".rrd"
"""Our own traces, read by another room."""
BAGS = (".bag", ".db3", ".mcap")
"""Of robots: what is in them hangs on a robot's model, so that they are read as logs."""


@cache
def by_suffix() -> Mapping[str, Reader]:
    """Every reader by each of its suffixes. Raises InputError for a suffix that is taken."""
    files = [import_module(f"{readers.__name__}.{found.name}") for found in pkgutil.iter_modules(readers.__path__)]
    own = (one for file in files for one in vars(file).values() if isinstance(one, Reader))
    found: dict[str, Reader] = {}
    for reader in (
        *sorted(own, key=lambda r: (not r.text, r.name)),
        *(r for _, r in registered(GROUP, Reader, "reader")),
    ):
        for suffix in reader.suffixes:
            if suffix in found or suffix == OURS:
                raise InputError(f"reader {reader.name}", f"the suffix {suffix} is taken", "another is accepted")
            found[suffix] = reader
    return found


def kind_of(path: Path) -> str:
    """The suffix that says the format, in small letters, that of packing left out; "" where there is none."""
    suffixes = [s.lower() for s in path.suffixes]
    if suffixes and suffixes[-1] == ".gz":
        suffixes.pop()
    return suffixes[-1] if suffixes else ""


def reader_of(suffix: str) -> Reader | None:
    """The reader of files with this suffix, None where there is none."""
    return by_suffix().get(suffix)


def formats() -> str:
    """The formats there are, for a message."""
    return f"{', '.join(dict.fromkeys(r.said for r in by_suffix().values()))} and our own {OURS}"
