"""What a page is made of."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Section:
    """A part of a page: its heading, and in the table of contents; a template and what that shows.

    template : a file in ``templates``, filled with ``context``; ``macros.html.j2`` shows tables and figures.
    """

    title: str
    template: str
    context: Mapping[str, Any]
