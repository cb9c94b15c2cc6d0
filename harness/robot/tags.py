"""Attributes of one element changed in the text of an XML file, and nothing else of the text."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from xml.sax.saxutils import escape, unescape

_TOKEN = re.compile(
    r"<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>|<(?P<close>/)?(?P<name>[^\s/>!?]+)(?P<rest>(?:[^>\"']|\"[^\"]*\"|'[^']*')*)>",
    re.DOTALL,
)
_ATTRIBUTE = re.compile(r"(?P<space>\s+)(?P<name>[^\s=]+)\s*=\s*(?P<quote>[\"'])(?P<value>.*?)(?P=quote)", re.DOTALL)
_QUOTES = {"&quot;": '"', "&apos;": "'"}


@dataclass(frozen=True, slots=True)
class Tag:
    """A start tag. way : names of the elements it stands in and its own. begin, end : where in the text. attributes :
    as they are meant. empty : it has no content.
    """

    way: tuple[str, ...]
    begin: int
    end: int
    attributes: Mapping[str, str]
    empty: bool


def tags(text: str) -> Iterator[Tag]:
    """Every start tag of a well-formed text, in order."""
    way: list[str] = []
    for found in _TOKEN.finditer(text):
        if found["name"] is None:
            continue
        if found["close"]:
            way.pop()
            continue
        rest = found["rest"]
        attributes = {one["name"]: unescape(one["value"], _QUOTES) for one in _ATTRIBUTE.finditer(rest)}
        empty = rest.endswith("/")
        yield Tag((*way, found["name"]), found.start(), found.end(), attributes, empty)
        if not empty:
            way.append(found["name"])


def with_attributes(text: str, tag: Tag, values: Mapping[str, str]) -> str:
    """The text with these attributes of a tag, which are changed where they stand or put behind the others."""
    own, left = text[tag.begin : tag.end], dict(values)

    def changed(found: re.Match[str]) -> str:
        name = found["name"]
        if name not in left:
            return found[0]
        return f"{found['space']}{name}={_quoted(left.pop(name))}"

    own = _ATTRIBUTE.sub(changed, own)
    more = "".join(f" {name}={_quoted(value)}" for name, value in left.items())
    at = re.search(r"\s*/?>$", own)
    assert at is not None
    return text[: tag.begin] + own[: at.start()] + more + own[at.start() :] + text[tag.end :]


def with_child(text: str, tag: Tag, child: str) -> str:
    """The text with an element put first into a tag's content, on a line of its own."""
    line = text[text.rfind("\n", 0, tag.begin) + 1 : tag.begin]
    indent = line if line.isspace() else ""
    if not tag.empty:
        return f"{text[: tag.end]}\n{indent}  {child}{text[tag.end :]}"
    own = re.sub(r"\s*/>$", ">", text[tag.begin : tag.end])
    return f"{text[: tag.begin]}{own}\n{indent}  {child}\n{indent}</{tag.way[-1]}>{text[tag.end :]}"


def _quoted(value: str) -> str:
    return f'"{escape(value, {chr(34): "&quot;"})}"'
