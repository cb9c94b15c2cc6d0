"""The laws that the generated dispatch calls, compiled; a dispatch that was written for other terms is refused."""

from collections.abc import Callable

from harness.core.errors import InputError
from harness.core.jit import compiled
from harness.model.term import Term


def laws(terms: tuple[Term, ...], *keys: str) -> tuple[Callable[..., None], ...]:
    """The compiled laws of ``terms``, which the dispatch numbers as ``keys``.

    Raises InputError when the two differ: a term was installed or taken away since the dispatch was written.
    """
    here = [term.key for term in terms]
    if here != list(keys):
        parts = [("without", set(here) - set(keys)), ("with", set(keys) - set(here))]
        found = ", ".join(f"{word} {', '.join(sorted(some))}" for word, some in parts if some) or "in another order"
        accepted = "what python -m harness.kernels.generate writes"
        raise InputError("harness/kernels/dispatch.py", f"written {found}", accepted)
    return tuple(compiled(term.law, lean=True) for term in terms if term.law is not None)
