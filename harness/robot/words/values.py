"""A word as it was found in a model's file, what is wrong with its value, and what each reader makes of it."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from harness.robot.words.read import Node
from harness.robot.words.table import DROPPED, Fate, Form, Kind, Taken, Word, table


@dataclass(frozen=True, slots=True)
class Found:
    """A word of a file.

    place : the joint, link or prim that it is of. problem : a sentence; "" for none. fix : what to write. note : what
    is to be known of it, "" for nothing. cells : what readers make of it where that is not what the table says.
    """

    word: Word | None
    kind: Kind
    name: str
    value: str
    place: str
    file: Path
    line: int
    problem: str = ""
    fix: str = ""
    note: str = ""
    cells: tuple[tuple[str, Taken], ...] = ()

    def taken(self, reader: str) -> Taken:
        """What a reader makes of it."""
        own = DROPPED if self.word is None else self.word.taken(reader)
        return dict(self.cells).get(reader, own)


def place_of(node: Node) -> str:
    """The nearest thing above that has a name."""
    for one in node.above():
        name = next((one.attributes[key] for key in ("name", "joint", "reference", "") if key in one.attributes), None)
        if name is not None and one.tag != "attribute":
            return f"{one.tag} {name}" if "" not in one.attributes else name
        if one.tag == "default":
            return f"default {one.attributes.get('class', 'main')}"
    return node.way[min(1, len(node.way) - 1)]


NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
"""As files have them."""


def checked(word: Word, name: str, value: str, node: Node) -> Found:
    """A word that is in its place, with what is wrong with its value."""
    found = Found(word, word.kind, name, value, place_of(node), node.file, node.line)
    if any(tag.startswith("xacro:") for tag in node.way):
        problem, cells = "stands in a macro of xacro", tuple((one, DROPPED) for one in word.cells)
        return replace(found, problem=f"{problem}, which no reader expands", fix=_EXPAND, cells=cells)
    said = value.strip("()").replace(",", " ").split() if word.form == "usd" else value.split()
    fix = f"write {word.written('0.1')}, in {word.unit.split(';')[0]}"
    if word.unit != "enable, disable" and (not said or any(NUMBER.fullmatch(part) is None for part in said)):
        problem, instead = _no_numbers(word, value, said)
        return replace(found, problem=f"{problem}: {value!r}", fix=instead or fix, cells=_misread(word, said))
    if len(said) > word.count:
        few = "one number is" if word.count == 1 else f"at most {word.count} numbers are"
        return replace(found, problem=f"{few} read, and {len(said)} stand there", fix=fix, cells=_misread(word, said))
    if not word.negative and any(part.startswith("-") and float(part) < 0.0 for part in said):
        return _negative(found, word, fix)
    if word.unit == _CONDIM and value.strip() not in ("1", "3", "4", "6"):
        fix = f"write {word.written('3')}"
        return replace(found, problem=f"has to be {_CONDIM}", fix=fix, cells=no_file(word.form))
    return found


def _no_numbers(word: Word, value: str, said: Sequence[str]) -> tuple[str, str]:
    """What is wrong with a value that is none, and what to write, where that is not the usual."""
    if any("${" in part or "$(" in part for part in said):
        return "is an expression of xacro, not a number", _EXPAND
    if value.startswith("{"):
        return "has time samples, and readers take its one value", ""
    if not said:
        return "has no value", ""
    if any(re.fullmatch(r"[-+]?\d+,\d+", part) for part in said):
        return "has a decimal comma", f"write {word.written(value.replace(',', '.'))}"
    if all(NUMBER.fullmatch(part) is None for part in said) and _finite(said[0]) is None:
        return "is no number", ""
    known = all(math.isfinite(_finite(part) or 0.0) for part in said)
    alone = f"write the number alone, in {word.unit.split(';')[0]}"
    return ("has a unit in it, which no reader knows", alone) if known else ("is not finite", "")


_CONDIM: Final = "1, 3, 4 or 6"
_NEGATIVE: Final[tuple[tuple[str, Fate, str], ...]] = (
    ("drake", "refused", "below zero"),
    ("dart", "dropped", "below zero"),
    ("gazebo", "dropped", "below zero, by DART"),
    ("rapier", "dropped", "below zero"),
)
"""Readers that do not take a damping below zero as it stands."""
_REFUSED_BELOW: Final = ("actuator/position dampratio", "tendon/fixed armature")
_NONE_BELOW: Final = ("contact", "solver")


def _negative(found: Found, word: Word, fix: str) -> Found:
    """A word that is below zero."""
    problem = f"is negative: {found.value}"
    if word.key in _REFUSED_BELOW:
        return replace(found, problem=problem, fix=fix, cells=no_file(word.form))
    if word.kind in _NONE_BELOW or word.key == "tendon/fixed frictionloss":
        cells = tuple((one, _BELOW if table().readers[one].parser == "mujoco" else _UNTRIED) for one in word.cells)
        return replace(found, problem=f"{problem}, and no more than 0", fix=fix, cells=cells)
    does = _DOES.get(word.kind, "feeds energy in")
    drives = tuple((one, Taken("meaning", f"it {does}")) for one in word.cells if _reads(word, one))
    others = tuple((one, Taken(fate, note)) for one, fate, note in _NEGATIVE if one in word.cells and _reads(word, one))
    problem = f"{problem}, which {does} wherever it is read"
    return replace(found, problem=problem, fix=fix, cells=(*drives, *others))


_DOES: Final = {"armature": "takes inertia away", "spring": "pushes away from its rest"}
_BELOW: Final = Taken("dropped", "taken as 0")
_UNTRIED: Final = Taken("meaning", "below zero; what becomes of it was not tried")


def no_file(form: Form) -> tuple[tuple[str, Taken], ...]:
    """What MuJoCo's compiler makes of what it refuses."""
    return tuple(
        (one.name, Taken("refused", "the file is not loaded")) for one in table().of(form) if one.parser == "mujoco"
    )


