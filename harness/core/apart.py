"""A file of unknown origin is read in a process of its own.

The libraries that read binary formats are written in C, C++ and Rust, and a damaged file can crash them, keep them busy
for ever or have them ask for all memory there is. Here that ends a process which holds nothing of ours, and the person
reads one line. What comes back is numbers and JSON, never an object that could run something.
"""

import atexit
import json
import os
import resource
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import IO, Any, TypeAlias

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError

Found: TypeAlias = tuple[Mapping[str, FloatArray], Any]
"""Columns by name, and what is said of them as JSON."""

MOST_MEMORY = 2 << 30
"""Bytes that the reading process may ask for, besides those that its libraries take when they are loaded."""
LEAST_S, BYTES_A_SECOND = 5, 10_000_000
"""A file may take the first, and one second more for so many of its bytes, s of a processor."""
_QUIET = {"HDF5_PLUGIN_PRESET": "::", "OPENBLAS_NUM_THREADS": "1", "ARROW_DEFAULT_MEMORY_POOL": "system"}
"""No library that an HDF5 file names is loaded, no thread of linear algebra started, no memory asked for in advance."""
_STUCK = 10.0
"""Times that limit until a process that does not even compute is ended."""
_idle: dict[int, list["subprocess.Popen[bytes]"]] = {}
"""Processes that are kept, by the number of the process that started them: those of a parent are not a child's."""


def read_apart(
    reader: str, path: Path, accepted: str, *, seconds: int | None = None, kept: bool = False, **arguments: Any
) -> Found:
    """What ``reader`` ("module:function") returns for a path and JSON arguments, from a process of its own.

    The function gives columns (vectors of any lengths) and something that JSON can say. seconds : s of a processor that
    it may take, by the size of the file where it is None. kept : the process may have read other files so before, and
    will read more, which spares its start. Raises InputError: the one the reader raised, or one that says how reading
    ended otherwise, and what would be ``accepted``.
    """
    seconds = LEAST_S + path.stat().st_size // BYTES_A_SECOND if seconds is None else seconds
    request = {"reader": reader, "path": str(path), "arguments": arguments, "seconds": seconds, "accepted": accepted}
    with suppress(OSError):  # a working folder that was removed
        request["folder"] = os.getcwd()
    idle = _idle.setdefault(os.getpid(), [])
    process = idle.pop() if kept and idle else _started()
    overdue = threading.Timer(_STUCK * seconds, process.kill)
    overdue.daemon = True
    overdue.start()
    try:
        assert process.stdin is not None
        assert process.stdout is not None
        with suppress(BrokenPipeError):
            process.stdin.write(json.dumps(request).encode() + b"\n")
            process.stdin.flush()
        found = _received(process.stdout)
    except BaseException:
        process.kill()
        _ended(process)
        raise
    finally:
        overdue.cancel()
    if found is None or not kept:
        _ended(process)
    else:
        idle.append(process)
    if isinstance(found, InputError):
        raise found
    if found is None:
        raise InputError(str(path), _ending(process.returncode, seconds), accepted)
    return found


def _started() -> "subprocess.Popen[bytes]":
    code = str(Path(__file__).resolve().parents[2])
    known = os.pathsep.join([code, *filter(None, [os.environ.get("PYTHONPATH")])])
    return subprocess.Popen(
        # -P: a module in the working folder is not taken for one of ours
        [sys.executable, "-P", "-m", __name__],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": known, **_QUIET},
    )


def _ended(process: "subprocess.Popen[bytes]") -> None:
    """Let a process go, and wait until it is gone."""
    for stream in (process.stdin, process.stdout):
        assert stream is not None
        with suppress(BrokenPipeError):
            stream.close()
    process.wait()


@atexit.register
def dismiss() -> None:
    """Let the processes go that are kept."""
    for process in _idle.pop(os.getpid(), []):
        process.kill()
        _ended(process)


def _received(stream: IO[bytes]) -> Found | InputError | None:
    """What the process says; None when it ended before it had said all."""
    try:
        answer = json.loads(stream.readline())
        if "error" in answer:
            return InputError(*answer["error"])
        return {name: _column(stream, int(size)) for name, size in answer["columns"]}, answer["about"]
    except (ValueError, RecursionError):
        return None


def _column(stream: IO[bytes], size: int) -> FloatArray:
    data = bytearray(8 * size)
    view = memoryview(data)
    while view:
        taken = stream.readinto(view)  # type: ignore[attr-defined]
        if not taken:
            raise ValueError("cut short")
        view = view[taken:]
    return np.frombuffer(data, dtype=np.float64)


def _ending(code: int, seconds: int) -> str:
    """How a process that gave no answer ended."""
    if code == -signal.SIGXCPU:
        return f"takes longer than {seconds} s to read"
    if code == -signal.SIGKILL:
        return "the process that read it was ended: it took too long, or the memory of this machine was used up"
    if code < 0:
        return f"the library that reads it crashed ({signal.Signals(-code).name})"
    return "the library that reads it ended the process"


def main() -> None:
    """Read what the lines of standard input ask for, within limits; the answers go to standard output."""
    with os.fdopen(os.dup(1), "wb") as answers, open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        _limit(resource.RLIMIT_CORE, 0)
        for line in sys.stdin.buffer:
            request = json.loads(line)
            with suppress(OSError, KeyError):
                os.chdir(request["folder"])
            _limit(resource.RLIMIT_CPU, int(time.process_time()) + request["seconds"])
            _limit(resource.RLIMIT_DATA, None)
            with suppress(Exception):  # one that cannot be loaded is said by _answer
                import_module(request["reader"].partition(":")[0])
            _limit(resource.RLIMIT_DATA, _taken() + MOST_MEMORY)
            head, columns = _answer(request)
            answers.write(json.dumps(head).encode() + b"\n")
            for column in columns:
                answers.write(column)
            answers.flush()


def _taken() -> int:
    """Bytes of data that this process has asked for, used or not; 0 where the system does not say."""
    with suppress(OSError, ValueError, IndexError):
        return int(Path("/proc/self/statm").read_text().split()[5]) * resource.getpagesize()
    return 0


def _limit(kind: int, most: int | None) -> None:
    """most : None for as much as this process may ever have."""
    allowed = resource.getrlimit(kind)[1]
    least = allowed if most is None else most if allowed == resource.RLIM_INFINITY else min(most, allowed)
    resource.setrlimit(kind, (least, allowed))


def _answer(request: dict[str, Any]) -> tuple[dict[str, Any], list[Any]]:
    """The line that says what follows, and the columns that do."""
    module, _, name = request["reader"].partition(":")
    path, accepted = request["path"], request["accepted"]
    try:
        columns, about = getattr(import_module(module), name)(Path(path), **request["arguments"])
        kept = {key: np.ascontiguousarray(values, dtype=np.float64) for key, values in columns.items()}
        json.dumps(about)
        head = {"columns": [(key, values.size) for key, values in kept.items()], "about": about}
        return head, [values.data for values in kept.values()]
    except InputError as error:
        return {"error": (error.where, error.found, error.accepted)}, []
    except MemoryError:
        return {"error": (path, f"takes more than {MOST_MEMORY >> 20} MiB of memory to read", accepted)}, []
    except BaseException as error:  # whatever damaged bytes lead a library to, a panic of one in Rust among it
        return {"error": (path, f"cannot be read ({type(error).__name__}: {error})", accepted)}, []


if __name__ == "__main__":
    main()
