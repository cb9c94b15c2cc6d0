"""A dask scheduler with two workers on this machine."""

import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest


@contextmanager
def two_workers() -> Iterator[tuple[str, list["subprocess.Popen[str]"]]]:
    """The scheduler's address, once both workers of one thread are there, and the processes: scheduler, workers."""
    pytest.importorskip("distributed")
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    started = [_dask("scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard")]
    started += [
        _dask("worker", address, "--nthreads", "1", "--nworkers", "1", "--no-nanny", "--no-dashboard") for _ in range(2)
    ]
    try:
        distributed: Any = import_module("distributed")
        with distributed.Client(address, timeout=30, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=30)
        yield address, started
    finally:
        for process in started:
            process.kill()
        for process in started:
            process.communicate()


def _dask(*arguments: str) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, "-m", "dask", *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parent)},
    )
