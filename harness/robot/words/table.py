"""The table of words (words.toml): where each may stand, its unit, and what each reader makes of it."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path
from typing import Any, Final, Literal, TypeAlias, get_args

Form: TypeAlias = Literal["mjcf", "urdf", "sdf", "usd"]
Kind: TypeAlias = Literal["friction", "damping", "armature", "spring", "servo", "contact", "solver"]
Fate: TypeAlias = Literal["read", "dropped", "unit", "meaning", "refused"]
FORMS: Final[tuple[Form, ...]] = get_args(Form)
_OF_BODIES = ("default", "frame", "replicate", "worldbody")


@dataclass(frozen=True, slots=True)
class Taken:
    """What a reader makes of a word. note : how, or ""."""

    fate: Fate
    note: str = ""


DROPPED: Final = Taken("dropped")


@dataclass(frozen=True, slots=True)
class Probe:
    """A text that goes into ``slot`` of a test model, and the value it gives a hinge."""

    slot: str
    text: str
    value: float


@dataclass(frozen=True, slots=True)
class Word:
    """A word of a format.

    at : the elements that hold it, each with its parent ("joint/dynamics"). name : of the attribute, of a child element
    (element), or a pattern for a USD attribute. unit : as the format has it. count : numbers, at most. polynomial : it
    is that word with a number behind the first, which readers take otherwise. negative : whether they may be. cells :
    by reader; one that is not in it drops the word.
    """

    form: Form
    at: tuple[str, ...]
    name: str
    kind: Kind
    unit: str
    count: int
    negative: bool
    element: bool
    polynomial: bool
    probe: Probe | None
    cells: Mapping[str, Taken]

    @property
    def key(self) -> str:
        """Unique in its format: "joint/dynamics damping"."""
        return f"{self.at[0]} {self.name}{' polynomial' * self.polynomial}" if self.at else self.name

    @property
    def called(self) -> str:
        """As a file calls it: by its element, where that has a value and nothing else."""
        return self.at[0].rpartition("/")[2] if self.name == "value" else self.name

    def stands(self, way: tuple[str, ...]) -> bool:
        """Whether an element that holds the word may be at the end of ``way``, the names from the root down."""
        parents: tuple[str, ...] = (way[-2],) if len(way) > 1 else ("",)
        if parents == ("mujocoinclude",):  # it may be included anywhere
            parents = tuple(one.rpartition("/")[0] for one in self.at)
        if self.form == "mjcf" and parents[0] in _OF_BODIES:
            parents = (*parents, "body", *(one.partition("/")[0] for one in self.at if parents[0] == "default"))
            way = (*way[:-1], "fixed") if way[-1] == "tendon" else way
        return any(
            fnmatchcase("/".join((*way[-1 - one.count("/") : -2], parent, way[-1])), one)
            or (one == way[-1] and len(way) < 3)
            for one in self.at
            for parent in parents
        )

    def taken(self, reader: str) -> Taken:
        return self.cells.get(reader, DROPPED)

    def written(self, value: str = "...", of: str = "NAME") -> str:
        """The word where it belongs; of : the link or joint that it is of, where the word's element names it."""
        if self.form == "usd":
            return f"{self.name} = {value}"
        inner, *outer = reversed(self.at[0].split("/"))
        named = f'{inner} reference="{of}"' if inner == "gazebo" else inner
        own = f"<{named}><{self.name}>{value}</{self.name}></{inner}>" if self.element else ""
        own = own or f'<{inner} {self.name}="{value}"/>'
        within = " of ".join(f"<{one}>" for one in outer)
        return f"{own} in {within}" if within not in ("", "<body>") else own


@dataclass(frozen=True, slots=True)
class Reader:
    """An engine or importer. parser : those of one parser refuse alike. package : on whose presence it can be run."""

    name: str
    title: str
    version: str
    formats: tuple[Form, ...]
    parser: str
    source: str
    package: str = ""


@dataclass(frozen=True, slots=True)
class Default:
    """What acts in a reader where a file says nothing of these kinds. mend : what to write or call against it."""

    reader: str
    kinds: tuple[Kind, ...]
    value: str
    mend: str


@dataclass(frozen=True, slots=True)
class Table:
    """Readers by name, defaults, words by format."""

    readers: Mapping[str, Reader]
    defaults: tuple[Default, ...]
    words: Mapping[Form, tuple[Word, ...]]

    def of(self, form: Form) -> tuple[Reader, ...]:
        """Readers of a format."""
        return tuple(one for one in self.readers.values() if form in one.formats)

    def common(self, form: Form, kind: Kind) -> Word | None:
        """The word of a kind that most readers of a format take, the first of those: the usual one."""
        own = [one for one in self.words[form] if one.kind == kind]
        return max(
            own, key=lambda one: sum(taken.fate in ("read", "unit") for taken in one.cells.values()), default=None
        )


@cache
def table() -> Table:
    """All of it."""
    text = Path(__file__).with_name("words.toml").read_text(encoding="utf-8")
    data = tomllib.loads(text)
    readers = {
        name: Reader(name, **{**given, "formats": tuple(given["formats"])}) for name, given in data["reader"].items()
    }
    defaults = tuple(Default(**{**one, "kinds": tuple(one["kinds"])}) for one in data["default"])
    return Table(readers, defaults, {form: tuple(_word(form, one, readers) for one in data[form]) for form in FORMS})


def _word(form: Form, given: Mapping[str, Any], readers: Mapping[str, Reader]) -> Word:
    cells = {}
    for name in readers.keys() & given.keys():
        fate, _, note = given[name].partition(":")
        cells[name] = Taken(fate, note.strip())
    probe = None
    if "probe" in given:
        slot, text, value = (part.strip() for part in given["probe"].split("|"))
        probe = Probe(slot, text, float(value))
    return Word(
        form,
        tuple(given.get("at", ())),
        given["name"],
        given["kind"],
        given["unit"],
        given.get("count", 1),
        given.get("negative", False),
        given.get("element", False),
        given.get("polynomial", False),
        probe,
        cells,
    )
