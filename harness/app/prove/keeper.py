"""Keeps what must stay secret while recordings are diagnosed, in the memory of a process of its own.

It lies on no disk then. When the proof ends early, whatever ended it, the keeper writes it down (for the owner alone)
once the diagnosing processes are gone, so that the proof can be resumed; resuming takes it off the disk again first.
"""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

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


@contextmanager
def keeping(path: Path, secrets: Mapping[str, Any], mark: int | None = None) -> Iterator[Callable[[], None]]:
    """Keep ``secrets`` in another process; they are written to ``path`` unless what is yielded was called before.

    mark : a descriptor that the process holds until it has ended.
    """
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", __name__],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[3])},
        start_new_session=True,
        pass_fds=() if mark is None else (mark,),
    )
    told, answers = process.stdin, process.stdout
    assert told is not None
    assert answers is not None
    told.write(json.dumps({"path": str(path), "secrets": dict(secrets)}).encode() + b"\n")
    told.flush()
    if answers.readline() != DONE:
        raise HarnessError("the process that keeps the answers could not be started")

    def end(word: bytes) -> None:
        if not told.closed:
            with suppress(OSError):
                told.write(word)
                told.close()
            with suppress(subprocess.TimeoutExpired):
                process.wait(LONGEST_S)

    try:
        yield lambda: end(DONE)
    finally:
        end(b"")
        answers.close()


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
