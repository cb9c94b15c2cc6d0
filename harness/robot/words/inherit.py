"""What elements of an MJCF have: their own attributes, and those that their class of defaults hands down."""

from collections.abc import Sequence
from typing import Final

from harness.robot.words.read import Node

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
