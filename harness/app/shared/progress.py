"""How a use case tells how far it is; light, since the command imports it."""

import logging
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeAlias

from harness.core.quiet import diverted

Progress: TypeAlias = Callable[[str, int, int], None]
"""Called with what is being done, how many are done, and how many there are; 0 where nobody knows."""

_FEWEST = 3
"""Steps that must be done before they say anything of the rest: the first ones are not like the others."""
_LEAST_S = 1.0
"""Of time left that is worth a word."""


def SILENT(step: str, done: int, total: int) -> None:  # noqa: N802  (a constant that is called)
    """A Progress that says nothing."""


def duration(seconds: float) -> str:
    """As people say it: "40 s", "3 min 20 s", "2 h 5 min"."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


class Pace:
    """What a Progress was last told, as a line for people with the time that is left.

    Another total, or fewer done than before, is other work, which has a pace of its own. What was done before the first
    call (rows of an earlier start) says nothing of the pace.
    """

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self._step, self._done, self._total = "", 0, -1
        self._first, self._began, self._told = 0, 0.0, 0.0

    def tell(self, step: str, done: int, total: int) -> None:
        now = self._now()
        if total != self._total or done < self._done:
            self._first, self._began = done, now
        self._step, self._done, self._total, self._told = step, done, total, now

    def line(self) -> str:
        """Such as "trying end-stop: 3 of 24 done, about 8 s left for these"; "" before anything was told."""
        if self._total <= 0:
            return self._step
        left = self._left()
        more = "" if left is None or left < _LEAST_S else f", about {duration(left)} left for these"
        return f"{self._step}: {self._done} of {self._total} done{more}"

    def _left(self) -> float | None:
        """Seconds, as long as the rest goes as what was done; None where too little was."""
        done = self._done - self._first
        if done < _FEWEST or self._done >= self._total:
            return None
        each = (self._told - self._began) / done
        return max((self._total - self._done) * each - (self._now() - self._told), 0.0)


NAME = "log.txt"
"""Name of the log in the output folder."""


@contextmanager
def journal(path: Path) -> Iterator[None]:
    """Send logging, and everything written to descriptors 1 and 2, to the file ``path`` while the block runs.

    Not for use in several threads at once: descriptors belong to the whole process.
    """
    log, warned = logging.getLogger("harness"), logging.getLogger("py.warnings")
    level, propagate = log.level, log.propagate
    handler = logging.FileHandler(path, encoding="utf-8")
    handler.setFormatter(logging.Formatter("%(asctime)s %(name)s %(levelname)s %(message)s"))
    log.addHandler(handler)
    warned.addHandler(handler)
    log.setLevel(logging.DEBUG)
    log.propagate = False
    try:
        with open(path, "ab") as file, diverted(file.fileno()):
            yield
    finally:
        log.removeHandler(handler)
        warned.removeHandler(handler)
        handler.close()
        log.setLevel(level)
        log.propagate = propagate
