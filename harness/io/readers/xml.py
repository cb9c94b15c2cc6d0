"""Files of programs that keep their measurements as XML: CASSY Lab (.labx), and Vernier's Logger Pro (.cmbl) and
Graphical Analysis (.gambl, a tar archive with it), in which each run is a set of columns.
"""

import tarfile
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.core.bounded import MOST_BYTES, read_bytes
from harness.core.errors import InputError
from harness.io.reader import Reader
from harness.io.table import ArrayTable, Held, held, table_of_arrays

if TYPE_CHECKING:
    from lxml.etree import _Element

_MEMBER = "data.udm"
"""Of a .gambl archive, that holds the measurements."""


def _root(path: Path, data: bytes) -> "_Element":
    """Raises InputError for what is no XML."""
    from lxml import etree

    try:
        # no entity is resolved, nothing is fetched
        return etree.fromstring(data, etree.XMLParser(resolve_entities=False, no_network=True))
    except (etree.XMLSyntaxError, ValueError) as error:
        raise InputError(str(path), f"no whole XML ({error})", "a file as its program saved it") from None


def _number(text: str | None) -> float:
    try:
        return float((text or "nan").replace(",", "."))
    except ValueError:
        return float("nan")  # a sample that the sensor missed


def _named(name: str, unit: str | None) -> str:
    return name.strip() + (f" [{unit.strip()}]" if unit and unit.strip() else "")


def open_labx(path: Path) -> ArrayTable:
    """The channels of a file of CASSY Lab, each with its quantity, symbol and unit. Raises InputError for no XML."""
    channels: dict[str, Held] = {}
    for one in _root(path, read_bytes(path)).iter("channel"):
        values = [_number(value.text) for value in one.iterfind("values/value")]
        name = _named(f"{one.findtext('quantity') or ''} {one.findtext('symbol') or ''}", one.findtext("unit"))
        if len(values) > 1:
            channels[name if name not in channels else f"{name}#{len(channels)}"] = held(np.array(values))
    return table_of_arrays(path, channels)


def open_vernier(path: Path) -> ArrayTable:
    """The columns of every run of a file of Vernier's; each is called by its run. Raises InputError for none of it."""
    data = read_bytes(path)
    channels: dict[str, Held] = {}
    for run, one in enumerate(_root(path, _member(path, data) or data).iter("DataSet"), 1):
        for name, values in _columns(one):
            if values.size > 1:
                channels[f"Run {run}: {name}"] = held(values)
    return table_of_arrays(path, channels)


def _columns(run: "_Element") -> Iterator[tuple[str, np.ndarray]]:
    for one in run.iter("DataColumn"):
        cells = (one.findtext("ColumnCells") or "").split("\n")
        values = [_number(cell) for cell in cells if cell.strip()]
        yield _named(one.findtext("DataObjectName") or "", one.findtext("ColumnUnits")), np.array(values)


def _member(path: Path, data: bytes) -> bytes | None:
    """The measurements of an archive; None where it is none. Raises InputError for one that is damaged or too large."""
    try:
        with tarfile.open(fileobj=BytesIO(data)) as archive:
            found = next((one for one in archive if one.isfile() and one.name.endswith(_MEMBER)), None)
            file = archive.extractfile(found) if found is not None else None
            if found is None or file is None or found.size > MOST_BYTES:
                raise InputError(str(path), f"an archive without {_MEMBER}", "a whole .gambl file")
            return file.read(found.size)
    except (tarfile.TarError, EOFError):
        return None


LABX = Reader(name="CASSY Lab", suffixes=(".labx",), open=open_labx)
VERNIER = Reader(name="Logger Pro, Graphical Analysis", suffixes=(".cmbl", ".gambl"), open=open_vernier)
