"""Progress on work over two seconds: a bar on a terminal, elsewhere a line on standard error now and then."""

import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TextIO

from harness.app.shared.progress import SILENT, Pace, Progress
from harness.core.errors import visible
from harness.core.kernel_cache import cache_folder, newest

PATIENCE_S = 2.0
"""What takes less says nothing."""
UNSEEN_S = 60.0
"""The same where no terminal draws a bar: what is refused is one line on standard error, and nothing before it."""
EVERY_S = 10.0
"""Between two lines there."""
COMPILING = "compiling, once"
_RECENT_S = 15.0
"""The longest that one kernel takes on a busy machine."""


@contextmanager
def shown(quiet: bool) -> Iterator[Progress]:
    """A Progress that says on standard error what is being tried, how many are done, and the time that is left.

    It keeps a copy of the stream, since the work diverts what libraries print. Silent when ``quiet``, and where
    standard error is closed or no file.
    """
    stream = None if quiet else _copy()
    if stream is None:
        yield SILENT
        return
    drawn = _bar if stream.isatty() else _lines
    with stream, drawn(stream) as told:
        yield told


def _copy() -> TextIO | None:
    try:
        return os.fdopen(os.dup(sys.stderr.fileno()), "w", errors="backslashreplace")
    except (OSError, ValueError, AttributeError):
        return None


@contextmanager
def _lines(stream: TextIO) -> Iterator[Progress]:
    pace, compiling = Pace(), _Compiling()

    def say() -> None:
        compiling.look()
        line = pace.line() + compiling.said
        if line:
            with suppress(OSError):  # a reader that is gone is no reason to fail
                stream.write(f"harness: {visible(line)}\n")
                stream.flush()

    with _after(UNSEEN_S, say, EVERY_S):
        yield pace.tell


@contextmanager
def _bar(stream: TextIO) -> Iterator[Progress]:
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    pace, compiling = Pace(), _Compiling()
    bar = Bar(
        TextColumn("{task.description}", markup=False),
        BarColumn(16),
        TimeElapsedColumn(),
        console=Console(file=stream, force_terminal=True),
        transient=True,
        redirect_stdout=False,
        redirect_stderr=False,
    )
    task = bar.add_task("", total=None)

    def tell(step: str, done: int, total: int) -> None:
        pace.tell(step, done, total)
        bar.update(task, description=visible(pace.line() + compiling.said), completed=done, total=total or None)

    def draw() -> None:
        compiling.look()
        bar.update(task, description=visible(pace.line() + compiling.said))
        bar.start()

    try:
        with _after(PATIENCE_S, draw, PATIENCE_S):
            yield tell
    finally:
        bar.stop()


class _Compiling:
    """Whether kernels were compiled a moment ago, since the work began, by whichever of its processes.

    said : what to add to a line, "" where none were when it last looked.
    """

    def __init__(self) -> None:
        self._folder = cache_folder()
        self._began = time.time()
        self.said = ""

    def look(self) -> None:
        recent = newest(self._folder) > max(self._began, time.time() - _RECENT_S)
        self.said = f" ({COMPILING})" if recent else ""


@contextmanager
def _after(wait_s: float, action: Callable[[], None], again_s: float | None = None) -> Iterator[None]:
    """Call ``action`` once after a while, and then again and again where ``again_s`` says so, until the block ends."""
    over = threading.Event()

    def watch() -> None:
        wait: float | None = wait_s
        while wait is not None and not over.wait(wait):
            action()
            wait = again_s

    thread = threading.Thread(target=watch, daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
