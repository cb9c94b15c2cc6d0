"""XML of a robot's model, read within bounds: no document type, no entities, files of its own folder alone."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from lxml import etree

from harness.core.bounded import MEBIBYTE, check_file, read_bytes
from harness.core.errors import InputError

MOST_BYTES = 16 * MEBIBYTE
"""Of one file: a robot's model is text of some thousand lines."""
MOST_FILES = 50
"""Files that a model may include."""


@dataclass(frozen=True, slots=True)
class Source:
    """A file of a model. path : where it lies. text : as it stands there. root : of its tree, an lxml element."""

    path: Path
    text: str
    root: Any


def read_xml(path: Path, edited: Mapping[Path, str] = MappingProxyType({})) -> Source:
    """One file; edited : by resolved path, texts that take the place of what a file holds.

    Raises InputError when there is none, it is too large, is no XML, or has a document type, which a model does not
    need and entities would come in by.
    """
    check_file(path, accepted="a robot's model, MJCF or URDF, is accepted")
    other = edited.get(path.resolve())
    data = read_bytes(path, MOST_BYTES) if other is None else other.encode()
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
    try:
        tree = etree.fromstring(data, parser).getroottree()
        text = data.decode(tree.docinfo.encoding or "utf-8") if other is None else other
    except (etree.XMLSyntaxError, UnicodeDecodeError, LookupError) as error:
        raise InputError(str(path), f"no XML ({error})", "a robot's model, MJCF or URDF, is accepted") from None
    if tree.docinfo.doctype or tree.docinfo.internalDTD is not None:
        raise InputError(str(path), "a document type, by which entities come in", "a model without one is accepted")
    return Source(path, text, _plain(tree.getroot()))


def with_included(path: Path, edited: Mapping[Path, str] = MappingProxyType({})) -> tuple[Source, ...]:
    """A model's file and those that it includes (MJCF), which are put into the first one's tree; edited : as there.

    Raises InputError as ``read_xml`` does, for an included file outside the folder of the first, and for one that is
    included twice.
    """
    first = read_xml(path, edited)
    found = [first]
    folder = path.resolve().parent
    seen = {path.resolve()}
    while (element := next(first.root.iter("include"), None)) is not None:
        name = element.get("file") or ""
        file = (folder / name).resolve()
        where = f"{path}: include {name or 'without a file'}"
        if not file.is_relative_to(folder):
            raise InputError(where, "a file outside the model's folder", "one that lies in it is accepted")
        if file in seen or len(found) > MOST_FILES:
            raise InputError(where, "a file included before", f"each once, and at most {MOST_FILES}, is accepted")
        check_file(file, where)
        source = read_xml(file, edited)
        seen.add(file)
        found.append(source)
        at, parent = element.getparent().index(element), element.getparent()
        parent[at : at + 1] = list(read_xml(file, edited).root)
    return tuple(found)


def _plain(element: Any) -> Any:
    """An element as MuJoCo's and PyBullet's parsers see it, which know nothing of name spaces: by the name that stands
    there. What has a prefix, comments and text are nothing to them and are left out.
    """
    values = {name: value for name, value in element.attrib.items() if not name.startswith("{")}
    found = etree.Element(etree.QName(element).localname, values)
    found.extend([_plain(child) for child in element.iterchildren(tag=etree.Element) if child.prefix is None])
    return found
