"""A model's file as nodes that know where they stand: what MJCF, URDF, SDF and USD (as text) have in common here.

The file is read within the bounds of every robot's model: no document type, no entities, includes of its own folder.
Elements of an MJCF also have what their class of defaults hands down.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from harness.core.bounded import MODELS, check_file, read_bytes
from harness.core.errors import InputError
from harness.robot.bare import MOST_BYTES, Source, read_xml, with_included
from harness.robot.paste import tags
from harness.robot.words.table import Form

ACCEPTED: Final = "an MJCF, URDF or SDF, or a USD as text (.usda)"
_ROOTS: Final[dict[str, Form]] = {
    "mujoco": "mjcf",
    "mujocoinclude": "mjcf",
    "robot": "urdf",
    "sdf": "sdf",
    "gazebo": "sdf",
}
_USD = (".usd", ".usda", ".usdc", ".usdz")


@dataclass(slots=True)
class Node:
    """An element, or a prim of a USD. way : names from the root down to its own.

    text : what stands in it, stripped; of a prim what stands before its braces.
    """

    file: Path
    line: int
    way: tuple[str, ...]
    attributes: dict[str, str]
    text: str = ""
    parent: "Node | None" = None
    children: "list[Node]" = field(default_factory=list)

    @property
    def tag(self) -> str:
        return self.way[-1]

    def above(self) -> "Iterator[Node]":
        """Itself, and what it stands in, outwards."""
        node: Node | None = self
        while node is not None:
            yield node
            node = node.parent


def nodes_of(path: Path) -> tuple[Form, list[Node]]:
    """The format of a file and all of its nodes, with those of files it includes, in order.

    Raises InputError for a file that is not there, too large, or none of these formats.
    """
    check_file(path, accepted=ACCEPTED, suffixes=(*MODELS, ".usda"))
    if path.suffix.lower() in _USD:
        return "usd", list(_prims(path))
    source = read_xml(path)
    form = _ROOTS.get(source.root.tag)
    if form is None:
        raise InputError(str(path), f"XML that begins with <{source.root.tag}>", ACCEPTED)
    sources = with_included(path) if form != "sdf" else (source,)
    return form, list(_elements(path, {one.path.resolve(): one for one in sources}))


def _elements(path: Path, sources: Mapping[Path, Source], within: Node | None = None) -> Iterator[Node]:
    """Of a file; those of one that it includes stand where the include does. within : what this one is included in."""
    text, above = sources[path.resolve()].text, within.way if within is not None else ()
    open_: list[Node] = []
    line = at = 0
    for tag in tags(text):
        line, at = line + text.count("\n", at, tag.begin), tag.begin
        if within is not None and len(tag.way) == 1:
            continue
        depth = len(tag.way) - (2 if within is not None else 1)
        del open_[depth:]
        parent = open_[-1] if open_ else within
        if tag.way[-1] == "include" and (file := _included(path, tag.attributes, sources)) is not None:
            yield from _elements(file, sources, parent)
            continue
        said = "" if tag.empty else text[tag.end : max(text.find("<", tag.end), tag.end)].strip()
        way = (*above, *tag.way[1:]) if within is not None else tag.way
        node = Node(path, line + 1, way, dict(tag.attributes), said, parent)
        if parent is not None:
            parent.children.append(node)
        open_.append(node)
        yield node


def _included(path: Path, attributes: Mapping[str, str], sources: Mapping[Path, Source]) -> Path | None:
    first = next(iter(sources)).parent
    file = first / attributes.get("file", "")
    return next((one.path for at, one in sources.items() if at == file.resolve() and at != path.resolve()), None)


def unread(form: Form, nodes: Sequence[Node]) -> list[str]:
    """Other models that a file names and that are not read: of an SDF's include, an MJCF's asset, a USD's layers."""
    found = []
    for one in nodes:
        if form == "sdf" and one.tag == "uri" and one.way[-2:-1] == ("include",):
            found.append(one.text)
        elif form == "mjcf" and one.way[-2:] == ("asset", "model"):
            found.append(one.attributes.get("file", ""))
        elif form == "usd":
            found += re.findall(r"@([^@]+\.usd[acz]?)@", one.text)
    return list(dict.fromkeys(name for name in found if name))


_PRIM = re.compile(r"^\s*(?:def|over|class)\s+(?:(?P<type>\w+)\s+)?\"(?P<name>[^\"]*)\"")
_ATTRIBUTE = re.compile(
    r"^\s*(?:(?:custom|uniform|varying|prepend)\s+)*[\w:]+(?:\[\])?\s+(?P<name>[\w:]+)(?:\.timeSamples)?\s*=\s*(?P<value>[^#]*)"
)


