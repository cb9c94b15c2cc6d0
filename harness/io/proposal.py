"""Other ways to read a file that is refused as it stands, tried on it before anybody is told of them.

A refusal carries the ways on that its place knows of; they are tried, together where one leads to the next, and only
options with which the file has been read are printed.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from harness.core.errors import InputError
from harness.io.options import ReadOptions

_DEPTH, _TRIES = 4, 12
"""Options given together at most, and readings of one file."""


class RefusedError(InputError):
    """Bad input that may be read otherwise. others : options that replace those given, best first."""

    def __init__(self, where: str, found: str, accepted: str, others: Sequence[Mapping[str, Any]] = ()) -> None:
        super().__init__(where, found, accepted)
        self.others = tuple(others)


def tried(error: InputError, options: ReadOptions, read: Callable[[ReadOptions], object]) -> InputError:
    """The error, ended by options with which ``read`` succeeds; as it is where none of its ways leads there."""
    if not isinstance(error, RefusedError):
        return error
    found = _first(error, options, read, [_TRIES], _DEPTH)
    end = error.accepted if found is None else f"try: {found.pasted}"
    return InputError(error.where, error.found, end)


def _first(
    error: RefusedError, options: ReadOptions, read: Callable[[ReadOptions], object], left: list[int], depth: int
) -> ReadOptions | None:
    """The first options, of those that a refusal and what follows it propose, that read the file. left : readings."""
    for other in error.others:
        candidate = replace(options, **other)
        if candidate == options or not depth or not left[0]:
            continue
        left[0] -= 1
        try:
            read(candidate)
        except RefusedError as further:
            found = _first(further, candidate, read, left, depth - 1)
            if found is not None:
                return found
        except InputError:
            continue
        else:
            return candidate
    return None
