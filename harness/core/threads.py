"""Threads of the linear algebra: matrices here are of ten to a hundred rows, for which more than one only costs."""

import os

_COUNTS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def one_thread(whatever_was_asked: bool = False) -> None:
    """Ask for one thread of libraries that this process, or one that it starts, loads from now on.

    A variable that a user has set stays, unless ``whatever_was_asked``: of workers there is one for each core.
    """
    for name in _COUNTS:
        if whatever_was_asked or name not in os.environ:
            os.environ[name] = "1"
