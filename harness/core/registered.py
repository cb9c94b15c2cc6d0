"""What other installed packages add: the objects that their entry points name.

importlib.metadata is imported where it is used: it takes longer than all else that `harness --version` loads.
"""

from collections.abc import Iterator
from functools import cache
from typing import TYPE_CHECKING, TypeVar

from harness.core.errors import InputError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

T = TypeVar("T")


@cache
def points(group: str) -> "tuple[EntryPoint, ...]":
    """The entry points of a group by name, read once a process: reading opens a file of each package."""
    from importlib.metadata import entry_points

    return tuple(sorted(entry_points(group=group), key=lambda point: point.name))


def names(group: str) -> set[str]:
    """Names of the entry points of a group, whether they load or not."""
    return {point.name for point in points(group)}


def registered(group: str, kind: type[T], what: str, name: str | None = None) -> Iterator[tuple[str, T]]:
    """Name and object of every entry point of a group, or of those of one name; ``what`` is what a message calls one.

    Raises InputError for a package that does not load, and for an object that is no ``kind``.
    """
    for point in points(group):
        if name not in (None, point.name):
            continue
        try:
            found = point.load()
        except (ImportError, AttributeError, TypeError) as error:
            raise InputError(f"{what} {point.name}", f"{point.value}: {error}", "a package that loads") from error
        if not isinstance(found, kind):
            accepted = f"a {kind.__module__}.{kind.__qualname__}"
            raise InputError(f"{what} {point.name}", f"{point.value} is {found!r}", accepted)
        yield point.name, found


@cache
def version(package: str) -> str:
    """Version of an installed package; raises importlib.metadata.PackageNotFoundError for one that is not."""
    from importlib import metadata

    return metadata.version(package)
