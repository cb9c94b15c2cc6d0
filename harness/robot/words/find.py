"""The words of a file: each with its place and value, and what is wrong with it, if anything.

Wrong is a word that no reader knows, one that stands where no reader looks for it, a value that is none, and one that
something else in the file takes the effect from.
"""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from difflib import SequenceMatcher, get_close_matches
from pathlib import Path
from typing import Final

from harness.robot.words.effect import Effects
from harness.robot.words.read import Node, nodes_of, unread
from harness.robot.words.table import DROPPED, FORMS, Fate, Form, Kind, Taken, Word, table
from harness.robot.words.touching import numbers

_TELLING: Final[dict[Kind, str]] = {
    "friction": r"frict|stiction|coulomb|stribeck|breakaway",
    "damping": r"damp|viscous|dynamics|joint_?properties",
    "armature": r"armature|rotor_?inertia|motor_?inertia|gear_?inertia",
    "servo": r"^k_?[pvdi]$|[pv]_?gain$|dampratio|^k_(position|velocity)$",
    "contact": r"^mu_?[12s]?$|_friction$|contact_coefficients",
}
_NO_VALUE = ("name", "joint", "reference", "class", "type", "file", "filename", "uri", "key", "dclass", "childclass")
_NOT_LOOKED_INTO = (
    "deformable",
    "plugin",
    "ros2_control",
    "sensor",
    "custom",
    "extension",
    "visual",
    "material",
    "metadata",
    "text",
)
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


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


@dataclass(frozen=True, slots=True)
class Words:
    """Of a file. found : in order. unread : other models that it names."""

    form: Form
    found: list[Found]
    unread: list[str]


def words_in(path: Path) -> Words:
    """The format of a file, and every word of friction, damping, armature and servos in it.

    Raises InputError as ``nodes_of`` does.
    """
    form, nodes = nodes_of(path)
    effects = Effects(form, nodes)
    found = [_with_effect(form, one, node, effects) for node in nodes for one, node in _of_node(form, node)]
    return Words(form, found, unread(form, nodes))


def _of_node(form: Form, node: Node) -> Iterator[tuple[Found, Node]]:
    """Words that a node is or has, each with the node that holds it."""
    if any(one.tag in _NOT_LOOKED_INTO for one in node.above()) or (form == "urdf" and node.way[0] != "robot"):
        return
    if form == "urdf" and "gazebo" in node.way[:-2]:
        return  # SDF that is handed on
    if form == "urdf" and node.way[:2] == ("robot", "mujoco"):
        yield from _of_extension(node)
        return
    holder = node.parent
    if form != "usd" and holder is not None:
        own = _known(form, holder.way, node.tag, element=True)
        if own is not None:
            # an SDF's value as a URDF for Gazebo may have it
            yield _checked(own, own.name, node.text or node.attributes.get("value", ""), node), holder
            return
        wants = next(
            (w for w in table().words[form] if not w.element and w.name == "value" and w.stands(node.way)), None
        )
        if wants is not None and "value" not in node.attributes:
            yield _without_attribute(wants, node), node
            return
        if (
            (node.text or form != "sdf")
            and not node.children
            and not _has_word(form, node)
            and (kind := _kind(form, node.tag)) is not None
        ):
            # <mu> in a flag of MJCF and the like are attributes: an element is a word where it holds nothing else
            yield _stray(form, node, node.tag, node.text, kind, element=True), node
    for name, value in node.attributes.items():
        if name in _NO_VALUE or not name:
            continue
        own = _known(form, node.way, name, element=False, value=value)
        if own is not None:
            yield _checked(own, node.tag if name == "value" else name, value, node), node
        elif (kind := _kind(form, name)) is not None:
            yield _stray(form, node, name, value, kind, element=False), node


def _of_extension(node: Node) -> Iterator[tuple[Found, Node]]:
    """MJCF that stands in a URDF, which MuJoCo's compiler reads."""
    for name, value in node.attributes.items():
        own = _known("mjcf", node.way[1:], name, element=False)
        if own is not None:
            cells = {one: taken for one, taken in own.cells.items() if table().readers[one].parser == "mujoco"}
            yield _checked(replace(own, cells=cells), name, value, node), node


