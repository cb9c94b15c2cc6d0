"""The entry point: finds the commands, and turns every failure into one line and an exit code."""

import io
import logging
import os
import pkgutil
import signal
import sys
import threading
import time
import traceback
from collections.abc import Sequence
from contextlib import suppress
from datetime import datetime
from importlib import import_module
from types import FrameType
from typing import Any, NoReturn

import click
from click.shell_completion import shell_complete

from harness.cli import commands
from harness.cli.output import typed
from harness.cli.remedy import whole_line
from harness.core import __version__
from harness.core.cores import one_thread
from harness.core.errors import HarnessError, InputError, did_you_mean, visible
from harness.core.registered import names, registered

INTERRUPTED = 130
NOTHING_WRITTEN = "interrupted; nothing was written"
_GRACE = 1.5
"""Seconds in which a command may end by itself, and keep what it has done."""
_SIGNALS = frozenset({signal.SIGINT, signal.SIGTERM})

told = threading.Event()
"""Set once a person has read how the command ended."""


def heed() -> None:
    """Take both signals for an interruption from now on; only the main thread may, and elsewhere nothing is done."""
    if threading.current_thread() is not threading.main_thread():
        return
    signal.signal(signal.SIGTERM, _interrupted)
    here, there = os.pipe()
    os.set_blocking(there, False)
    signal.set_wakeup_fd(there, warn_on_full_buffer=False)
    threading.Thread(target=_wait, args=(here,), name="interrupt", daemon=True).start()


def _interrupted(signum: int, frame: FrameType | None) -> NoReturn:
    raise KeyboardInterrupt


def _wait(pipe: int) -> None:
    """End this process some time after an interruption was heard."""
    while not _SIGNALS.intersection(os.read(pipe, 64)):
        pass
    time.sleep(_GRACE)
    from multiprocessing import active_children

    for child in active_children():
        child.kill()
    if "harness.io.store" in sys.modules:
        sys.modules["harness.io.store"].abandon()
    if not told.is_set():
        with suppress(OSError):
            os.write(2, f"harness: {NOTHING_WRITTEN}\n".encode())
    os._exit(INTERRUPTED)


COMPLETION = "_HARNESS_COMPLETE"
"""The variable by which a shell asks for completions, or for the script that makes it ask; its name is click's."""

GROUP = "harness.commands"
"""Of the entry points by which other packages add commands ("package.module:command")."""

_MOST_OF_ERRORS = 1_000_000
"""Bytes of tracebacks after which a file is put aside, in place of the one before."""


def _own() -> list[str]:
    return [found.name for found in pkgutil.iter_modules(commands.__path__)]


