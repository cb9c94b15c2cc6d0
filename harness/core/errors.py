"""Errors that are told to a person in one line, and what makes such a line plain: what was meant, what can be seen."""

import unicodedata
from collections.abc import Iterable, Sequence
from pathlib import PurePath

TRY = "try: "
"""Begins what is to be pasted: a command, or options of the one that was given."""
_LONGEST = 400
"""Characters of what was found that a message repeats."""


class HarnessError(Exception):
    """Anything this program reports to a person. Its text is exactly one line that a terminal shows as it is."""

    exit_code = 1

    def __str__(self) -> str:
        return visible(" ".join(super().__str__().split()))


class InputError(HarnessError):
    """Bad input or usage.

    Parameters
    ----------
    where : the file, line, option or field that is wrong.
    found : what stood there.
    accepted : what was expected there, as a noun; "it goes with ..."; or "try: " and a line or options to paste.
    """

    exit_code = 2

    def __init__(self, where: str, found: str, accepted: str) -> None:
        found = found if len(found) <= _LONGEST else f"{found[:_LONGEST]}..."
        super().__init__(f"{where}: {found}{_end(accepted)}")
        self.where, self.found, self.accepted = where, found, accepted

    def __reduce__(self) -> tuple[type["InputError"], tuple[str, str, str]]:
        # the default would replay the joined text into a three-argument constructor
        return type(self), (self.where, self.found, self.accepted)


def _end(accepted: str) -> str:
    """What a message ends with, by what was expected."""
    if accepted.startswith(TRY):
        return f". T{accepted[1:]}"
    return f"; {accepted}" if accepted.startswith("it ") else f"; expected {accepted}"


class SimulationError(HarnessError):
    """A run that could not be completed (diverged, unsupported); the row or file it belongs to says why."""


class NoDeviceError(SimulationError):
    """A run that was asked of a device that this machine does not have."""


class StoreError(HarnessError):
    """A result that could not be written: full disk, no permission, path taken."""

    exit_code = 2


def did_you_mean(name: str, known: Iterable[str], before: str = "") -> str:
    """The end of a message, "; did you mean NAME?", with the known name nearest to ``name``; "" where none is near.

    before : what the name is written behind, as a file's is behind its folder.
    """
    from difflib import get_close_matches

    near = get_close_matches(name.lower(), list(known), n=1)
    return f"; did you mean {before}{near[0]}?" if near else ""


_KEPT = "\n\t"


def visible(text: str) -> str:
    """``text`` with every character that a terminal or an editor would obey, not show, as its escape.

    Those are control characters (ESC begins a command to the terminal), marks that turn the direction of writing, and
    the halves of characters that stand for bytes which are no UTF-8. New lines and tabs stay.
    """
    if text.isprintable():
        return text
    obeyed = {c for c in text if c not in _KEPT and unicodedata.category(c)[0] == "C"}
    return "".join(c.encode("unicode_escape").decode("ascii") if c in obeyed else c for c in text)


def short_names(files: Sequence[str]) -> dict[str, str]:
    """A name for each file: its own, with as many folders before it as tell it from the others."""
    every = {file: PurePath(file).parts for file in files}
    found = {}
    for file, parts in every.items():
        others = [one for one in every.values() if one != parts]
        least = (n for n in range(1, len(parts)) if all(one[-n:] != parts[-n:] for one in others))
        found[file] = str(PurePath(*parts[-next(least, len(parts)) :]))
    return found
