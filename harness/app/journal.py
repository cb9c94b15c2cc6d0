"""The log of a run: what the program and its libraries say, Python's and C's alike, goes into one file."""

import ctypes
import logging
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

NAME = "log.txt"
"""Name of the log in the output folder."""


@contextmanager
def journal(path: Path) -> Iterator[None]:
    """Send logging, and everything written to descriptors 1 and 2, to the file ``path`` while the block runs.

    Not for use in several threads at once: descriptors belong to the whole process.
    """
    log = logging.getLogger("harness")
    level, propagate = log.level, log.propagate
    handler = logging.FileHandler(path, encoding="utf-8")
    handler.setFormatter(logging.Formatter("%(asctime)s %(name)s %(levelname)s %(message)s"))
    log.addHandler(handler)
    log.setLevel(logging.DEBUG)
    log.propagate = False
    try:
        with _diverted(path):
            yield
    finally:
        log.removeHandler(handler)
        handler.close()
        log.setLevel(level)
        log.propagate = propagate


@contextmanager
def _diverted(path: Path) -> Iterator[None]:
    """Descriptors 1 and 2 append to ``path``; C's own buffers are flushed on the way in and out."""
    _flush()
    saved: dict[int, int] = {}
    target = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o666)
    try:
        for descriptor in (1, 2):
            with suppress(OSError):
                saved[descriptor] = os.dup(descriptor)
                os.dup2(target, descriptor)
        yield
    finally:
        _flush()
        for descriptor, copy in saved.items():
            os.dup2(copy, descriptor)
            os.close(copy)
        os.close(target)


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError, AttributeError):
            stream.flush()
    ctypes.CDLL(None).fflush(None)
