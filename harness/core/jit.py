"""The one place where plain functions become compiled ones.

Kernels are written as ordinary functions and compiled here, so that with NUMBA_DISABLE_JIT=1 coverage and mutation
testing see the plain code. The cache lies in a folder of the user's, or in a temporary one where that cannot be
written: a read-only home costs a compilation, not a failure.
"""

import hashlib
import os
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar, cast

from harness.core.kernel_cache import cache_folder

F = TypeVar("F", bound=Callable[..., Any])


os.environ["NUMBA_CACHE_DIR"] = str(cache_folder())

import numba  # noqa: E402  (reads its cache folder from the environment when it is imported)

_ROOT = Path(os.environ["NUMBA_CACHE_DIR"])
_PACKAGE = Path(__file__).resolve().parents[1]
_INLINED_FROM = {
    "kernels": ("model", "kernels"),
    "model": ("model", "kernels"),
    "engines": ("model", "kernels", "engines"),
    "diagnosis": ("model", "kernels", "exact", "diagnosis"),
    "user": ("model", "kernels", "exact"),
}


def _registered() -> list[Path]:
    """Modules of other packages whose laws the kernels call; what cannot be found is the registry's to report."""
    found = []
    for point in sorted(entry_points(group="harness.terms"), key=lambda p: p.name):
        with suppress(ImportError):
            spec = find_spec(point.module)
            if spec is not None and spec.origin is not None:
                found.append(Path(spec.origin))
    return found


@cache
def _fingerprint(room: str) -> str:
    """Hash of every source a room's kernels are compiled from: Numba itself looks only at a function's own file."""
    digest = hashlib.sha256(Path(__file__).read_bytes())
    for folder in _INLINED_FROM.get(room, (room,)):
        for file in sorted((_PACKAGE / folder).rglob("*.py")):
            digest.update(file.name.encode() + file.read_bytes())
    for file in _registered() if "model" in _INLINED_FROM.get(room, ()) else ():
        digest.update(file.name.encode() + file.read_bytes())
    return digest.hexdigest()[:12]


def compiled(function: F, *, fastmath: bool = False, lean: bool = False) -> F:
    """Compile a plain function with Numba, cached on disk, without the interpreter lock."""
    room = function.__module__.split(".")[1] if function.__module__.startswith("harness.") else "user"
    # kept here because Numba reads it when a function is decorated, and one room must not share another's
    numba.config.CACHE_DIR = str(_ROOT / f"{room}-{_fingerprint(room)}")  # type: ignore[attr-defined]
    options: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy"}
    if fastmath:
        options["fastmath"] = {"contract", "reassoc", "nsz", "arcp"}
    if lean:
        options["_nrt"] = False
    return cast(F, numba.njit(**options)(function))


def lean(function: F) -> F:
    """Compiled without reference counting, which costs more than a short law: for functions that make no arrays."""
    return compiled(function, lean=True)


def fast(function: F) -> F:
    """Compiled with sums put in another order: for loops whose rounding was bounded by a test; nan stays nan."""
    return compiled(function, fastmath=True)
