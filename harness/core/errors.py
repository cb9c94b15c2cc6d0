"""Errors for people: what was found, where, and what would be accepted."""

from harness.core.visible import visible

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
    accepted : what would have been accepted.
    """

    exit_code = 2

    def __init__(self, where: str, found: str, accepted: str) -> None:
        found = found if len(found) <= _LONGEST else f"{found[:_LONGEST]}..."
        super().__init__(f"{where}: {found}; {accepted}")
        self.where, self.found, self.accepted = where, found, accepted

    def __reduce__(self) -> tuple[type["InputError"], tuple[str, str, str]]:
        # the default would replay the joined text into a three-argument constructor
        return type(self), (self.where, self.found, self.accepted)


class SimulationError(HarnessError):
    """A run that could not be completed (diverged, unsupported); the row or file it belongs to says why."""


class StoreError(HarnessError):
    """A result that could not be written: full disk, no permission, path taken."""

    exit_code = 2