def _reads(word: Word, reader: str) -> bool:
    return word.taken(reader).fate in ("read", "unit")


def _finite(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


_EXPAND: Final = "expand it first: xacro FILE > robot.urdf"
_LAX: Final[dict[tuple[str, Form], tuple[Fate, Fate]]] = {
    ("bullet", "mjcf"): ("dropped", "dropped"),
    ("bullet", "urdf"): ("dropped", "dropped"),
    ("bullet", "sdf"): ("dropped", "refused"),
    ("urdfdom", "mjcf"): ("dropped", "dropped"),
    ("urdfdom", "sdf"): ("refused", "refused"),
    ("sdformat", "sdf"): ("refused", "dropped"),
    ("drake", "mjcf"): ("refused", "refused"),
    ("drake", "urdf"): ("refused", "refused"),
    ("drake", "sdf"): ("refused", "dropped"),
}
"""Parsers, by format, that read a number as far as it goes, with what they make of a value that begins with none, and
of an empty one; the others refuse the file, but for MuJoCo, to which an empty value is none. All were tried."""
_ONENUMBER: Final = {("drake", "mjcf"), ("drake", "urdf")}
"""Those of them that refuse a second number."""


def _misread(word: Word, said: Sequence[str]) -> tuple[tuple[str, Taken], ...]:
    """What parsers make of a value that is no number: most refuse the file, some read as far as they can."""
    if word.form == "usd":
        return tuple((one, Taken("dropped", "no number")) for one in word.cells)
    if said and _finite(said[0]) is not None and not math.isfinite(float(said[0])):
        return _not_finite(word, math.isinf(float(said[0])))
    start = NUMBER.match(said[0]) if said else None
    number = 0.0 if start is None else float(start[0])
    refused, zero = Taken("refused", "no number"), Taken("dropped", "read as 0, in silence")
    found = {}
    for one in table().of(word.form):
        none, empty = _LAX.get((one.parser, word.form), ("refused", "dropped" if one.parser == "mujoco" else "refused"))
        strict = (one.parser, word.form) not in _LAX
        second = (one.parser, word.form) in _ONENUMBER and sum(map(_is_number, said)) > 1
        fate = empty if not said else none if start is None else "refused" if strict or second else "read"
        if fate == "refused":
            found[one.name] = refused
        elif word.taken(one.name).fate != "dropped":
            found[one.name] = Taken("meaning", f"read as {number:g}, in silence") if number and fate == "read" else zero
    return tuple(found.items())


def _is_number(text: str) -> bool:
    return NUMBER.fullmatch(text) is not None


_KEPT: Final = Taken("meaning", "loaded as it is, and the state is no longer finite")
_STOPS: Final = Taken("meaning", "loaded as it is, and nothing moves")
_REFUSES: Final = Taken("refused", "not finite")
_NOT_FINITE: Final[dict[tuple[str, Form], tuple[Taken, Taken]]] = {
    ("mujoco", "mjcf"): (_KEPT, _KEPT),
    ("mujoco", "urdf"): (_KEPT, _KEPT),
    ("bullet", "urdf"): (_KEPT, _KEPT),
    ("bullet", "sdf"): (_KEPT, _KEPT),
    ("urdfdom", "mjcf"): (Taken("dropped", "not a number"), _STOPS),
    ("urdfdom", "urdf"): (_REFUSES, _REFUSES),
    ("urdfdom", "sdf"): (Taken("dropped", "not a number"), _STOPS),
    ("sdformat", "urdf"): (_REFUSES, _REFUSES),
    ("rapier", "mjcf"): (Taken("dropped", "not a number"), _STOPS),
    ("drake", "mjcf"): (_REFUSES, _REFUSES),
    ("drake", "urdf"): (_REFUSES, _REFUSES),
    ("drake", "sdf"): (_REFUSES, _REFUSES),
}
"""What parsers make of a damping that is nan, and of one that is inf. All were tried."""


def _not_finite(word: Word, endless: bool) -> tuple[tuple[str, Taken], ...]:
    untried = Taken("meaning", "not finite; what becomes of it was not tried")
    found = {}
    for one in table().of(word.form):
        nan, inf = _NOT_FINITE.get((one.parser, word.form), (untried, untried))
        taken = inf if endless else nan
        if taken.fate == "refused" or word.taken(one.name).fate != "dropped":
            found[one.name] = taken
    return tuple(found.items())
