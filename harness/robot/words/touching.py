"""Whose friction a contact of an MJCF has: that of a pair, of the geom of higher priority, or the larger of two."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from harness.robot.words.read import Defaults, Node

_FRICTION: Final = (1.0, 0.005, 0.0001)
"""Of a geom that says none: sliding, torsional (m), rolling (m)."""
_USED: Final = {1: 0, 3: 1, 4: 2, 6: 3}
"""How many of a geom's three numbers act, by condim."""
_OPEN: Final = ("attach", "replicate", "flex", "flexcomp", "composite", "plugin")
"""Elements that bring geoms which do not stand in the file."""


@dataclass(frozen=True, slots=True)
class _Geom:
    node: Node
    name: str
    body: Node | None
    parent: Node | None
    types: tuple[int, int]
    condim: int
    priority: int
    friction: tuple[float, ...]
    said: bool


@dataclass(frozen=True, slots=True)
class Beaten:
    """Why a geom's friction does not count in a contact. of : the other geom, or the pair. said : by a word of the
    file, and no default of MuJoCo. fixed : one of both is of the world.
    """

    how: str
    of: str
    said: bool
    fixed: bool


def _whole(text: str | None, usual: int) -> int:
    try:
        return int(text) if text is not None else usual
    except ValueError:
        return usual


def numbers(text: str | None) -> tuple[float, ...]:
    """Of an attribute; none where it holds anything else."""
    try:
        return tuple(float(part) for part in (text or "").split())
    except ValueError:
        return ()


class Touching:
    """The geoms of a file and which of them can touch."""

    def __init__(self, nodes: Sequence[Node], defaults: Defaults) -> None:
        self._nodes, self._defaults = nodes, defaults
        self._beaten: dict[int, list[Beaten | None]] = {}

    @cached_property
    def open(self) -> bool:
        """Whether geoms come from elsewhere."""
        return any(one.tag in _OPEN for one in self._nodes)

    @cached_property
    def _geoms(self) -> dict[int, _Geom]:
        return {id(one): self._geom(one) for one in self._defaults.outside if one.tag == "geom"}

    @cached_property
    def _pairs(self) -> dict[frozenset[str], dict[str, str]]:
        every = ((one, self._defaults.of(one)) for one in self._defaults.outside if one.tag == "pair")
        return {frozenset((has.get("geom1", ""), has.get("geom2", ""))): has for _, has in every}

    def _geom(self, node: Node) -> _Geom:
        has = self._defaults.of(node)
        own = numbers(has.get("friction"))[:3]
        types = (_whole(has.get("contype"), 1), _whole(has.get("conaffinity"), 1))
        body = _moving(next((one for one in node.above() if one.tag == "body"), None))
        above = (
            None if body is None else next((one for one in body.above() if one is not body and one.tag == "body"), None)
        )
        friction = own + _FRICTION[len(own) :]
        condim, priority = _whole(has.get("condim"), 3), _whole(has.get("priority"), 0)
        return _Geom(node, has.get("name", ""), body, _moving(above), types, condim, priority, friction, bool(own))

    def condims(self, node: Node) -> list[int]:
        """Of the contacts that a geom can have."""
        one = self._geoms[id(node)]
        return [_condim(one, other, self._pairs.get(frozenset((one.name, other.name)))) for other in self._others(one)]

    def with_world(self, node: Node) -> bool:
        """Whether one of them is with a geom that stands still, or it is one."""
        one = self._geoms[id(node)]
        return one.body is None or any(other.body is None for other in self._others(one))

    def beaten(self, node: Node) -> list[Beaten | None]:
        """For each geom that a geom can touch, what takes the effect from its friction; None where it counts."""
        if id(node) not in self._beaten:
            one = self._geoms[id(node)]
            self._beaten[id(node)] = [self._against(one, other) for other in self._others(one)]
        return self._beaten[id(node)]

    def _others(self, one: _Geom) -> list[_Geom]:
        found = []
        for other in self._geoms.values():
            if other is one:
                continue
            paired = bool(one.name and other.name) and frozenset((one.name, other.name)) in self._pairs
            apart = other.body is not one.body and not (
                (one.body is not None and other.body is not None)
                and (one.parent is other.body or other.parent is one.body)
            )
            may = one.types[0] & other.types[1] or other.types[0] & one.types[1]
            if paired or (apart and may):
                found.append(other)
        return found

    def _against(self, one: _Geom, other: _Geom) -> Beaten | None:
        pair = self._pairs.get(frozenset((one.name, other.name))) if one.name and other.name else None
        fixed, called = one.body is None or other.body is None, other.name or f"the geom in line {other.node.line}"
        if pair is not None and "friction" in pair:
            return Beaten("pair", f"{one.name} and {called}", True, fixed)
        if other.priority > one.priority:
            return Beaten("priority", called, True, fixed)
        acting = _USED.get(_condim(one, other, pair), len(_FRICTION))
        larger = all(b > a for a, b in zip(one.friction[:acting], other.friction[:acting], strict=True))
        if other.priority == one.priority and acting and larger:
            return Beaten(
                "larger", f"{called} ({' '.join(f'{x:g}' for x in other.friction[:acting])})", other.said, fixed
            )
        return None


def _condim(one: _Geom, other: _Geom, pair: dict[str, str] | None) -> int:
    if pair is not None and "condim" in pair:
        return _whole(pair["condim"], 3)
    if one.priority != other.priority:
        return one.condim if one.priority > other.priority else other.condim
    return max(one.condim, other.condim)


def _moving(body: Node | None) -> Node | None:
    """The body that a body is welded to: the nearest above with a joint; None for the world."""
    own = None if body is None else body.above()
    for one in own or ():
        if one.tag == "body" and (
            one.attributes.get("mocap") == "true" or any(child.tag in ("joint", "freejoint") for child in _within(one))
        ):
            return one
    return None


def _within(body: Node) -> list[Node]:
    """Elements of a body, those in frames among them."""
    found = list(body.children)
    for one in body.children:
        if one.tag == "frame":
            found += _within(one)
    return found
