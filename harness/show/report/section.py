"""What a page is made of."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar


class Section(ABC):
    """A part of a page: a template and what it is filled with.

    template : a file in ``templates``. title : its heading and its entry in the table of contents.
    Templates get ``section`` and the names of ``context``; the macros of ``macros.html.j2`` show tables and figures.
    """

    template: ClassVar[str]

    @property
    @abstractmethod
    def title(self) -> str:
        """The heading."""

    @abstractmethod
    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