def _without_attribute(word: Word, node: Node) -> Found:
    """An element whose value stands in it as text, or not at all."""
    problem = "has its value as text, and readers look for an attribute" if node.text else "has no value"
    refused = tuple((one, Taken("refused", "the file is not loaded")) for one in word.cells)
    place, fix = _place(node), f"write {word.written(node.text or '...')}"
    return Found(word, word.kind, node.tag, node.text, place, node.file, node.line, problem, fix, cells=refused)


def _known(form: Form, way: tuple[str, ...], name: str, element: bool, value: str = "") -> Word | None:
    higher = any(numbers(value)[1:])
    for word in table().words[form]:
        if form == "usd":
            if re.fullmatch(re.escape(word.name).replace(r"\*", "[^:]+"), name):
                return word
        elif word.name == name and word.element == element and word.stands(way) and (higher or not word.polynomial):
            return word
    return None


def _has_word(form: Form, node: Node) -> bool:
    return any(_known(form, node.way, name, False) or _kind(form, name) for name in node.attributes)


def _kind(form: Form, name: str) -> Kind | None:
    """Of what a name that stands in no place of the table speaks; None where of nothing that is ours."""
    low = name.lower()
    if form == "usd":
        own = None if re.search(_NO_JOINT, low) else re.search(r"viscous|damping|friction|armature", low)
        kinds: dict[str, Kind] = {"friction": "friction", "armature": "armature"}
        if own is not None:
            return kinds.get(own[0], "damping")
        close = get_close_matches(
            _INSTANCE.sub("*", name), [word.name for word in table().words["usd"]], n=1, cutoff=0.9
        )
        return next(word.kind for word in table().words["usd"] if word.name == close[0]) if close else None
    if low in _HOUSE[form]:
        return None
    for kind, pattern in _TELLING.items():
        if re.search(pattern, low):
            return kind
    near = get_close_matches(low, _NAMES, n=1, cutoff=0.8)
    return next(w.kind for f in FORMS for w in table().words[f] if w.name == near[0]) if near else None


_NO_JOINT = r"contact|combine|correlation|offset|patch|scene|default|fabric|:(?:mpm|xpbd|vbd)"
"""In names of USD that say friction or damping and mean no joint's or body's."""
_INSTANCE = re.compile(r"(?<=:)(?:angular|linear|rot[XYZ]|trans[XYZ])(?=:)")
"""Of a schema that may be applied several times, in an attribute's name."""
_NO_TAGS: Final = ("joint_properties", "joint_property", "contact_coefficients", "dynamics_properties")
"""That files have from old drafts of URDF, or from other files."""
_NAMES: Final = ("damping", "friction", "frictionloss", "armature", "dampratio", "springdamper")
_HOUSE: Final[dict[Form, frozenset[str]]] = {
    # names of the format that the patterns above would take for a word
    "mjcf": frozenset(("edgedamping", "fluidcoef", "jointactuatorfrc")),
    "urdf": frozenset(("dynamics", "friction_anchor")),
    "sdf": frozenset(("dynamics", "friction_anchor", "friction_model", "torsional", "fdir1")),
    "usd": frozenset(),
}


def _place(node: Node) -> str:
    """The nearest thing above that has a name."""
    for one in node.above():
        name = next((one.attributes[key] for key in ("name", "joint", "reference", "") if key in one.attributes), None)
        if name is not None and one.tag != "attribute":
            return f"{one.tag} {name}" if "" not in one.attributes else name
        if one.tag == "default":
            return f"default {one.attributes.get('class', 'main')}"
    return node.way[min(1, len(node.way) - 1)]


