"""An interruption ends a command within two seconds, whatever it is doing."""

import signal
import subprocess
import sys

import pytest

# a mutex that is locked twice holds its thread where no signal is looked at, as a compiled loop does; a shell that
# starts tests in the background has them ignore the first signal
_DEAF = """
import ctypes, signal, threading
from harness.cli import main
signal.signal(signal.SIGINT, signal.default_int_handler)
main.heed()
lock, mutex = ctypes.CDLL(None).pthread_mutex_lock, ctypes.create_string_buffer(64)
threading.Timer(0.3, print, ("deaf",), {"flush": True}).start()
lock(mutex)
lock(mutex)
"""


@pytest.mark.parametrize("stop", [signal.SIGINT, signal.SIGTERM])
def test_a_call_that_looks_up_at_nothing_is_ended(stop: signal.Signals) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", _DEAF], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as deaf:
        try:
            assert deaf.stdout is not None
            assert deaf.stdout.readline() == "deaf\n"
            deaf.send_signal(stop)
            _, err = deaf.communicate(timeout=60)
        finally:
            deaf.kill()
    assert (deaf.returncode, err) == (130, "harness: interrupted; nothing was written\n")
