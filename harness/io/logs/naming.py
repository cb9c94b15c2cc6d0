"""Which of a log's joints is which of the model's: by name, by a pattern of names, by order."""

import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from difflib import SequenceMatcher

from harness.core.errors import InputError
from harness.io.logs.raw import Fields, Raw, one_of

EVERY = "*"
"""All joints, in the order of both."""
_PLACE = re.compile(r"\\\{(\w+)\\\}")


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


def same_joints(have: Sequence[str], joints: Sequence[str]) -> dict[str, str]:
    """By the log's joints the model's: of the same name, or alone in ending with the other's last part, elbow and
    arm::elbow, left/elbow and elbow."""
    names = {joint: joint for joint in have if joint in joints}
    left = [joint for joint in have if joint not in names]
    for other in (joint for joint in joints if joint not in names):
        alike = [joint for joint in left if _ends_alike(joint, other)]
        if len(alike) == 1 and sum(_ends_alike(alike[0], one) for one in joints if one not in names) == 1:
            names[alike[0]] = other
    return names


def _ends_alike(one: str, other: str) -> bool:
    """Whether the parts of one name are the last of the other."""
    parts = [re.split(r"::|/", name) for name in (one, other)]
    shared = min(map(len, parts))
    return parts[0][-shared:] == parts[1][-shared:]


def no_such(file: str, have: Sequence[str], joints: Sequence[str]) -> InputError:
    """The error where no joint of the log is one of the model's, with the --names that would make them so."""
    if shape := _shape(have, joints):
        return _named(file, have, joints, shape)
    if len(have) == len(joints):
        return _named(file, have, joints, f"{EVERY}={EVERY}")
    if len(joints) < 2 or not have:  # one was asked for by its name
        return one_of(file, joints[0] if joints else "", list(have), "joint")
    found = f"joints {', '.join(have)}, and none of the model's, {', '.join(joints)}"
    return InputError(file, found, f"--names LOG=MODEL for each, such as {have[0]}={joints[0]}")


def _named(file: str, have: Sequence[str], joints: Sequence[str], value: str) -> InputError:
    found = f"joints {', '.join(have)}, and none of the model's, {', '.join(joints)}; if they correspond in this order"
    return InputError(file, found, f'try: --names "{value}"')


def _shape(have: Sequence[str], joints: Sequence[str]) -> str:
    """The shape of --names that makes most joints of the log joints of the model, "" where none makes two.

    What the first joint of the log and one of the model have in common is what differs from joint to joint.
    """
    known, best = {*joints}, (1, "")
    for name, other in itertools.product(have, joints):
        same = SequenceMatcher(None, name, other, autojunk=False).find_longest_match()
        for core in {name[same.a : same.a + same.size], *re.findall(r"\d+", name)}:
            if not re.fullmatch(r"\w+", core) or core not in other:
                continue
            (before, behind), (start, end) = (
                (one[: one.rindex(core)], one[one.rindex(core) + len(core) :]) for one in (name, other)
            )
            shape = re.compile(f"{re.escape(before)}(\\w+){re.escape(behind)}")
            fits = [found for one in have if (found := shape.fullmatch(one))]
            made = {f"{start}{fit[1]}{end}" for fit in fits}
            if len(made & known) == len(fits) > best[0]:
                best = len(fits), f"{before}{{i}}{behind}={start}{{i}}{end}"
    return best[1]
