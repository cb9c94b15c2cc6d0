"""Two recordings held against each other measure one kind of thing: lengths, or angles."""

from dataclasses import replace

from harness.core.errors import InputError
from harness.core.recording import Recording

_OWN = {True: ("rad", "rad/s", "rad/s^2"), False: ("m", "m/s", "m/s^2")}


def as_kind_of(one: Recording, other: Recording, option: str = "") -> Recording:
    """The first as what the second is: one whose file names no unit is read in rad, or in m, as the other.

    option : where the first was given, for the message. Raises InputError where one is a length and the other an angle.
    """
    if one.angular == other.angular:
        return one
    if _named(one):
        said = {True: "an angle", False: "a length"}
        where = f"{option} {one.file}" if option else one.file
        raise InputError(
            where,
            f"{said[one.angular]} ({_said(one)}), where {other.file} is {said[other.angular]} ({_said(other)})",
            "two traces of one kind are accepted; --columns says what a column is",
        )
    units = dict(zip("xva", _OWN[other.angular], strict=True))
    note = f"Its columns name no unit: read in {' and '.join(units[c] for c in 'xva' if c in one)}, as {other.file}."
    return replace(one, angular=other.angular, notes=(*one.notes, note))


def of_one_kind(one: Recording, other: Recording) -> tuple[Recording, Recording]:
    """Both as one kind; the one that names no unit gives way. Raises InputError where neither does."""
    if _named(one) and not _named(other):
        return one, as_kind_of(other, one)
    return as_kind_of(one, other), other


def _named(recording: Recording) -> bool:
    """Whether its file names a unit of the motion."""
    return any(recording.units.get(c) for c in ("x", "v", "a"))


def _said(recording: Recording) -> str:
    channel = next(c for c in ("x", "v", "a") if c in recording)
    unit = recording.units.get(channel) or _OWN[recording.angular]["xva".index(channel)]
    return f"{channel} in {unit}"
