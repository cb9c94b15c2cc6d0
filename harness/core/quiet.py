"""Catch what C libraries print: both streams, at the level of file descriptors, into the log."""

import logging
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from harness.core.divert import diverted

_lock = threading.RLock()


@contextmanager
def quiet(log: logging.Logger) -> Iterator[None]:
    """Send everything written to descriptors 1 and 2 inside the block to ``log``, one debug record a line.

    A second thread waits for the first, and what other threads print meanwhile is caught too.
    """
    with _lock, tempfile.TemporaryFile() as caught:
        try:
            with diverted(caught.fileno()):
                yield
        finally:
            caught.seek(0)
            for line in caught.read().decode(errors="replace").splitlines():
                if line.strip():
                    log.debug("%s", line.rstrip())
