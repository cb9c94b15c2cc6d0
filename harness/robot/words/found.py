"""A word of a model's file, as it was found there."""

from dataclasses import dataclass
from pathlib import Path

from harness.robot.words.read import Node
from harness.robot.words.table import DROPPED, Kind, Taken, Word


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