def _checked(word: Word, name: str, value: str, node: Node) -> Found:
    """A word that is in its place, with what is wrong with its value."""
    found = Found(word, word.kind, name, value, _place(node), node.file, node.line)
    if any(tag.startswith("xacro:") for tag in node.way):
        problem, cells = "stands in a macro of xacro", tuple((one, DROPPED) for one in word.cells)
        return replace(found, problem=f"{problem}, which no reader expands", fix=_EXPAND, cells=cells)
    if word.unit == "enable, disable":
        return found
    said = value.strip("()").replace(",", " ").split() if word.form == "usd" else value.split()
    wrong = [part for part in said if not _NUMBER.fullmatch(part)]
    write = f"write {word.written('0.1')}, in {word.unit.split(';')[0]}"
    if not said or wrong:
        if any("${" in part or "$(" in part for part in said):
            problem, write = "is an expression of xacro, not a number", _EXPAND
        elif value.startswith("{"):
            problem = "has time samples, and readers take its one value"
        elif not said:
            problem = "has no value"
        elif any(re.fullmatch(r"[-+]?\d+,\d+", part) for part in said):
            problem, write = "has a decimal comma", f"write {word.written(value.replace(',', '.'))}"
        elif all(_NUMBER.fullmatch(part) is None for part in said) and _finite(said[0]) is None:
            problem = "is no number"
        elif not all(math.isfinite(_finite(part) or 0.0) for part in said):
            problem = "is not finite"
        else:
            problem = "has a unit in it, which no reader knows"
            write = f"write the number alone, in {word.unit.split(';')[0]}"
        return replace(found, problem=f"{problem}: {value!r}", fix=write, cells=_misread(word, said))
    if len(said) > word.count:
        few = "one number is" if word.count == 1 else f"at most {word.count} numbers are"
        return replace(found, problem=f"{few} read, and {len(said)} stand there", fix=write, cells=_misread(word, said))
    if not word.negative and any(float(part) < 0.0 for part in said):
        return replace(
            found,
            problem=f"is negative: {value}, which feeds energy in wherever it is read",
            fix=write,
            cells=tuple((one, Taken("meaning", "it drives the motion")) for one in word.cells if _reads(word, one))
            + tuple((one, Taken(fate, note)) for one, fate, note in _NEGATIVE if one in word.cells),
        )
    return found


