"""Progress on work over two seconds, where the terminal is one."""

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from harness.app.shared.progress import SILENT, Progress

PATIENCE_S = 2.0


@contextmanager
def shown(quiet: bool) -> Iterator[Progress]:
    """A Progress that draws a bar on standard error after two seconds; silent when that is no terminal.

    It keeps a copy of the stream, since the work diverts what libraries print.
    """
    if quiet or not sys.stderr.isatty():
        yield SILENT
        return
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    with os.fdopen(os.dup(sys.stderr.fileno()), "w") as terminal:
        bar = Bar(
            TextColumn("{task.description}"),
            BarColumn(),
            TimeElapsedColumn(),
            console=Console(file=terminal, force_terminal=True),
            transient=True,
            redirect_stdout=False,
            redirect_stderr=False,
        )
        task = bar.add_task("", total=None)
        timer = threading.Timer(PATIENCE_S, bar.start)
        timer.daemon = True
        timer.start()
        try:
            yield lambda step, done, total: bar.update(task, description=step, completed=done, total=total)
        finally:
            timer.cancel()
            timer.join()
            bar.stop()
