"""Catch what C libraries print: both streams, at the level of file descriptors, into the log."""

import logging
import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress


@contextmanager
def diverted(target: int) -> Iterator[None]:
    """Send both descriptors to the open descriptor ``target`` while the block runs.

    Python's streams and C's buffers are flushed on the way in and out; a stream that is closed is left closed.
    Descriptors belong to the whole process: not for several threads at once.
    """
    saved: dict[int, int] = {}
    _flush()
    for descriptor in (1, 2):
        with suppress(OSError):
            saved[descriptor] = os.dup(descriptor)
    try:
        for descriptor in saved:
            os.dup2(target, descriptor)
        yield
    finally:
        _flush()
        for descriptor, copy in saved.items():
            os.dup2(copy, descriptor)
            os.close(copy)


def _flush() -> None:
    import ctypes

    ctypes.CDLL(None).fflush(None)  # the C library keeps its own buffer when the stream is no terminal
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError, AttributeError):
            stream.flush()


_lock = threading.RLock()


@contextmanager
def quiet(log: logging.Logger) -> Iterator[None]:
    """Send everything written to descriptors 1 and 2 inside the block to ``log``, one debug record a line.

    A second thread waits for the first, and what other threads print meanwhile is caught too.
    """
    import tempfile

    with _lock, tempfile.TemporaryFile() as caught:
        try:
            with diverted(caught.fileno()):
                yield
        finally:
            caught.seek(0)
            for line in caught.read().decode(errors="replace").splitlines():
                if line.strip():
                    log.debug("%s", line.rstrip())
