"""What long work says of itself while it goes on, to whoever listens; to nobody, and at no cost, where nobody does.

What is told changes nothing of what is computed, so it is no argument of what computes.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeAlias, TypeVar

T = TypeVar("T")
Listener: TypeAlias = Callable[[str, int, int], None]
"""Called with what is being tried, how many are done, and how many there are."""

_LISTENER: ContextVar[Listener | None] = ContextVar("listener", default=None)


@contextmanager
def listening(listener: Listener) -> Iterator[None]:
    """Hear what work says within the block, in this thread."""
    token = _LISTENER.set(listener)
    try:
        yield
    finally:
        _LISTENER.reset(token)


def told(items: Sequence[T], named: Callable[[T], str]) -> Iterator[T]:
    """The items in order; of each it is said, before its turn, what it is called and how many went before."""
    for done, item in enumerate(items):
        listener = _LISTENER.get()
        if listener is not None:
            listener(named(item), done, len(items))
        yield item
