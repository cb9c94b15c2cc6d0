"""The trace that is meant by a folder or a file."""

from pathlib import Path

from harness.core.errors import InputError

TRACE = "trace.rrd"


def find_trace(place: Path) -> Path:
    """The .rrd that ``place`` is, or that lies in it.

    Raises InputError when there is none.
    """
    path = place / TRACE if place.is_dir() else place
    if not path.is_file():
        raise InputError(str(path), "no such file", f"an output folder with {TRACE}, or a .rrd, is accepted")
    if path.suffix.lower() != ".rrd":
        raise InputError(str(path), f"a {path.suffix or 'nameless'} file", "an output folder or a .rrd is accepted")
    return path
