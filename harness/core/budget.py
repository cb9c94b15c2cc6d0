"""How much a search may cost, counted in the work of its simulations and not in time: it ends at the same place on
every machine, with however many threads.

A piece of work that runs beside others may take a share of what is left when they begin, whatever the others take.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import TypeVar

from harness.core.errors import SimulationError

A_SECOND = 1_000_000
"""Work that a processor of 2024 does in about a second: steps of the integrator, each with some sensitivities."""
USUAL = 120.0
"""Seconds that a search may cost where nobody says."""
_OVER_EVEN = 4
"""Times its even share that one of several pieces of work may take: few are long."""

T = TypeVar("T")
R = TypeVar("R")


@dataclass(slots=True)
class Budget:
    """Work that may be done, that was done, and whether something was left undone for it."""

    most: float
    spent: int = 0
    ended: bool = False

    @classmethod
    def of_seconds(cls, seconds: float) -> "Budget":
        """What takes about so long, s of a processor."""
        return cls(seconds * A_SECOND)

    @property
    def left(self) -> float:
        """Work that may still be done."""
        return max(self.most - self.spent, 0.0)


_GIVEN: ContextVar[Budget | None] = ContextVar("given", default=None)
_COUNTED: ContextVar[Budget | None] = ContextVar("counted", default=None)


@contextmanager
def given(budget: Budget) -> Iterator[None]:
    """Searches within may cost this much together."""
    token = _GIVEN.set(budget)
    try:
        yield
    finally:
        _GIVEN.reset(token)


@contextmanager
def counted() -> Iterator[None]:
    """Count what is simulated within against the budget given, and end it where that is used up."""
    token = _COUNTED.set(_COUNTED.get() or _GIVEN.get())
    try:
        yield
    finally:
        _COUNTED.reset(token)


def allowed(most: int) -> int:
    """Work that one simulation may do, at most ``most``. Raises SimulationError where nothing is left."""
    budget = _COUNTED.get()
    if budget is None:
        return most
    if budget.left <= 0.0:
        budget.ended = True
        raise SimulationError("the budget of the search is used up")
    return int(min(most, budget.left + 1.0))


def spend(work: int) -> None:
    """Count work that was done."""
    budget = _COUNTED.get()
    if budget is not None:
        budget.spent += work
        budget.ended |= budget.spent > budget.most


def in_parts(work: Callable[[T], R], count: int) -> tuple[Callable[[T], R], Callable[[], None]]:
    """``work`` as one of so many pieces beside one another, and what counts all of it once they are done."""
    whole = _COUNTED.get()
    if whole is None:
        return work, lambda: None
    most, parts = whole.left * min(1.0, _OVER_EVEN / max(count, 1)), []

    def piece(item: T) -> R:
        part = Budget(most)
        parts.append(part)
        token = _COUNTED.set(part)
        try:
            return work(item)
        finally:
            _COUNTED.reset(token)

    def done() -> None:
        whole.spent += sum(part.spent for part in parts)
        whole.ended |= any(part.ended for part in parts)

    return piece, done