class Commands(click.Group):
    """The commands, each imported when it is asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of the files in harness.cli.commands, and of the entry points of other packages."""
        return sorted({*_own(), *names(GROUP)})

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The ``command`` of the file of that name, else the one another package registered; ours go first."""
        if cmd_name in _own():
            command: click.Command = import_module(f"harness.cli.commands.{cmd_name}").command
            return command
        return next((found for _, found in registered(GROUP, click.Command, "command", cmd_name)), None)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """As click does it, with the commands there are in the message."""
        if args and not args[0].startswith("-") and self.get_command(ctx, args[0]) is None:
            known = self.list_commands(ctx)
            near = did_you_mean(args[0], known)
            ctx.fail(f"command '{args[0]}': no such command; expected one of {', '.join(known)}{near}")
        return super().resolve_command(ctx, args)


@click.group(
    cls=Commands,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
@click.version_option(__version__, prog_name="harness")
def cli() -> None:
    """Cross-validation of dry friction: exact reference, MuJoCo, PyBullet, and your own recording.

    \b
    Example: harness run
    """


def main(args: Sequence[str] | None = None) -> NoReturn:
    """Run the command and leave with its exit code.

    0 done; 1 a check failed; 2 bad input or usage, with one line on standard error; 130 interrupted.
    """
    for descriptor in (0, 1, 2):  # where one is closed, no file of ours is to be taken for a standard stream
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest that is free
    one_thread()
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout = _heard(sys.stdout)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a locale without the letter in question shows its number
            stream.reconfigure(errors="backslashreplace")
    logging.captureWarnings(True)  # what libraries warn of goes to the log, where one is kept
    heed()
    sys.exit(run(args))


class _WhileHeard(io.FileIO):
    """A stream whose reader may go: what it wanted (``| head``) it has, and the command ends as it would have."""

    def write(self, data: Any, /) -> int:
        try:
            return super().write(data)
        except BrokenPipeError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), self.fileno())
            return memoryview(data).nbytes


def _heard(stream: io.TextIOWrapper) -> io.TextIOWrapper:
    """The same stream, its buffer and letters, which outlives its reader."""
    raw = _WhileHeard(stream.fileno(), "w", closefd=False)
    return io.TextIOWrapper(
        io.BufferedWriter(raw),
        stream.encoding,
        line_buffering=stream.line_buffering,
        write_through=stream.write_through,
    )


def run(args: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code; nothing but SystemExit from Python itself passes through."""
    try:
        line = list(sys.argv[1:] if args is None else args)
        if asked := os.environ.get(COMPLETION):
            return shell_complete(cli, {}, "harness", COMPLETION, asked)
        typed(line)
        _check_names(line)
        # not cli.main, which prints an empty line of its own when it is interrupted
        with cli.make_context("harness", line or ["--help"]) as ctx:
            code = cli.invoke(ctx)
        if sys.stdout is not None:  # None when the process was started with it closed
            sys.stdout.flush()
    except click.exceptions.Exit as left:
        return left.exit_code
    except OSError as error:
        return _stream(error)
    except (Exception, KeyboardInterrupt) as error:
        return _say(*_explained(error))
    return code if isinstance(code, int) else 0


def _check_names(line: Sequence[str]) -> None:
    """Refuse names of files that are no text: results are text, and hold them."""
    here = ""
    with suppress(OSError):  # a folder that was removed meanwhile
        here = os.getcwd()
    for name in (*line, here):
        try:
            name.encode()
        except UnicodeEncodeError:
            where = "the working folder" if name not in line else "argument"
            found = f"bytes that are no text in {sys.getfilesystemencoding()}"
            raise InputError(f"{where} {visible(name)}", found, "a name that is text") from None


def _explained(error: BaseException) -> tuple[str, int]:
    """The line a person reads and the exit code."""
    match error:
        case HarnessError() | click.UsageError():
            return whole_line(error, cli), error.exit_code
        case click.ClickException():
            return error.format_message(), error.exit_code
        case KeyboardInterrupt() | click.Abort():
            return NOTHING_WRITTEN, INTERRUPTED
    return f"internal error, {type(error).__name__}: {error}; the details are in {_details(error)}", 1


def _stream(error: OSError) -> int:
    """Standard output that is closed or full; anything else of the operating system's is told as it is."""
    with suppress(OSError):  # what is still buffered cannot be written either, and must not fail again at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.__stdout__.fileno() if sys.__stdout__ else 1)
    if isinstance(error, FileNotFoundError) and error.filename is None:
        return _say("the working folder: it was removed; expected a folder that is there", 2)
    where = f"{error.filename}: " if error.filename else "output: "
    return _say(f"{where}{error.strerror or error}; expected another place", 2)


def _say(text: str, code: int) -> int:
    told.set()
    with suppress(OSError):
        click.echo("harness: " + visible(" ".join(text.split())), err=True)
    return code


def _details(error: BaseException) -> str:
    """Write the traceback that no user should have to see to the end of a file that stays small."""
    from platformdirs import user_state_path

    try:
        file = user_state_path("friction-harness", ensure_exists=True) / "errors.log"
        if file.exists() and file.stat().st_size > _MOST_OF_ERRORS:
            file.replace(file.with_suffix(".old.log"))
        with file.open("a", encoding="utf-8", errors="backslashreplace") as log:
            log.write(f"{datetime.now().astimezone().isoformat(timespec='seconds')} {visible(' '.join(sys.argv))}\n")
            traceback.print_exception(error, file=log)
        return str(file)
    except OSError as unwritten:
        return f"no file ({unwritten.strerror}: {unwritten.filename})"
