"""Writing a file whole or not at all."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from harness.core.errors import StoreError


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a path beside ``path`` to write to; it takes the name ``path`` when the block ends without an error.

    Raises StoreError when the folder cannot be written or the disk is full; nothing half-written is left.
    """
    part = path.with_name(f".{path.name}.part-{os.getpid()}")
    try:
        yield part
        os.replace(part, path)
    except OSError as error:
        reason = error.strerror or str(error)
        raise StoreError(
            f"{path}: {reason}; a folder that can be written, with room on its disk, is accepted"
        ) from error
    finally:
        with suppress(OSError):
            part.unlink()
