"""A sealed process that answers one recording after another, so that starting it costs once and not every time.

It gets recordings on standard input and nothing else: its working folder is empty, its environment holds only what it
takes to start, no file but the three standard ones is open. A request is a line of JSON ({"who", "arguments", "bytes"})
and the recording; an answer is a line with its length and the answer.
"""

import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, final

from harness.core.errors import HarnessError

KEPT = ("PATH", "LD_LIBRARY_PATH", "LANG", "NUMBA_CACHE_DIR", "OMP_NUM_THREADS")
"""Environment variables without which the diagnosis could not start; none of them tells."""
RENEWED_AFTER = 64
"""Recordings after which a process is replaced, so that what libraries leak stays small."""
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")


class SilentError(HarnessError):
    """The process ended or took too long: it has said nothing."""


@final
class BlindProcess:
    """A sealed process. Close it when done.

    command : what to run. environment : what it needs to find its code, besides what is always kept. place : where its
    working folder is made, None for the system's folder of temporary files.
    """

    def __init__(self, command: Sequence[str], environment: Mapping[str, str], place: Path | None = None) -> None:
        self._command, self._environment, self._place = list(command), dict(environment), place
        self._process: subprocess.Popen[bytes] | None = None
        self._folder = Path()
        self._answered = 0

    def ask(self, who: str, arguments: Sequence[str], recording: bytes, timeout: float) -> bytes:
        """The answer to a recording; b"" when the process ended, twice, or took longer than ``timeout`` (s)."""
        for _ in range(2):
            try:
                return self._ask(who, arguments, recording, time.monotonic() + timeout)
            except TimeoutError:
                self.close()
                return b""
            except (SilentError, OSError):
                self.close()
        return b""

    def close(self) -> None:
        """End the process and remove its folder."""
        if self._process is not None:
            self._process.kill()
            with self._process as ended:
                ended.wait()
            shutil.rmtree(self._folder, ignore_errors=True)
        self._process = None

    def _ask(self, who: str, arguments: Sequence[str], recording: bytes, deadline: float) -> bytes:
        if self._answered >= RENEWED_AFTER:
            self.close()
        process = self._process or self._start()
        assert process.stdin is not None
        assert process.stdout is not None
        self._empty()
        head = json.dumps({"who": who, "arguments": list(arguments), "bytes": len(recording)})
        process.stdin.write(head.encode() + b"\n" + recording)
        process.stdin.flush()
        said = self._read(process.stdout, deadline)
        self._answered += 1
        return said

    def _start(self) -> "subprocess.Popen[bytes]":
        kept = {name: os.environ[name] for name in KEPT if name in os.environ}
        self._folder = Path(tempfile.mkdtemp(prefix="blind-", dir=self._place))
        own = {"HOME": str(self._folder), "TMPDIR": str(self._folder)}
        self._process = subprocess.Popen(
            self._command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd=self._folder,
            env={**kept, **ONE_THREAD, **self._environment, **own},
            close_fds=True,
            start_new_session=True,
            bufsize=0,
        )
        self._answered = 0
        return self._process

    def _empty(self) -> None:
        for left in self._folder.iterdir():
            with suppress(OSError):
                shutil.rmtree(left) if left.is_dir() else left.unlink()

    def _read(self, stream: IO[bytes], deadline: float) -> bytes:
        buffer = b""
        while b"\n" not in buffer:
            buffer += self._some(stream, deadline)
        head, _, said = buffer.partition(b"\n")
        if not head.isdigit():
            raise SilentError("no length of an answer")
        while len(said) < int(head):
            said += self._some(stream, deadline)
        return said

    def _some(self, stream: IO[bytes], deadline: float) -> bytes:
        left = deadline - time.monotonic()
        if left <= 0.0 or not select.select([stream], [], [], left)[0]:
            raise TimeoutError
        some = os.read(stream.fileno(), 1 << 16)
        if not some:
            raise SilentError("the process ended")
        return some
