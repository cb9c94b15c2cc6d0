"""A pipe into a file, for a library that writes by itself and does not say, or never ends, when the disk is full."""

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, final

_PIECE = 1 << 20


@final
class Pipe:
    """The end to write to, by name; what comes out of the other end goes into a file.

    After an error the rest is taken and dropped, so that whoever writes is never kept waiting.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._error: OSError | None = None
        self._out, self._in = os.pipe()
        self.name = f"/dev/fd/{self._in}"
        self._thread = threading.Thread(target=self._pour, daemon=True)
        self._thread.start()

    def opened(self) -> None:
        """Whoever writes has opened the pipe; it ends when they close it."""
        if self._in >= 0:
            os.close(self._in)
            self._in = -1

    def close(self) -> None:
        """Wait for the rest; raises the OSError that writing met with."""
        self.opened()
        self._thread.join()
        os.close(self._out)
        if self._error is not None:
            raise self._error

    def _pour(self) -> None:
        while piece := os.read(self._out, _PIECE):
            if self._error is None:
                try:
                    rest = memoryview(piece)
                    while rest:
                        rest = rest[self._file.write(rest) :]
                except OSError as error:
                    self._error = error


@contextmanager
def poured(path: Path) -> Iterator[Pipe]:
    """A pipe into the file ``path``; raises OSError at the end when it could not be written."""
    with path.open("wb", buffering=0) as file:
        pipe = Pipe(file)
        try:
            yield pipe
        except BaseException:
            with suppress(OSError):
                pipe.close()
            raise
        pipe.close()
