"""Keeps what must stay secret while recordings are diagnosed, in the memory of a process of its own.

It lies on no disk then. When the proof ends early, whatever ended it, the keeper writes it down (for the owner alone)
once the diagnosing processes are gone, so that the proof can be resumed; resuming takes it off the disk again first.
"""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, final

from harness.core.errors import HarnessError
from harness.core.writing import explained, replacing

DONE = b"done\n"
GRACE_S = 1.0
"""Time in which the kernel ends the diagnosing processes of a proof that was killed."""
LONGEST_S = 20.0


def write_private(path: Path, value: Mapping[str, Any]) -> None:
    """Write JSON that its owner alone can read, whole or not at all."""
    with explained(path):
        path.parent.mkdir(mode=0o700, exist_ok=True)
    with replacing(path, mode=0o600) as part:
        part.write_text(json.dumps(value), encoding="utf-8")


@final
class Keeper:
    """A running keeper."""

    def __init__(self, process: "subprocess.Popen[bytes]") -> None:
        self._process = process

    def release(self) -> None:
        """The secrets are needed no more: the keeper ends and writes nothing."""
        self._end(DONE)

    def give_back(self) -> None:
        """Have the secrets written down now, if they were not released."""
        self._end(b"")

    def _end(self, word: bytes) -> None:
        stream = self._process.stdin
        if stream is not None and not stream.closed:
            with suppress(OSError):
                stream.write(word)
                stream.close()
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(LONGEST_S)


@contextmanager
def keeping(path: Path, secrets: Mapping[str, Any], mark: int | None = None) -> Iterator[Keeper]:
    """Keep ``secrets`` in another process; they are written to ``path`` unless released before the block ends.

    mark : a descriptor that the process holds until it has ended.
    """
    code = str(Path(__file__).resolve().parents[2])
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", __name__],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": code},
        start_new_session=True,
        pass_fds=() if mark is None else (mark,),
    )
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write(json.dumps({"path": str(path), "secrets": dict(secrets)}).encode() + b"\n")
    process.stdin.flush()
    if process.stdout.readline() != DONE:
        raise HarnessError("the process that keeps the answers could not be started")
    keeper = Keeper(process)
    try:
        yield keeper
    finally:
        keeper.give_back()
        process.stdout.close()


def main() -> None:
    """Take the secrets from standard input, and wait."""
    told = json.loads(sys.stdin.buffer.readline())
    sys.stdout.buffer.write(DONE)
    sys.stdout.buffer.flush()
    if sys.stdin.buffer.readline() != DONE:
        time.sleep(GRACE_S)
        write_private(Path(told["path"]), told["secrets"])


if __name__ == "__main__":
    main()
