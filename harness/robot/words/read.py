"""A model's file as nodes that know where they stand: what MJCF, URDF, SDF and USD (as text) have in common here.

The file is read within the bounds of every robot's model: no document type, no entities, includes of its own folder.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from harness.core.bounded import check_file, read_bytes
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
    check_file(path, accepted=ACCEPTED)
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
