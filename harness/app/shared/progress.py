"""How a use case tells how far it is; light, since the command imports it."""

from collections.abc import Callable
from typing import TypeAlias

Progress: TypeAlias = Callable[[str, int, int], None]
"""Called with what is being done, how many steps are done, and how many there are."""


def SILENT(step: str, done: int, total: int) -> None:  # noqa: N802  (a constant that is called)
    """A Progress that says nothing."""
