"""The catalogue by name: every Term in a module of harness.model.terms, then those that other packages register.

A package adds a term by an entry point of group ``harness.terms`` whose value is the Term ("package.module:TERM").
"""

import copyreg
import importlib
import pkgutil
from collections.abc import Iterator

from harness.core.errors import InputError, did_you_mean
from harness.core.registered import registered
from harness.model import terms
from harness.model.term import Slot, Term

GROUP = "harness.terms"


def _own() -> Iterator[Term]:
    """The terms of the house, module by module."""
    for found in pkgutil.iter_modules(terms.__path__):
        module = importlib.import_module(f"{terms.__name__}.{found.name}")
        yield from (value for value in vars(module).values() if isinstance(value, Term))


def _catalogue() -> dict[str, Term]:
    """Every term by its key, in an order that does not hang on where it was found."""
    by_key: dict[str, Term] = {}
    for found in sorted((*_own(), *(t for _, t in registered(GROUP, Term, "term"))), key=lambda t: t.order):
        if found.key in by_key:
            raise InputError(f"term {found.key}", "registered twice", "one")
        by_key[found.key] = found
    return by_key


_BY_KEY = _catalogue()
TERMS: tuple[Term, ...] = tuple(_BY_KEY.values())
NAMED: tuple[Term, ...] = tuple(t for t in TERMS if t.searched)
"""Those that are looked for; the others are tables, for what has no name, and most laws whose form is freed."""
USUAL: tuple[Term, ...] = tuple(t for t in NAMED if not t.frees)
"""Those in the catalogue's own form: what a name takes of a misfit that nothing explains is told by these."""


def forms_of(key: str) -> tuple[Term, ...]:
    """The laws that free the form of one."""
    return tuple(t for t in TERMS if t.frees == key)


def other_forms_of(key: str) -> tuple[Term, ...]:
    """Of a law whose form is free and that keeps the numbers of the one it frees, those that free this otherwise."""
    free = _BY_KEY[key]
    law = _BY_KEY[free.frees] if free.frees else None
    if law is None or free.names[: len(law.names)] != law.names:
        return ()
    return tuple(t for t in forms_of(law.key) if t.key != key)


def term(key: str) -> Term:
    """The term of this key ("end-stop", "end-stop:positive"); InputError lists the names there are."""
    found = _BY_KEY.get(key)
    if found is None:
        accepted = f"one of {', '.join(_BY_KEY)}{did_you_mean(key, _BY_KEY)}"
        raise InputError("term", f"{key!r} is not in the catalogue", accepted)
    return found


# there is one of each: between processes it goes by its key
copyreg.pickle(Term, lambda one: (term, (one.key,)))


def of_slot(slot: Slot) -> tuple[Term, ...]:
    """The terms of one slot, in catalogue order: the order of their numbers in the compiled dispatch."""
    return tuple(t for t in TERMS if t.slot is slot)


def not_parted(one: str, other: str) -> bool:
    """Whether two names of the catalogue say of each other that it takes another recording to tell them apart."""
    return any({t.name, name} == {one, other} for t in TERMS for name in t.told_from)
