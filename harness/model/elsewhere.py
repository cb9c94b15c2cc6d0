"""The same slider in another recording: what it has of its own there; "x0#2" of the second, "k#3" of the third."""

from dataclasses import dataclass

_MARK = "#"


@dataclass(frozen=True, slots=True)
class Elsewhere:
    """Base parameters with values of their own in another recording; the others are the model's.

    values : by name ("x0", "v0", "offset", "k"), SI.
    """

    values: tuple[tuple[str, float], ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """What it has of its own."""
        return tuple(name for name, _ in self.values)

    def value(self, name: str) -> float:
        """The value of one of its own."""
        return dict(self.values)[name]

    def having(self, **values: float) -> "Elsewhere":
        """The same with these values for some of its own, or with further ones."""
        return Elsewhere(tuple({**dict(self.values), **values}.items()))


def named(stem: str, recording: int) -> str:
    """What a base parameter is called in a recording, 0 being the first."""
    return stem if recording == 0 else f"{stem}{_MARK}{recording + 1}"


def parted(name: str) -> tuple[str, int]:
    """A base parameter and the recording that it is of: the other way round."""
    stem, mark, number = name.partition(_MARK)
    return (stem, int(number) - 1) if mark else (name, 0)
