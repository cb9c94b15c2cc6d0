"""What readers make of the words of a model's file: harness.words/1."""

from typing import ClassVar, Literal

from pydantic import Field

from harness.results.common import Paged, Result

Fate = Literal["read", "dropped", "unit", "meaning", "refused"]


class ReaderResult(Result):
    """An engine or importer that reads the format."""

    name: str
    title: str
    version: str = Field(description="that is installed, where it was run; else the one that is cited")
    evidence: Literal["motion", "cited"]
    source: str = Field(description="address of what is cited, and whether it was measured with that version")


class TakenResult(Result):
    """What a reader makes of a word."""

    fate: Fate = Field(description="unit: taken in another unit; meaning: taken as something else; refused: no file")
    note: str
    evidence: Literal["motion", "cited", "file"] = Field(description="file: the file itself settles it")
    measured: float | None = Field(description="value that acts over the one written, by motion; null where not run")


class WordResult(Result):
    """A word of the file, right or wrong."""

    name: str
    kind: Literal["friction", "damping", "armature", "spring", "servo", "contact", "solver"]
    value: str = Field(description="as it is written")
    unit: str = Field(description="of the format; empty for a word that no reader knows")
    place: str
    file: str
    line: int
    problem: str = Field(description="a sentence; empty where nothing is wrong")
    fix: str = Field(description="what to write; empty where nothing is wrong")
    note: str = Field(description="what is to be known of it; empty for nothing")
    readers: dict[str, TakenResult]


class DefaultResult(Result):
    """What acts in a reader where the file says nothing, or its word is dropped."""

    reader: str
    kinds: list[str]
    value: str
    mend: str = Field(description="what to write or call against it")


class WordsResult(Paged):
    """harness words."""

    LINES: ClassVar[str] = "words"

    schema_: Literal["harness.words/1"] = Field(default="harness.words/1", alias="schema")
    file: str
    format: Literal["mjcf", "urdf", "sdf", "usd"]
    readers: list[ReaderResult]
    words: list[WordResult]
    defaults: list[DefaultResult]
    wrong: int = Field(description="words with a problem")
    lost: int = Field(description="words that a reader which was asked for does not take as they are; 0 for none asked")
    unread: list[str] = Field(default=[], description="other models that the file names, whose words are not here")
    statement: str
