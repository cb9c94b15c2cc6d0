"""Independent pieces of work on every core: in threads, because kernels run without the interpreter's lock.

What comes out is what one after another gives, to the last bit. HARNESS_THREADS says how many at a time; worker
processes, of which there is one a core, have one. Linear algebra has one thread anywhere: its matrices are of ten to a
hundred rows here, for which more than one only costs.
"""

import os
import threading
from collections.abc import Callable, Sequence
from contextvars import copy_context
from typing import TypeVar

from harness.core.budget import in_parts
from harness.core.errors import InputError
from harness.core.telling import told

T = TypeVar("T")
R = TypeVar("R")
VARIABLE = "HARNESS_THREADS"
_COUNTS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def threads() -> int:
    """How many pieces of work run at a time here. Raises InputError for a variable that is no number."""
    asked = os.environ.get(VARIABLE)
    if asked is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if not asked.isdecimal() or int(asked) < 1:
        raise InputError(VARIABLE, repr(asked), "a whole number of at least 1")
    return int(asked)


def one_thread(whatever_was_asked: bool = False) -> None:
    """Ask for one thread of libraries that this process, or one that it starts, loads from now on.

    A variable that a user has set stays, unless ``whatever_was_asked``: of workers there is one for each core, and
    each does one thing at a time.
    """
    if whatever_was_asked:
        os.environ[VARIABLE] = "1"
    for name in _COUNTS:
        if whatever_was_asked or name not in os.environ:
            os.environ[name] = "1"


def each(work: Callable[[T], R], items: Sequence[T], named: Callable[[T], str] | None = None) -> list[R]:
    """What work makes of each item, in order.

    named : what is said of an item while it is waited for. The first error, in the order of the items, is raised, and
    what had not begun by then is left undone. What is already one of several threads does one after another.
    """
    work, done = in_parts(work, len(items))
    try:
        return _each(work, items, named)
    finally:
        done()


def _each(work: Callable[[T], R], items: Sequence[T], named: Callable[[T], str] | None) -> list[R]:
    count = min(threads(), len(items)) if threading.current_thread() is threading.main_thread() else 1
    turns = items if named is None else told(items, named)
    if count < 2:
        return [work(item) for item in turns]

    from concurrent.futures import ThreadPoolExecutor  # no command that asks for help waits for it

    with ThreadPoolExecutor(count, thread_name_prefix="harness") as pool:
        # each its own context: what listens, and how numpy warns
        begun = [pool.submit(copy_context().run, work, item) for item in items]
        try:
            return [one.result() for one, _ in zip(begun, turns, strict=True)]
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
