"""An interrupt ends a command within two seconds, also while compiled code runs that looks up at nothing.

Python hears a signal between two of its own steps, and a compiled loop is one step. The signal's number is written to a
pipe at once, though, and compiled loops run without the interpreter's lock: a thread waits at the pipe, leaves the
command time to end by itself, and then ends it. What was half-written is swept by the next command, as after a kill.
"""

import multiprocessing
import os
import signal
import threading
import time
from contextlib import suppress
from types import FrameType
from typing import NoReturn

INTERRUPTED = 130
NOTHING_WRITTEN = "interrupted; nothing was written"
_GRACE = 1.5
"""Seconds in which a command may end by itself, and keep what it has done."""
_SIGNALS = frozenset({signal.SIGINT, signal.SIGTERM})

told = threading.Event()
"""Set once a person has read how the command ended."""


def heed() -> None:
    """Take both signals for an interruption from now on; only the main thread may, and elsewhere nothing is done."""
    if threading.current_thread() is not threading.main_thread():
        return
    signal.signal(signal.SIGTERM, _interrupted)
    here, there = os.pipe()
    os.set_blocking(there, False)
    signal.set_wakeup_fd(there, warn_on_full_buffer=False)
    threading.Thread(target=_wait, args=(here,), name="interrupt", daemon=True).start()


def _interrupted(signum: int, frame: FrameType | None) -> NoReturn:
    raise KeyboardInterrupt


def _wait(pipe: int) -> None:
    """End this process some time after an interruption was heard."""
    while not _SIGNALS.intersection(os.read(pipe, 64)):
        pass
    time.sleep(_GRACE)
    for child in multiprocessing.active_children():
        child.kill()
    if not told.is_set():
        with suppress(OSError):
            os.write(2, f"harness: {NOTHING_WRITTEN}\n".encode())
    os._exit(INTERRUPTED)
