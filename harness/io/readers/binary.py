"""Tables in binary files: Parquet, MATLAB .mat from v4 to 7.3, NumPy .npz. Nothing is read but what is asked for.

These readers run in a process of their own (harness.core.apart), where whatever a library does with damaged bytes ends.
"""

import zipfile
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.io.reader import Reader
from harness.io.table import ArrayTable, Held, Table, held, table_of_arrays
from harness.io.units import split_header

_A_SECOND = {"s": 1, "ms": 1_000, "us": 1_000_000, "ns": 1_000_000_000}


class ParquetTable(Table):
    """A Parquet file."""

    def __init__(self, path: Path) -> None:
        import pyarrow as pa
        import pyarrow.parquet as pq

        try:
            self._file = pq.ParquetFile(path)
            headers = list(self._file.schema_arrow.names)
        except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
            raise InputError(
                str(path), f"not a Parquet file ({error})", "a readable Parquet file is accepted"
            ) from None
        split = [split_header(header) for header in headers]
        units = {i: u for i, (_, u) in enumerate(split) if u is not None}
        super().__init__(path, [name for name, _ in split], units, headers)
        self._headers = headers

    def read(self, positions: Sequence[int]) -> list[FloatArray]:
        """See Table."""
        import pyarrow as pa

        columns = []
        for i in positions:
            where = f"{self.path}: row 1, column {self.names[i]}"
            kind = self._file.schema_arrow.field(i).type
            stamps = pa.types.is_timestamp(kind) or pa.types.is_duration(kind) or pa.types.is_time(kind)
            if not (pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_decimal(kind) or stamps):
                raise InputError(where, f"a column of type {kind}", "a column of numbers is accepted")
            try:
                column = self._file.read(columns=[self._headers[i]]).column(0)
                column = self._from_first(i, column) if stamps else column.cast(pa.float64(), safe=False)
            except (pa.ArrowException, OSError) as error:
                raise InputError(where, f"unreadable ({error})", "a readable Parquet file is accepted") from None
            columns.append(np.asarray(column.to_numpy(), dtype=np.float64))
        return columns

    def _from_first(self, position: int, column: Any) -> Any:
        """Time stamps, times of day and spans as seconds from the first; whole numbers are subtracted, so that none of
        their digits is lost.
        """
        import pyarrow as pa
        import pyarrow.compute as pc

        unit = column.type.unit
        counts = column.cast(pa.int32() if pa.types.is_time32(column.type) else pa.int64()).cast(pa.int64())
        first = next((one.as_py() for one in counts if one.is_valid), 0)
        dated = pa.types.is_timestamp(column.type)
        self.dated[position] = str(np.datetime64(first, unit)) if dated else f"{first / _A_SECOND[unit]:.9g} s"
        return pc.multiply(pc.subtract(counts, first).cast(pa.float64()), 1.0 / _A_SECOND[unit])


def _flatten(prefix: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Fields of MATLAB structs as dotted names."""
    from scipy.io.matlab import mat_struct

    if isinstance(value, mat_struct):
        for field in value._fieldnames:
            yield from _flatten(f"{prefix}.{field}", getattr(value, field))
    else:
        yield prefix, value


def _hdf5_arrays(path: Path) -> dict[str, Held]:
    """Numeric data sets of a MATLAB 7.3 file, groups as dotted names; MATLAB stores the transpose."""
    import h5py

    arrays: dict[str, Held] = {}

    def visit(name: str, item: Any) -> None:
        if not isinstance(item, h5py.Dataset) or name.startswith("#") or "MATLAB_empty" in item.attrs:
            return
        kind = item.attrs.get("MATLAB_class", b"")
        if isinstance(kind, bytes) and kind in (b"char", b"cell"):
            return
        key = name.replace("/", ".")
        arrays[key] = Held(tuple(item.shape or ())[::-1], item.dtype, partial(_hdf5_array, path, name))

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    return arrays


def _hdf5_array(path: Path, name: str) -> Any:
    """One data set. Raises InputError for one whose numbers are those of another file of this machine."""
    import h5py

    with h5py.File(path, "r") as file:
        item = file[name]
        if item.external or item.is_virtual:
            raise InputError(f"{path}: {name}", "kept in another file", "a data set kept in this file is accepted")
        return np.asarray(item[()]).T


def open_mat(path: Path) -> ArrayTable:
    """Open a MATLAB file of any version."""
    accepted = "a MATLAB file of version 4 to 7.3 is accepted"
    try:
        with path.open("rb") as file:
            is_hdf5 = file.read(128).startswith(b"MATLAB 7.3") or _hdf5_signature(path)
        if is_hdf5:
            return table_of_arrays(path, _hdf5_arrays(path))
        import scipy.io

        content = scipy.io.loadmat(path, struct_as_record=False, squeeze_me=True)
    except (InputError, MemoryError):
        raise
    except Exception as error:  # SciPy's and HDF5's parsers raise whatever the broken bytes lead them to
        raise InputError(str(path), f"not a MATLAB file ({error})", accepted) from None
    arrays = {k: v for key, value in content.items() if not key.startswith("__") for k, v in _flatten(key, value)}
    return table_of_arrays(path, {name: held(value) for name, value in arrays.items()})


def _hdf5_signature(path: Path) -> bool:
    import h5py

    return bool(h5py.is_hdf5(path))


def open_npz(path: Path) -> ArrayTable:
    """Open a NumPy archive; pickled objects are refused."""
    return table_of_arrays(path, _of_npz(path, _npy_arrays, path))


def _of_npz(path: Path, read: Callable[..., Any], *arguments: Any) -> Any:
    """What ``read`` finds; InputError for what the libraries of archives and of packing say of damage."""
    try:
        return read(*arguments)
    except (InputError, MemoryError):
        raise
    except Exception as error:  # zlib, bz2, lzma, zipfile and NumPy have each their own
        raise InputError(
            str(path), f"not an .npz archive ({error})", "numeric arrays saved by numpy.savez are accepted"
        ) from None


def _npy_arrays(path: Path) -> dict[str, Held]:
    """The arrays of an archive, by their headers alone."""
    arrays = {}
    with zipfile.ZipFile(path) as archive:
        for entry in archive.namelist():
            name = entry.removesuffix(".npy")
            with archive.open(entry) as file:
                version = np.lib.format.read_magic(file)
                one = version == (1, 0)
                read = np.lib.format.read_array_header_1_0 if one else np.lib.format.read_array_header_2_0
                shape, _, dtype = read(file)
            if dtype.hasobject:
                accepted = "an archive of numeric arrays is accepted"
                raise InputError(f"{path}: {name}", "pickled Python objects, which could run a program", accepted)
            arrays[name] = Held(shape, dtype, partial(_of_npz, path, _npy_array, path, name))
    return arrays


def _npy_array(path: Path, name: str) -> Any:
    with np.load(path, allow_pickle=False) as archive:
        return archive[name]


MAT = Reader(name="MATLAB", suffixes=(".mat",), open=open_mat)
NPZ = Reader(name="NumPy", suffixes=(".npz",), open=open_npz)
PARQUET = Reader(name="Parquet", suffixes=(".parquet", ".pq"), open=ParquetTable)
