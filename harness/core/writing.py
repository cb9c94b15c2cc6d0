"""A file appears whole or not at all, and what a process that was killed has left half-written is removed."""

import errno
import fcntl
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from harness.core.errors import StoreError

PARTIAL = ".partial"
_OURS = re.compile(r"\.(.+)\.[a-z0-9_]{8}\.partial", re.DOTALL)
"""What ``tempfile`` makes of the names below."""


@contextmanager
def explained(path: Path | str) -> Iterator[None]:
    """Turn an OSError inside the block into a StoreError of one line that names ``path``."""
    try:
        yield
    except OSError as error:
        raise StoreError(f"{path}: {reason(error)}") from error


def reason(error: OSError) -> str:
    """What a person reads of an OSError while something is written: what is wrong, and what is expected."""
    accepted = {
        errno.ENOSPC: "no space left on the device; free some or name another place",
        errno.EDQUOT: "the disk quota is used up; free some or name another place",
        errno.EACCES: "no permission to write; expected a folder that can be written",
        errno.EPERM: "no permission to write; expected a folder that can be written",
        errno.EROFS: "a read-only file system; expected a folder that can be written",
        errno.ENOTDIR: "a file stands where a folder is needed; expected another name",
        errno.EEXIST: "a file stands where a folder is needed; expected another name",
        errno.EISDIR: "a folder stands where a file is needed; expected another name",
        errno.ENOENT: "no such folder; expected an existing one",
        errno.ENAMETOOLONG: "the name is too long; expected a shorter one",
    }
    text = error.strerror or str(error)
    return accepted.get(error.errno or 0, f"cannot be written ({text}); expected another place")


@contextmanager
def replacing(path: Path, mode: int | None = None) -> Iterator[Path]:
    """Yield an empty file beside ``path`` to write to; it takes the name ``path`` when the block ends without an error.

    mode : permissions, None for those of any new file. Raises StoreError; nothing half-written is left.
    """
    with explained(path):
        sweep(path.parent, path.name)
        part, handle = _held(lambda: tempfile.mkstemp(prefix=f".{path.name}.", suffix=PARTIAL, dir=path.parent))
        try:
            yield part
            os.fsync(handle)
            part.chmod(0o666 & ~umask() if mode is None else mode)
            os.replace(part, path)
        finally:
            with suppress(OSError):
                part.unlink()
            os.close(handle)


def partial_folder(path: Path) -> tuple[Path, int]:
    """A new folder beside ``path``, and the descriptor that marks it as in use until it is closed; raises OSError."""

    def made() -> tuple[int, str]:
        name = tempfile.mkdtemp(prefix=f".{path.name}.", suffix=PARTIAL, dir=path.parent)
        return os.open(name, os.O_RDONLY), name

    folder, handle = _held(made)
    folder.chmod(0o777 & ~umask())
    return folder, handle


def _held(make: Callable[[], tuple[int, str]]) -> tuple[Path, int]:
    """Make something and mark it as in use; the system takes the mark away when the process ends, however it does."""
    while True:
        handle, name = make()
        with suppress(OSError):  # a file system without locks: nothing there is ever taken for left over
            fcntl.flock(handle, fcntl.LOCK_EX)
        if os.path.exists(name):
            return Path(name), handle
        os.close(handle)  # another process took it for left over before it was marked


def sweep(folder: Path, name: str | None = None) -> list[str]:
    """Remove what nobody writes to any more, of the target ``name`` or of all; the names of the targets."""
    swept = []
    with suppress(OSError):
        for entry in os.scandir(folder):
            found = _OURS.fullmatch(entry.name)
            if found and (name is None or found[1] == name) and _left_over(entry):
                path = Path(entry.path)
                if entry.is_dir(follow_symlinks=False):
                    shutil.rmtree(path, ignore_errors=True)
                else:
                    with suppress(OSError):
                        path.unlink()
                swept.append(found[1])
    return swept


def _left_over(entry: "os.DirEntry[str]") -> bool:
    """Whether this is ours and no living process holds it."""
    try:
        about = entry.stat(follow_symlinks=False)
        if entry.is_symlink() or about.st_uid != os.geteuid():
            return False
        handle = os.open(entry.path, os.O_RDONLY | os.O_NOFOLLOW)
    except OSError:
        return False
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return True
    except OSError:
        return False
    finally:
        os.close(handle)


def umask() -> int:
    """The mask of new files' permissions."""
    mask = os.umask(0o022)
    os.umask(mask)
    return mask
