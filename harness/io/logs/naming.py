"""Which of a log's joints is which of the model's: by name, by a pattern of names, by order."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

from harness.core.errors import InputError
from harness.io.logs.raw import Fields, Raw, one_of

EVERY = "*"
"""All joints, in the order of both."""
_PLACE = re.compile(r"\\\{(\w+)\\\}")
_COUNTED = re.compile(r"^(?P<before>.*?)(?P<number>\d+)(?P<behind>\D*)$")


def renamed(raw: Raw, names: Mapping[str, str], joints: Sequence[str] | None) -> Raw:
    """Joints, or one field of them, by other names; joints : the model's, which "*=*" takes in their order.

    "panda_joint{i}=fer_joint{i}" is every joint of that shape, {i} as it stands. Raises InputError for a name or a
    shape that the log has not.
    """
    if not names:
        return raw
    names = _each(raw, names, joints)
    fields: Fields = {}
    for kind, of in raw.fields.items():
        moved = {joint: names.get(f"{joint}.{kind}", names.get(joint, joint)) for joint in of}
        fields[kind] = {moved[joint].removesuffix(f".{kind}"): values for joint, values in of.items()}
    said = ", ".join(f"{one} is {other}" for one, other in names.items())
    return replace(raw, fields=fields, notes=(*raw.notes, f"Of the log's joints {said} (--names)."))


def _each(raw: Raw, names: Mapping[str, str], joints: Sequence[str] | None) -> dict[str, str]:
    """Names without patterns, by the log's joint or its field."""
    have = list(raw.fields.get("position", {}))
    found: dict[str, str] = {}
    for name, other in names.items():
        if name == other == EVERY:
            if joints is None or len(joints) != len(have):
                of = "no model" if joints is None else f"{len(joints)} in the model ({', '.join(joints)})"
                said = f"{len(have)} joints in the log ({', '.join(have)}), {of}"
                raise InputError('--names "*=*"', said, "as many of both, or NAME=NAME,..")
            found |= dict(zip(have, joints, strict=True))
        elif "{" in name:
            shape = re.compile(_PLACE.sub(r"(?P<\1>\\w+)", re.escape(name)))
            of_fields = (f"{joint}.{kind}" for kind, of in raw.fields.items() for joint in of)
            fits = {one: fit for one in (*have, *of_fields) if (fit := shape.fullmatch(one))}
            if not fits:
                raise one_of("--names", name, have, "joint")
            found |= {one: _filled(other, fit.groupdict()) for one, fit in fits.items()}
        elif name in have or name.rpartition(".")[0] in have:
            found[name] = other
        else:
            raise one_of("--names", name, have, "joint")
    return found


def _filled(shape: str, places: Mapping[str, str]) -> str:
    """A shape with what its places hold."""
    for place, text in places.items():
        shape = shape.replace(f"{{{place}}}", text)
    return shape


def no_such(file: str, have: Sequence[str], joints: Sequence[str]) -> InputError:
    """The error where no joint of the log is one of the model's, with the --names that would make them so."""
    shapes = [_shape(one) for one in (have, joints)]
    if all(shapes):
        (before, numbers, behind), (other, known, end) = (one for one in shapes if one)
        if numbers & known:
            value = f"{before}{{i}}{behind}={other}{{i}}{end}"
            return _named(file, have, joints, value)
    if len(have) == len(joints):
        return _named(file, have, joints, f"{EVERY}={EVERY}")
    if len(joints) < 2 or not have:  # one was asked for by its name
        return one_of(file, joints[0] if joints else "", list(have), "joint")
    found = f"joints {', '.join(have)}, and none of the model's, {', '.join(joints)}"
    return InputError(file, found, f"--names LOG=MODEL for each, such as {have[0]}={joints[0]}")


def _named(file: str, have: Sequence[str], joints: Sequence[str], value: str) -> InputError:
    found = f"joints {', '.join(have)}, and none of the model's, {', '.join(joints)}; if they correspond in this order"
    return InputError(file, found, f'try: --names "{value}"')


def _shape(names: Sequence[str]) -> tuple[str, frozenset[str], str] | None:
    """What most of the names that are counted have before and behind their number; None where none is."""
    counted = [found for name in names if (found := _COUNTED.match(name))]
    shapes = [(one["before"], one["behind"]) for one in counted]
    if not shapes:
        return None
    before, behind = max(shapes, key=shapes.count)
    return (
        before,
        frozenset(one["number"] for one in counted if (one["before"], one["behind"]) == (before, behind)),
        behind,
    )
