"""The log of a run: what the program and its libraries say, Python's and C's alike, goes into one file."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from harness.core.divert import diverted

NAME = "log.txt"
"""Name of the log in the output folder."""


@contextmanager
def journal(path: Path) -> Iterator[None]:
    """Send logging, and everything written to descriptors 1 and 2, to the file ``path`` while the block runs.

    Not for use in several threads at once: descriptors belong to the whole process.
    """
    log, warned = logging.getLogger("harness"), logging.getLogger("py.warnings")
    level, propagate = log.level, log.propagate
    handler = logging.FileHandler(path, encoding="utf-8")
    handler.setFormatter(logging.Formatter("%(asctime)s %(name)s %(levelname)s %(message)s"))
    log.addHandler(handler)
    warned.addHandler(handler)
    log.setLevel(logging.DEBUG)
    log.propagate = False
    try:
        with open(path, "ab") as file, diverted(file.fileno()):
            yield
    finally:
        log.removeHandler(handler)
        warned.removeHandler(handler)
        handler.close()
        log.setLevel(level)
        log.propagate = propagate
