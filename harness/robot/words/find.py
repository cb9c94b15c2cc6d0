"""The words of a file: each with its place and value, and what is wrong with it, if anything.

Wrong is a word that no reader knows, one that stands where no reader looks for it, a value that is none, and one that
something else in the file takes the effect from.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from difflib import SequenceMatcher, get_close_matches
from pathlib import Path
from typing import Final

from harness.robot.words.effect import Effects
from harness.robot.words.read import Node, nodes_of, unread
from harness.robot.words.table import FORMS, Form, Kind, Taken, Word, table
from harness.robot.words.touching import numbers
from harness.robot.words.values import NUMBER, Found, checked, no_file, place_of

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
            one = checked(own, own.name, node.text or node.attributes.get("value", ""), node)
            yield replace(one, cells=(*one.cells, *_without_either(form, holder))), holder
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
    if form == "urdf" and not node.attributes and (cells := _without_either(form, node)):
        problem, fix = "has neither damping nor friction", 'write <dynamics damping="0" friction="0"/>, or take it out'
        own_place = (place_of(node), node.file, node.line)
        yield Found(None, "damping", "dynamics", "", *own_place, problem, fix, cells=cells), node
    for name, value in node.attributes.items():
        if name in _NO_VALUE or not name:
            continue
        own = _known(form, node.way, name, element=False, value=value)
        if own is not None:
            yield checked(own, node.tag if name == "value" else name, value, node), node
        elif (kind := _kind(form, name)) is not None:
            yield _stray(form, node, name, value, kind, element=False), node


def _of_extension(node: Node) -> Iterator[tuple[Found, Node]]:
    """MJCF that stands in a URDF, which MuJoCo's compiler reads."""
    for name, value in node.attributes.items():
        own = _known("mjcf", node.way[1:], name, element=False)
        if own is not None:
            cells = {one: taken for one, taken in own.cells.items() if table().readers[one].parser == "mujoco"}
            yield checked(replace(own, cells=cells), name, value, node), node


def _without_attribute(word: Word, node: Node) -> Found:
    """An element whose value stands in it as text, or not at all."""
    problem = "has its value as text, and readers look for an attribute" if node.text else "has no value"
    refused = tuple((one, Taken("refused", "the file is not loaded")) for one in word.cells)
    place, fix = place_of(node), f"write {word.written(node.text or '...')}"
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
    right = usual is not None and value and NUMBER.fullmatch(value)
    fix = (
        _instead(form, kind, usual)
        if not right or usual is None
        else f"write {usual.written(value, place_of(node).partition(' ')[2])}"
    )
    if form == "usd" and (instance := _INSTANCE.search(name)) is not None:
        fix = fix.replace("*", instance[0])
    cells = no_file(form) if form == "mjcf" else ()
    dynamics = node if node.tag == "dynamics" else node.parent
    cells += () if dynamics is None else _without_either(form, dynamics)
    return Found(None, kind, name, value, place_of(node), node.file, node.line, problem, fix, cells=cells)


def _without_either(form: Form, dynamics: Node) -> tuple[tuple[str, Taken], ...]:
    """What parsers make of a <dynamics> with neither word: URDF's refuse it, Bullet's of SDF as well."""
    if dynamics.tag != "dynamics" or dynamics.way[-2] not in ("joint", "axis"):
        return ()
    has = set(dynamics.attributes) if form == "urdf" else {one.tag for one in dynamics.children}
    wanting = ("urdfdom", "sdformat", "bullet") if form == "urdf" else ("bullet",)
    if {"damping", "friction"} & has:
        return ()
    return tuple(
        (one.name, Taken("refused", "the file is not loaded")) for one in table().of(form) if one.parser in wanting
    )


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
