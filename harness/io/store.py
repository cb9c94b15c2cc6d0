"""Writing results: beside first, then renamed, so that nothing half-written is ever seen under its own name."""

import errno
import fcntl
import os
import shlex
import shutil
import stat
import tempfile
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from harness.core.errors import StoreError
from harness.core.writing import explained, partial_folder, reason, replacing, sweep

DEFAULT_PARENT = "reports"
BEGUN = frozenset({"log.txt"})
"""What a growing folder may hold in which nothing was done yet: the process was killed before it got to it."""
PATIENCE_S = 5.0
"""Time in which what belonged to a process that was killed ends too."""


_NOT_WRITTEN = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS})
"""What no reading of a file ends in."""


class OutputFolder:
    """A folder that appears whole or not at all.

    final : where it will be, absolute; reserved from the start. work : where files are written until ``commit``.
    """

    def __init__(self, final: Path, made: tuple[Path, ...]) -> None:
        with explained(final):
            self.work, self._mark = partial_folder(final)
        self.final, self._made = final, made
        self.committed = False
        _OPEN.add(self)

    def __truediv__(self, name: str) -> Path:
        """The path under ``work`` to write a file to; its folder is made."""
        path = self.work / name
        with explained(self.final):
            path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def at(self, name: str) -> str:
        """The absolute path a file will have after ``commit``."""
        return str(self.final / name)

    def commit(self) -> None:
        """Rename everything into place; raises StoreError when the place was taken meanwhile."""
        try:
            os.rename(self.work, self.final)
        except OSError as error:
            taken = error.errno in (errno.ENOTEMPTY, errno.EEXIST)
            said = "another command has filled it meanwhile; expected a folder of its own" if taken else reason(error)
            raise StoreError(f"{self.final}: {said}") from error
        self.committed = True

    def close(self) -> None:
        """Without a commit, remove what was written and the folders that were made for it; nothing the second time."""
        if self not in _OPEN:
            return
        _OPEN.discard(self)
        os.close(self._mark)
        if self.committed:
            return
        shutil.rmtree(self.work, ignore_errors=True)
        for folder in self._made:
            with suppress(OSError):
                folder.rmdir()


_OPEN: set[OutputFolder] = set()
"""Folders that this process fills."""


def abandon() -> None:
    """Remove what is half-written, as this process ends where none of its own code is heard any more."""
    for folder in tuple(_OPEN):
        folder.close()


def clear(parent: Path) -> None:
    """Remove what processes that have ended left half-written in a folder, and the empty folders they had reserved."""
    for target in sweep(parent):
        with suppress(OSError):
            (parent / target).rmdir()


def _make(final: Path) -> tuple[Path, ...]:
    """Make a folder and its parents; return those that were not there, deepest first."""
    missing = [folder for folder in (final, *final.parents) if not folder.exists()]
    with explained(final):
        final.mkdir(parents=True, exist_ok=True)
    return tuple(missing)


def _reserve(name: str, out: Path | None, begun: frozenset[str] = frozenset()) -> tuple[Path, tuple[Path, ...]]:
    if out is not None:
        final = Path(os.path.abspath(out))
        made = _make(final)
        sweep(final.parent, final.name)
        with explained(final):
            taken = any(entry.name not in begun for entry in final.iterdir())
        if taken:
            raise StoreError(f"--out {out}: the folder holds files already; expected a new or empty one")
        return final, made
    parent = Path.cwd() / DEFAULT_PARENT
    stamp = f"{name}-{time.strftime('%Y%m%d-%H%M%S')}"
    try:
        made = _make(parent)
    except StoreError as error:
        elsewhere = shlex.quote(str(Path(tempfile.gettempdir()) / stamp))
        raise StoreError(f"{str(error).partition('; ')[0]}. Try: --out {elsewhere}") from error
    clear(parent)
    for attempt in range(1, 1000):
        final = parent / (stamp if attempt == 1 else f"{stamp}-{attempt}")
        try:
            final.mkdir()
        except FileExistsError:
            continue
        except OSError as error:
            raise StoreError(f"{final}: {reason(error)}") from error
        return final, (final, *made)
    raise StoreError(f"{parent}: no free name for {stamp}; name one with --out")


def growing_folder(name: str, out: Path | None = None) -> Path:
    """A folder that fills while work goes on and stays whatever happens: ``out``, or reports/NAME-TIME here.

    Raises StoreError when it cannot be made or holds files already.
    """
    return _reserve(name, out, BEGUN)[0]


@contextmanager
def held(folder: Path, patience_s: float = PATIENCE_S) -> Iterator[int]:
    """Have a growing folder for this call alone while the block runs; yields the descriptor that marks it.

    A process that inherits the descriptor holds the folder as well, until it ends. patience_s : how long to wait for
    another that holds it, s. Raises StoreError when that one goes on.
    """
    limit = time.monotonic() + patience_s
    with explained(folder):
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        while True:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                if time.monotonic() > limit:
                    raise StoreError(f"{folder}: another process works in it; expected a folder of its own") from None
                time.sleep(0.05)
                continue
            except OSError:  # a file system without locks
                pass
            break
        yield handle
    finally:
        os.close(handle)


@contextmanager
def output_folder(name: str, out: Path | None = None) -> Iterator[OutputFolder]:
    """An output folder: ``out``, or reports/NAME-TIME here; committed by the caller, else removed without a trace.

    Raises StoreError when it cannot be made or holds files already. An OSError of writing inside the block becomes
    a StoreError too.
    """
    final, made = _reserve(name, out)
    try:
        output = OutputFolder(final, made)
    except BaseException:
        for folder in made:
            with suppress(OSError):
                folder.rmdir()
        raise
    try:
        yield output
    except StoreError as error:
        # the name people know, not that of the work in progress
        raise StoreError(str(error).replace(str(output.work), str(final))) from error
    except OSError as error:
        if error.errno in _NOT_WRITTEN:
            raise StoreError(f"{final}: {reason(error)}") from error
        raise
    finally:
        output.close()


def check_writable(path: Path) -> None:
    """Raise StoreError now when ``path`` could not be written later."""
    with explained(path):
        if path.exists():
            if path.is_dir():
                raise IsADirectoryError(errno.EISDIR, "is a folder")
            with path.open("ab"):
                return
        with tempfile.TemporaryFile(dir=path.parent):
            return


def write_text(path: Path, text: str | Iterable[str]) -> None:
    """Write a file whole or not at all; a device or pipe is written to directly.

    text : or pieces of it, which are written as they come. Raises StoreError when it cannot be written.
    """
    pieces = [text] if isinstance(text, str) else text
    with explained(path):
        if path.exists() and not stat.S_ISREG(path.stat().st_mode):
            with path.open("w", encoding="utf-8") as there:
                there.writelines(pieces)
            return
    with replacing(path) as part, part.open("w", encoding="utf-8") as file:
        file.writelines(pieces)