_NEGATIVE: Final[tuple[tuple[str, Fate, str], ...]] = (
    ("drake", "refused", "below zero"),
    ("dart", "dropped", "below zero"),
    ("gazebo", "dropped", "below zero, by DART"),
    ("rapier", "dropped", "below zero"),
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
_ONE_NUMBER: Final = {("drake", "mjcf"), ("drake", "urdf")}
"""Those of them that refuse a second number."""


def _misread(word: Word, said: Sequence[str]) -> tuple[tuple[str, Taken], ...]:
    """What parsers make of a value that is no number: most refuse the file, some read as far as they can."""
    if word.form == "usd":
        return tuple((one, Taken("dropped", "no number")) for one in word.cells)
    if said and _finite(said[0]) is not None and not math.isfinite(float(said[0])):
        return _not_finite(word, math.isinf(float(said[0])))
    start = _NUMBER.match(said[0]) if said else None
    number = 0.0 if start is None else float(start[0])
    refused, zero = Taken("refused", "no number"), Taken("dropped", "read as 0, in silence")
    found = {}
    for one in table().of(word.form):
        none, empty = _LAX.get((one.parser, word.form), ("refused", "dropped" if one.parser == "mujoco" else "refused"))
        strict = (one.parser, word.form) not in _LAX
        second = (one.parser, word.form) in _ONE_NUMBER and sum(map(_is_number, said)) > 1
        fate = empty if not said else none if start is None else "refused" if strict or second else "read"
        if fate == "refused":
            found[one.name] = refused
        elif word.taken(one.name).fate != "dropped":
            found[one.name] = Taken("meaning", f"read as {number:g}, in silence") if number and fate == "read" else zero
    return tuple(found.items())


def _is_number(text: str) -> bool:
    return _NUMBER.fullmatch(text) is not None


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


_ALIKE: Final[dict[Form, float]] = {"mjcf": 0.6, "urdf": 0.6, "sdf": 0.6, "usd": 0.8}
"""How like a name of the format one that is unknown has to be, so that it is meant; names of USD share their parts."""


def _stray(form: Form, node: Node, name: str, value: str, kind: Kind, element: bool) -> Found:
    """A name that speaks of friction and stands in no place where a reader looks for it."""
    own = table().words[form]
    way = node.way[:-1] if element else node.way
    usual, value = table().common(form, kind), value or node.attributes.get("value", "")
    alike = sorted((word for word in own if word.called == name), key=lambda word: word.kind != kind)
    otherwise = next((word for word in alike if word.element != element and form != "usd" and word.stands(way)), None)
    here = next((word for word in own if form != "usd" and word.kind == kind and word.stands(way)), None)
    taken = [w for w in own if w.kind == kind and any(one.fate in ("read", "unit") for one in w.cells.values())]
    near = get_close_matches(_INSTANCE.sub("*", name), [w.name for w in taken], cutoff=_ALIKE[form])
    if near and not (here and alike):
        # of names that are as near the one that comes first, as mu1 before mu2 for mu
        least = SequenceMatcher(None, near[0], name).ratio()
        usual = next(w for w in taken if SequenceMatcher(None, w.name, name).ratio() >= least)
    unknown = next((tag for tag in node.way[1:] if tag in _NO_TAGS), None)
    if unknown is not None:
        problem, usual = f"stands in <{unknown}>, a tag that no reader knows", table().common(form, kind)
    elif otherwise is not None:
        said = ("an element", "an attribute") if element else ("an attribute", "an element")
        problem, usual = f"is {said[0]} here, and {form.upper()} has {said[1]} of this name", otherwise
    elif here is not None:
        other = _format_of(form, name, kind)
        problem, usual = (
            f"is {f'no word of {_article(form)}' if other is None else f'{other.form.upper()}, no'} {form.upper()}",
            here,
        )
    elif alike and (alike[0].kind == kind or alike[0].called != alike[0].name):
        where = f"<{way[-1]}>" if alike[0].name == name else f"<{way[-1]}> of <{way[-2]}>"
        problem, usual = f"stands in {where}, where no reader looks for it", alike[0]
    elif (other := _format_of(form, name, kind)) is not None:
        problem = f"is {other.form.upper()}, and unknown in {form.upper()}"
    else:
        problem = "is known to no reader"
    right = usual is not None and value and _NUMBER.fullmatch(value)
    fix = (
        _instead(form, kind, usual)
        if not right or usual is None
        else f"write {usual.written(value, _place(node).partition(' ')[2])}"
    )
    if form == "usd" and (instance := _INSTANCE.search(name)) is not None:
        fix = fix.replace("*", instance[0])
    refusing = {one.name for one in table().of(form) if form == "mjcf" and one.parser == "mujoco"}
    dynamics = node if node.tag == "dynamics" else node.parent
    if dynamics is not None and dynamics.tag == "dynamics" and dynamics.way[-2] in ("joint", "axis"):
        # URDF's parsers want one of the two, and Bullet's of SDF as well
        has = set(dynamics.attributes) if form == "urdf" else {one.tag for one in dynamics.children}
        wanting = ("urdfdom", "sdformat", "bullet") if form == "urdf" else ("bullet",)
        if not {"damping", "friction"} & has:
            refusing |= {one.name for one in table().of(form) if one.parser in wanting}
    cells = tuple((one, Taken("refused", "the file is not loaded")) for one in sorted(refusing))
    return Found(None, kind, name, value, _place(node), node.file, node.line, problem, fix, cells=cells)


def _article(form: Form) -> str:
    return "a" if form.startswith("u") else "an"


def _format_of(form: Form, name: str, kind: Kind) -> Word | None:
    return next((w for f in FORMS if f != form for w in table().words[f] if w.name == name and w.kind == kind), None)


def _instead(form: Form, kind: Kind, word: Word | None) -> str:
    if word is None:
        return f"{form.upper()} has no word for it"
    return f"write {word.written()}, in {word.unit.split(';')[0]}"


_LOST: Final = {"dropped": "has no effect", "refused": "is refused with its file"}


def _with_effect(form: Form, one: Found, node: Node, effects: Effects) -> Found:
    """The word with what takes its effect away, where it is right by itself."""
    lost = None if one.word is None or one.problem else effects.lost(one.word, one.value, node)
    if one.word is None or lost is None:
        return one
    said = f"{lost.why}{f': {lost.fix}' if lost.fix else ''}"
    if lost.grade == "partly":
        return replace(one, note=said)
    readers = [r for r in table().of(form) if not lost.readers or r.name in lost.readers]
    cells = tuple((r.name, Taken(lost.fate, lost.why)) for r in readers if one.word.taken(r.name).fate != "dropped")
    if lost.grade == "lost":
        return replace(one, note=f"has no effect here: {said}", cells=cells)
    return replace(one, problem=f"{_LOST[lost.fate]}: {lost.why}", fix=lost.fix, cells=cells)
