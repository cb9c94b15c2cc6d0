"""What is known of a format of recordings; a file in harness/io/readers makes one."""

from collections.abc import Callable
from dataclasses import dataclass

from harness.io.table import Table


@dataclass(frozen=True, slots=True, kw_only=True)
class Reader:
    """A format of recordings.

    name : as messages say it. suffixes : of its files, in small letters, with the dot. open : from the path (and, for
    text, the lines to skip before the header) to its columns; raises InputError for a file that is none of this format.
    text : whether it is a table of lines. Such a file may be packed with gzip and is read in this process, so that
    ``open`` must bear whatever is in it; any other is read in a process of its own (harness.core.apart).
    """

    name: str
    suffixes: tuple[str, ...]
    open: Callable[..., Table]
    text: bool = False

    @property
    def said(self) -> str:
        """Name and suffixes."""
        return f"{self.name} ({', '.join(self.suffixes)})"
