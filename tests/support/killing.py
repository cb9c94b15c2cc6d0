"""Commands that are killed or interrupted: processes of a session of their own, of which nothing may stay."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import psutil

from harness.core.kernel_cache import cache_folder

ROOT = Path(__file__).resolve().parents[2]
COMMAND = (sys.executable, "-m", "harness.cli")


def environment(**changes: str) -> dict[str, str]:
    """Where the program and its compiled kernels are, whoever starts it."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("XDG_", "HARNESS_"))}
    return {**kept, "PYTHONPATH": str(ROOT), "NUMBA_CACHE_DIR": str(cache_folder()), **changes}


def _listening() -> None:
    """SIGINT as a terminal would deliver it: a test run started in the background hands on that it is ignored."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


def started(line: Sequence[str], place: Path, **changes: str) -> "subprocess.Popen[str]":
    """A command in the folder ``place``, in a session of its own."""
    return subprocess.Popen(
        [*COMMAND, *line],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=place,
        env=environment(**changes),
        start_new_session=True,
        preexec_fn=_listening,  # noqa: PLW1509  (no thread is running)
    )


def ended(line: Sequence[str], place: Path, **changes: str) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of a command that nobody disturbs."""
    with started(line, place, **changes) as process:
        out, err = process.communicate(timeout=600)
    return process.returncode, out, err


def stopped(line: Sequence[str], place: Path, there: str, how: signal.Signals) -> tuple[int, str, str]:
    """As ``ended``, of a command that gets a signal once there is a file like ``there`` in its folder."""
    process = started(line, place)
    limit = time.monotonic() + 60.0
    while not any(place.glob(there)):
        assert time.monotonic() < limit
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(how)
    return _left(process)


def killed(line: Sequence[str], place: Path, after_s: float) -> bool:
    """Kill a command after a time; whether it was still at work."""
    process = started(line, place)
    try:
        process.wait(after_s)
    except subprocess.TimeoutExpired:
        process.kill()
    return _left(process)[0] < 0


def _left(process: "subprocess.Popen[str]") -> tuple[int, str, str]:
    """What a process that ends has said; its workers are left to themselves: that none of them goes on is asserted."""
    # not until standard output ends, which workers hold open
    process.wait(60)
    limit = time.monotonic() + 10.0
    while left := session(process.pid):
        assert time.monotonic() < limit, f"these go on: {left}"
        time.sleep(0.05)
    out, err = process.communicate()
    return process.returncode, out, err


def session(leader: int) -> Mapping[int, str]:
    """Processes of a session that are alive, with their commands."""
    found = {}
    for process in psutil.process_iter():
        try:
            if os.getsid(process.pid) == leader and process.status() != psutil.STATUS_ZOMBIE:
                found[process.pid] = " ".join(process.cmdline())
        except (OSError, psutil.Error):
            continue
    return found
