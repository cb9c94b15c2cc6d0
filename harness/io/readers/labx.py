"""CASSY Lab's own files (.labx): XML in which each channel has its quantity, symbol, unit and values."""

from pathlib import Path

import numpy as np

from harness.core.errors import InputError
from harness.io.reader import Reader
from harness.io.table import ArrayTable, Held, held, table_of_arrays


def open_labx(path: Path) -> ArrayTable:
    """The channels of a file. Raises InputError for one that is none of CASSY Lab's."""
    from lxml import etree

    try:
        # no entity is resolved, nothing is fetched
        parser = etree.XMLParser(resolve_entities=False, no_network=True)
        root = etree.parse(str(path), parser).getroot()
        channels: dict[str, Held] = {}
        for one in root.iter("channel"):
            values = [float(value.text or "nan") for value in one.iterfind("values/value")]
            unit, symbol = one.findtext("unit") or "", one.findtext("symbol") or ""
            name = f"{one.findtext('quantity') or ''} {symbol}".strip() + (f" [{unit}]" if unit.strip() else "")
            if len(values) > 1:
                channels[name if name not in channels else f"{name}#{len(channels)}"] = held(np.array(values))
    except (etree.XMLSyntaxError, OSError, ValueError) as error:
        raise InputError(str(path), f"not a file of CASSY Lab ({error})", "a whole .labx file is accepted") from None
    return table_of_arrays(path, channels)


LABX = Reader(name="CASSY Lab", suffixes=(".labx",), open=open_labx)
