"""Readers that do what readers of damaged files do."""

import os
import signal
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.apart import Found
from harness.core.errors import InputError


def good(path: Path, factor: float) -> Found:
    print("chatter of a library")
    warnings.warn("and a warning", stacklevel=1)
    return {"t": factor * np.arange(4.0), "empty": np.empty(0)}, {"said": ["µ", None, float("nan")]}


def refuses(path: Path) -> Found:
    raise InputError(str(path), "nothing", "something")


def fails(path: Path) -> Found:
    raise RecursionError("a bug of\nthe library")


def panics(path: Path) -> Found:
    raise BaseException("a panic")


def crashes(path: Path) -> Found:
    os.kill(os.getpid(), signal.SIGSEGV)
    raise AssertionError


def leaves(path: Path) -> Found:
    os._exit(0)


def hangs(path: Path) -> Found:
    while True:
        pass


def hungers(path: Path) -> Found:
    return {"t": np.ones(1 << 29)}, None


def shadowed(path: Path) -> Found:
    return {}, [str(Path(sys.modules["json"].__file__ or "")), os.environ["HDF5_PLUGIN_PRESET"]]


def unsayable(path: Path) -> Any:
    return {"t": np.zeros(3)}, object()


def number(path: Path) -> tuple[dict[str, object], int]:
    """Of the process."""
    return {}, os.getpid()
