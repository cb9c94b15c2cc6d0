"""Which rows of a matrix are run, and which are known to fail: patterns of rows' names."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase


@dataclass(frozen=True, slots=True)
class Pattern:
    """Part of a row's name ("dt=own/belt"), or a whole one with * and ? ("mujoco@*/hold-??"), and why it is given."""

    text: str
    why: str = ""

    @classmethod
    def of(cls, text: str) -> "Pattern":
        """From "PATTERN" or "PATTERN: WHY"."""
        pattern, _, why = text.partition(": ")
        return cls(pattern.strip(), why.strip())

    def matches(self, name: str) -> bool:
        """Whether a row of this name is meant."""
        return fnmatchcase(name, self.text) if set("*?") & set(self.text) else self.text in name


@dataclass(frozen=True, slots=True)
class Selection:
    """only : rows to run, all where it is empty. skip : rows that are neither run nor missed. xfail : known to fail."""

    only: tuple[Pattern, ...] = ()
    skip: tuple[Pattern, ...] = ()
    xfail: tuple[Pattern, ...] = ()

    @classmethod
    def of(cls, only: Iterable[str] = (), skip: Iterable[str] = (), xfail: Iterable[str] = ()) -> "Selection":
        """From patterns as they are typed."""
        chosen, skipped, failing = (tuple(map(Pattern.of, texts)) for texts in (only, skip, xfail))
        return cls(chosen, skipped, failing)

    def chosen(self, name: str) -> bool:
        """Whether a row is looked at, be it to skip it."""
        return not self.only or any(one.matches(name) for one in self.only)

    def skipped(self, name: str) -> str | None:
        """Why a row is skipped; None for one that is not."""
        return _why(self.skip, name)

    def expected(self, name: str) -> str | None:
        """Why a row is known to fail; None for one that is not."""
        return _why(self.xfail, name)

    def runs(self, name: str) -> bool:
        """Whether a row is run."""
        return self.chosen(name) and self.skipped(name) is None

    def unused(self, names: Sequence[str]) -> list[str]:
        """Patterns that mean no row of these."""
        every = (*self.only, *self.skip, *self.xfail)
        return [one.text for one in every if not any(map(one.matches, names))]


def _why(patterns: Iterable[Pattern], name: str) -> str | None:
    return next((one.why or f"pattern {one.text}" for one in patterns if one.matches(name)), None)
