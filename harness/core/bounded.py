"""Files read within bounds: their size is known, or counted, before it is taken into memory."""

import gzip
import json
import os
import zlib
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import Any, BinaryIO

from harness.core.errors import TRY, InputError, did_you_mean

MEBIBYTE = 1 << 20
MOST_BYTES = 1024 * MEBIBYTE
"""Of a recording as text, unpacked: ten million samples of five channels take less."""
MOST_DOCUMENT_BYTES = 64 * MEBIBYTE
"""Of a JSON document."""
MODELS = (".xml", ".mjcf", ".urdf", ".sdf")
"""Endings of a robot's model or a scene."""
_MOST_BESIDE = 1000
"""Names of a folder that a mistyped one is compared with."""
_RESULT = "result.json"
"""In every folder of results."""
_PIECE = 4 * MEBIBYTE
_MOST_DIGITS = 1000
_POINTER = b"version https://git-lfs"
"""Begins what a clone holds in place of a large file."""


def check_file(
    path: Path,
    where: str = "",
    accepted: str = "a file that can be read",
    suffixes: tuple[str, ...] = (),
    several: bool = False,
) -> None:
    """Raise InputError, about ``where`` or the path itself, for a path that is no file.

    suffixes : of files that are proposed in place of a folder, () for any. several : all of one kind are. It loads
    nothing: a mistyped name is refused
    before a program loads what it would read the file with.
    """
    if path.is_dir():
        files = _inside(path, suffixes)
        near = files[0] if files else ""
        if several and len(alike := [one for one in files if Path(one).suffix == Path(near).suffix]) > 1:
            near = f"{path}/*{Path(alike[0]).suffix}"
        end = f"{'a file' if accepted.startswith(TRY) else accepted}; did you mean {near}?" if files else accepted
        raise InputError(where or str(path), "a folder", end)
    if not path.is_file():
        raise InputError(where or str(path), "no such file", accepted + _near(path))
    with suppress(OSError), path.open("rb") as file:  # what cannot be opened is told where it is read
        if file.read(len(_POINTER)) == _POINTER:
            raise InputError(where or str(path), "a pointer of Git LFS in place of the data", f"{TRY}git lfs pull")


def _inside(folder: Path, suffixes: tuple[str, ...]) -> list[str]:
    """Files in a folder that may be meant by it; none where it is one of results, whose tables are no recordings."""
    files = sorted(one.path for one in islice(os.scandir(folder), _MOST_BESIDE) if one.is_file())
    if not suffixes and str(folder / _RESULT) in files:
        return []
    shown = [one for one in files if not Path(one).name.startswith(".")]
    return [one for one in shown if one.lower().endswith(suffixes)] if suffixes else shown


def _near(path: Path) -> str:
    """The end of a message with the file beside ``path`` whose name is nearest to its own."""
    try:
        beside = [one.name for one in islice(os.scandir(path.parent), _MOST_BESIDE) if one.is_file()]
    except (OSError, ValueError):
        return ""
    # by names: of paths that have a long folder in common all are near
    return did_you_mean(path.name, beside, str(path.with_name("_"))[:-1])


def check_size(path: Path, most: int) -> None:
    """Raise InputError for a file of more than ``most`` bytes, OSError for none."""
    size = path.stat().st_size
    if size > most:
        raise _too_large(path, f"{size} bytes", most)


def read_bytes(path: Path, most: int = MOST_BYTES) -> bytes:
    """The content of a file. Raises InputError when it cannot be read or holds more than ``most`` bytes."""
    try:
        check_size(path, most)
        with path.open("rb") as file:
            size = os.fstat(file.fileno()).st_size
            data = file.read(size + 1)
            if len(data) > size:  # a file that grows meanwhile, or one whose size the system does not say
                data += file.read(most + 1 - len(data))
    except OSError as error:
        raise InputError(str(path), error.strerror or "cannot be read", "a file that can be read") from None
    if len(data) > most:
        raise _too_large(path, f"more than {most} bytes", most)
    return data


def unpacked(path: Path, file: BinaryIO, most: int = MOST_BYTES) -> bytearray:
    """The content of a gzip stream of the file ``path``, counted while it is unpacked.

    Raises InputError when it is damaged or holds more than ``most`` bytes.
    """
    data = bytearray()
    try:
        with gzip.GzipFile(fileobj=file) as stream:
            while piece := stream.read(_PIECE):
                data += piece
                if len(data) > most:
                    raise _too_large(path, f"more than {most} bytes, unpacked", most)
    except (OSError, EOFError, zlib.error) as error:
        raise InputError(str(path), f"unreadable ({error})", "a whole gzip file") from None
    return data


def _too_large(path: Path, found: str, most: int) -> InputError:
    return InputError(str(path), found, f"at most {most}")


def parse_json(text: str | bytes | bytearray) -> Any:
    """``json.loads`` that raises ValueError, and nothing else, for whatever it cannot read.

    NaN and the infinities, which are no JSON, are refused; so is what is nested too deeply.
    """
    try:
        return json.loads(text, parse_constant=_no_constant, parse_int=_integer)
    except RecursionError:
        raise ValueError("nested too deeply") from None


def _integer(digits: str) -> int:
    if len(digits) > _MOST_DIGITS:
        raise ValueError(f"a number of {len(digits)} digits")
    return int(digits)


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is not a number of JSON")
