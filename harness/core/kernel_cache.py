"""Where compiled kernels are kept; light, since a command that only waits for them asks it too.

Numba's cache is code, and its index files are pickles: whoever can write to it can run a program as the user. A folder
is used only if it is the user's own and nobody else can write to it.
"""

import atexit
import os
import shutil
import stat
from contextlib import suppress
from pathlib import Path


def _private(folder: Path) -> bool:
    """Whether a folder, made if need be, is the user's own, closed to the writing of others, and can be written."""
    import tempfile

    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        about = folder.lstat()
        if not stat.S_ISDIR(about.st_mode) or about.st_uid != os.geteuid() or about.st_mode & 0o022:
            return False
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def cache_folder() -> Path:
    """The folder in which compiled kernels are kept; made if need be.

    NUMBA_CACHE_DIR, else one in the user's cache, else one in the temporary folder; the first that is private. Where
    none is, one of this process alone, removed at its end.
    """
    import tempfile

    from platformdirs import user_cache_path

    named = os.environ.get("NUMBA_CACHE_DIR")
    own = Path(tempfile.gettempdir()) / f"friction-harness-{os.geteuid()}"
    for folder in (*([Path(named)] if named else []), user_cache_path("friction-harness") / "kernels", own):
        if _private(folder):
            return folder
    folder = Path(tempfile.mkdtemp(prefix="friction-harness-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def newest(folder: Path) -> float:
    """When the last kernel was put into it, as a file's time [s]; 0 where there is none."""
    last = 0.0
    for file in folder.rglob("*.nbc"):
        with suppress(OSError):  # another process may be putting it there
            last = max(last, file.stat().st_mtime)
    return last