def _prims(path: Path) -> Iterator[Node]:
    """Prims of a USD as text, each with the attributes that stand a line each in it."""
    data = read_bytes(path, MOST_BYTES)
    if not data.startswith(b"#usda"):
        raise InputError(
            str(path), "a USD that is no text", f"the text that usdcat writes: usdcat {path.name} -o a.usda"
        )
    open_: list[Node] = []
    depth: list[int] = []
    level = 0
    for number, line in enumerate(data.decode("utf-8", "replace").splitlines(), 1):
        bare = re.sub(r"\"[^\"]*\"|#.*", lambda found: '""' if found[0][0] == '"' else "", line)
        if (found := _PRIM.match(line)) is not None:
            parent = open_[-1] if open_ else None
            node = Node(path, number, (*(parent.way if parent else ()), found["type"] or "Prim"), {}, "", parent)
            node.attributes[""], node.text = found["name"], line[found.end() :]
            open_.append(node)
            depth.append(level)
            yield node
        elif open_ and level == depth[-1]:
            open_[-1].text += line + "\n"
        elif open_ and (found := _ATTRIBUTE.match(line)) is not None:
            own = Node(
                path,
                number,
                (*open_[-1].way, "attribute"),
                {found["name"]: found["value"].rstrip(" (").strip()},
                "",
                open_[-1],
            )
            open_[-1].children.append(own)
            yield own
        level += bare.count("{") - bare.count("}")
        while depth and level <= depth[-1] and "}" in bare:
            depth.pop()
            open_.pop()


_SERVOS: Final = ("position", "velocity", "intvelocity")
"""Shortcuts that make an actuator's bias affine, in a default too."""
_ACTUATORS: Final = (
    *("general", "motor", *_SERVOS, "orientation", "pid", "damper", "cylinder"),
    *("muscle", "adhesion", "dcmotor"),
)
_TENDONS: Final = ("tendon", "fixed", "spatial")
_BODIES: Final = ("body", "frame", "replicate", "worldbody")
_Given = dict[str, tuple[str, Node]]
"""Values by attribute, each with the element that gives it."""


def family(tag: str) -> str:
    """Elements of one family share a default: all actuators have one, and all tendons."""
    return "actuator" if tag in _ACTUATORS else "tendon" if tag in _TENDONS else tag


class Defaults:
    """Of a whole file, with what it includes."""

    def __init__(self, nodes: Sequence[Node]) -> None:
        self._classes: dict[str, dict[str, _Given]] = {}
        self._main = "main"
        self._own: dict[int, _Given] = {}
        self.outside = [one for one in nodes if "default" not in one.way]
        for one in nodes:
            if one.tag == "default" and (one.parent is None or one.parent.tag != "default"):
                self._main = one.attributes.get("class", self._main)
                self._gather(one, self._classes.get(self._main, {}))
        self._users: dict[int, list[tuple[str, Node]]] = {}
        for one in self.outside:
            for name, (_, giver) in self._given(one).items():
                if giver is not one:
                    self._users.setdefault(id(giver), []).append((name, one))

    def _gather(self, default: Node, above: dict[str, _Given]) -> None:
        own = {kind: dict(given) for kind, given in above.items()}
        for child in default.children:
            if child.tag != "default":
                given = own.setdefault(family(child.tag), {})
                if child.tag in _SERVOS:
                    given["biastype"] = ("affine", child)
                given.update({name: (value, child) for name, value in child.attributes.items() if name != "class"})
        self._classes[default.attributes.get("class", self._main)] = own
        for child in default.children:
            if child.tag == "default":
                self._gather(child, own)

    def knows(self, name: str) -> bool:
        """Whether a default is of this class."""
        return name == self._main or name in self._classes

    def class_of(self, node: Node) -> str:
        """The class of an element: its own, else that of the nearest body or frame which gives one to all in it."""
        around = (one.attributes.get("childclass") for one in node.above() if one is not node and one.tag in _BODIES)
        return node.attributes.get("class") or next((name for name in around if name), self._main)

    def _given(self, node: Node) -> _Given:
        found = self._own.get(id(node))
        if found is None:
            found = dict(self._classes.get(self.class_of(node), {}).get(family(node.tag), {}))
            found.update({name: (value, node) for name, value in node.attributes.items()})
            self._own[id(node)] = found
        return found

    def of(self, node: Node) -> dict[str, str]:
        """All attributes of an element that is no default."""
        return {name: value for name, (value, _) in self._given(node).items()}

    def having(self, node: Node, name: str) -> list[Node]:
        """Elements that have an attribute from this one: itself, or for one in a default all that inherit it."""
        if "default" not in node.way:
            return [node]
        return [user for given, user in self._users.get(id(node), []) if given == name]

    def alike(self, node: Node) -> list[Node]:
        """Elements outside of defaults of its family."""
        return [one for one in self.outside if family(one.tag) == family(node.tag)]
