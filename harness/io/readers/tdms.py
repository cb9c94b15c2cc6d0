"""LabVIEW's .tdms, by npTDMS (extra ``files``): groups of channels, each with its unit and the step of its waveform."""

from pathlib import Path

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.io.columns import word_of
from harness.io.reader import Reader
from harness.io.table import ArrayTable, held, on_one_clock, table_of_arrays

_UNITS = ("unit_string", "NI_UnitDescription", "unit")


def open_tdms(path: Path) -> ArrayTable:
    """The channels of numbers; waveforms of several steps on one clock. Raises InputError for a file that is none."""
    try:
        from nptdms import TdmsFile
    except ImportError:
        missing = "a .tdms file, and no library that reads one (an export as .lvm needs none)"
        raise InputError(str(path), missing, "try: pip install 'friction-harness[files]'") from None
    try:
        groups = TdmsFile.read(path).groups()
        found = [(group.name, one, np.asarray(one[:])) for group in groups for one in group.channels()]
    except MemoryError:
        raise
    except Exception as error:  # whatever the broken bytes lead the library to
        raise InputError(str(path), f"not a .tdms file ({error})", "a whole file of LabVIEW") from None
    arrays: dict[str, FloatArray] = {}
    times: dict[str, FloatArray] = {}
    for group, one, values in found:
        if values.dtype.kind not in "fiuM" or values.size < 2:
            continue
        unit = next((str(one.properties[key]) for key in _UNITS if one.properties.get(key)), "")
        name = (f"{group}: {one.name}" if len(groups) > 1 else one.name) + (f" [{unit}]" if unit else "")
        stamps = values.dtype.kind == "M"
        plain = (values - values[0]) / np.timedelta64(1, "s") if stamps else values
        arrays[name] = np.array(plain, dtype=np.float64)
        step = float(one.properties.get("wf_increment", 0.0))
        if step > 0.0:
            begun = float(one.properties.get("wf_start_offset", 0.0))
            times[name] = np.array(begun + step * np.arange(values.size), dtype=np.float64)
    if times and not any(word_of(name) == "t" for name in arrays):
        return on_one_clock(path, {name: (t, arrays[name]) for name, t in times.items()})
    return table_of_arrays(path, {name: held(values) for name, values in arrays.items()})


TDMS = Reader(name="LabVIEW .tdms", suffixes=(".tdms",), open=open_tdms)
