"""Tables in binary files: Parquet, HDF5, MATLAB .mat from v4 to 7.3, NumPy .npz. Nothing is read but what is asked for.

These readers run in a process of their own (harness.core.apart), where whatever a library does with damaged bytes ends.
"""

import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import InputError
from harness.io.reader import Reader
from harness.io.table import ArrayTable, Held, Table, held, table_of_arrays
from harness.io.units import split_headers

_READABLE = "a readable Parquet file"
_WIDEST = 256
"""Numbers of a list that are columns; a picture is none."""
_A_SECOND = {"s": 1, "ms": 1_000, "us": 1_000_000, "ns": 1_000_000_000}


class ParquetTable(Table):
    """A Parquet file; fields of structs have dotted names; a column of lists is as many columns as its first list is
    long, NAME[0] and so on; one of maps a column for each key of its first.

    names : of a list's elements, by column. ``keep`` : which rows are read; all where it is None.
    """

    def __init__(self, path: Path, names: Mapping[str, Sequence[str]] | None = None) -> None:
        import pyarrow as pa
        import pyarrow.parquet as pq

        self.keep: BoolArray | None = None
        self._source: list[tuple[str, int]] = []
        self._leaves: dict[str, tuple[tuple[str, ...], Any]] = {}
        self._keys: dict[str, list[Any]] = {}
        headers: list[str] = []
        try:
            self._file = pq.ParquetFile(path)
            for way, kind in _leaves((), self._file.schema_arrow):
                name = ".".join(way)
                self._leaves[name] = way, kind
                given = list((names or {}).get(name, ()))
                if pa.types.is_map(kind):
                    self._keys[name] = self._keys_of(name)
                    given = [f"{name}.{key}" for key in self._keys[name]]
                elif not _is_list(kind):
                    given = [name]
                elif len(given) != (many := self._width(name)):
                    given = [f"{name}[{k}]" for k in range(many)]
                self._source += [(name, k) for k in range(len(given))]
                headers += given
        except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
            raise InputError(str(path), f"not a Parquet file ({error})", _READABLE) from None
        super().__init__(path, *split_headers(headers), headers)

    def _width(self, name: str) -> int:
        """How many numbers the lists of a column hold, by the first of them: 0 for a picture."""
        import pyarrow as pa

        kind = self._leaves[name][1]
        if not (pa.types.is_integer(kind.value_type) or pa.types.is_floating(kind.value_type)):
            return 0
        many = len(self._first(name))
        return many if many <= _WIDEST else 0

    def _keys_of(self, name: str) -> list[Any]:
        """The keys of the first map of a column of maps of numbers."""
        import pyarrow as pa

        kind = self._leaves[name][1].item_type
        if not (pa.types.is_integer(kind) or pa.types.is_floating(kind)):
            return []
        return list(dict(self._first(name)))[:_WIDEST]

    def _first(self, name: str) -> Any:
        """The first list or map of a column; an empty one where there is none."""
        first = next(self._file.iter_batches(batch_size=1, columns=[name]), None)
        return (_within(first.column(0), self._leaves[name][0])[0].as_py() or ()) if first else ()

    def read(self, positions: Sequence[int]) -> list[FloatArray]:
        """See Table; each column of the file is read once."""
        columns = {name: self._column(name) for name in dict.fromkeys(self._source[i][0] for i in positions)}
        found = [columns[name][:, part] for name, part in (self._source[i] for i in positions)]
        return found if self.keep is None else [values[self.keep] for values in found]

    def _column(self, name: str) -> FloatArray:
        """A column of the file, (n, 1), or of so many as its lists are long or its maps have keys."""
        import pyarrow as pa
        import pyarrow.compute as pc

        (way, kind), where = self._leaves[name], f"{self.path}: row 1, column {name}"
        lists = _is_list(kind)
        keys = self._keys.get(name)
        number = kind.value_type if lists else kind if keys is None else kind.item_type
        stamps = pa.types.is_timestamp(kind) or pa.types.is_duration(kind) or pa.types.is_time(kind)
        if not (pa.types.is_integer(number) or pa.types.is_floating(number) or pa.types.is_decimal(number) or stamps):
            raise InputError(where, f"a column of type {kind}", "a column of numbers")
        at = [i for i, (source, _) in enumerate(self._source) if source == name]
        try:
            column = _within(self._file.read(columns=[name]).column(0), way)
            rows = len(column)
            if keys is not None:
                maps = column.combine_chunks()
                column = pa.chunked_array([pc.map_lookup(maps, pa.scalar(k, kind.key_type), "first") for k in keys])
                return _numbers(column).reshape(len(keys), rows).T
            column = pc.list_flatten(column) if lists else self._from_first(at[0], column) if stamps else column
            flat = _numbers(column)
        except (pa.ArrowException, OSError) as error:
            raise InputError(where, f"unreadable ({error})", _READABLE) from None
        if flat.size != rows * len(at):
            accepted = f"lists of {len(at)} numbers, as in the first row"
            raise InputError(f"{self.path}: column {name}", "lists of several lengths", accepted)
        return flat.reshape(-1, len(at))

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


def _numbers(column: Any) -> FloatArray:
    import pyarrow as pa

    return np.asarray(column.cast(pa.float64(), safe=False).to_numpy(), dtype=np.float64)


def _leaves(before: tuple[str, ...], fields: Any) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Columns of a schema or a struct, with the names on the way to each and its type; those of structs are within."""
    import pyarrow as pa

    for field in fields:
        way = (*before, field.name)
        if pa.types.is_struct(field.type):
            yield from _leaves(way, field.type)
        else:
            yield way, field.type


def _within(column: Any, way: tuple[str, ...]) -> Any:
    """The values of a field of a column of structs; of a column itself where the way has no more names."""
    import pyarrow.compute as pc

    for name in way[1:]:
        column = pc.struct_field(column, name)
    return column


def _is_list(kind: Any) -> bool:
    import pyarrow as pa

    return bool(pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind))


def _flatten(prefix: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Fields of MATLAB structs as dotted names, structs of an array by their numbers; one that says the name of its
    data, as those of dSPACE's ControlDesk do, by that name and unit.
    """
    from scipy.io.matlab import mat_struct

    if isinstance(value, mat_struct):
        said, unit = getattr(value, "Name", None), getattr(value, "Unit", None)
        if "Data" in value._fieldnames and isinstance(said, str) and said:
            yield said.replace('"', "") + (f" [{unit}]" if isinstance(unit, str) and unit else ""), value.Data
            return
        for field in value._fieldnames:
            yield from _flatten(f"{prefix}.{field}", getattr(value, field))
    elif isinstance(value, np.ndarray) and value.dtype == object:
        for number, one in enumerate(value.ravel(), 1):
            yield from _flatten(f"{prefix}{number}", one)
    else:
        yield prefix, value


def _hdf5_arrays(path: Path, matlab: bool = True) -> dict[str, Held]:
    """Numeric data sets of a file, groups as dotted names, with units that their attributes say.

    matlab : of MATLAB 7.3, which stores the transpose.
    """
    import h5py

    arrays: dict[str, Held] = {}

    def visit(name: str, item: Any) -> None:
        if not isinstance(item, h5py.Dataset) or name.startswith("#") or "MATLAB_empty" in item.attrs:
            return
        kind = item.attrs.get("MATLAB_class", b"")
        if isinstance(kind, bytes) and kind in (b"char", b"cell"):
            return
        unit = next((one for word in ("unit", "units") if isinstance(one := item.attrs.get(word), str)), "")
        key, shape = name.replace("/", "."), tuple(item.shape or ())
        for part in item.dtype.names or ("",):
            label = ".".join(filter(None, (key, part))) + (f" [{unit}]" if unit else "")
            kind = item.dtype[part] if part else item.dtype
            arrays[label] = Held(shape[::-1] if matlab else shape, kind, partial(_hdf5_array, path, name, part, matlab))

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    return arrays


def _hdf5_array(path: Path, name: str, part: str, matlab: bool) -> Any:
    """One data set, or a field of its records. Raises InputError for one whose numbers are those of another file."""
    import h5py

    with h5py.File(path, "r") as file:
        item = file[name]
        if item.external or item.is_virtual:
            raise InputError(f"{path}: {name}", "kept in another file", "a data set kept in this file")
        values = np.asarray(item[()])[part] if part else np.asarray(item[()])
        return values.T if matlab else values


def open_hdf5(path: Path) -> ArrayTable:
    """Open an HDF5 file."""
    try:
        return table_of_arrays(path, _hdf5_arrays(path, matlab=False))
    except (InputError, MemoryError):
        raise
    except Exception as error:  # HDF5's parser raises whatever the broken bytes lead it to
        raise InputError(str(path), f"not an HDF5 file ({error})", "a whole HDF5 file") from None


def open_mat(path: Path) -> ArrayTable:
    """Open a MATLAB file of any version."""
    accepted = "a MATLAB file of version 4 to 7.3"
    try:
        import h5py
        import scipy.io

        with path.open("rb") as file:
            is_hdf5 = file.read(128).startswith(b"MATLAB 7.3")
        if is_hdf5 or h5py.is_hdf5(path):
            return table_of_arrays(path, _hdf5_arrays(path))
        content = scipy.io.loadmat(path, struct_as_record=False, squeeze_me=True)
    except (InputError, MemoryError):
        raise
    except Exception as error:  # SciPy's and HDF5's parsers raise whatever the broken bytes lead them to
        raise InputError(str(path), f"not a MATLAB file ({error})", accepted) from None
    if any("MatlabOpaque" in type(value).__name__ or value is None for value in content.values()):
        found, accepted = "a MATLAB table or timetable", "a struct of it, saved: s = table2struct(T,'ToScalar',true)"
        raise InputError(str(path), found, accepted)
    arrays = {k: v for key, value in content.items() if not key.startswith("__") for k, v in _flatten(key, value)}
    return table_of_arrays(path, {name: held(value) for name, value in arrays.items()})


def open_npz(path: Path) -> ArrayTable:
    """Open a NumPy archive; pickled objects are refused."""
    return table_of_arrays(path, _of_npz(path, _npy_arrays, path))


def open_npy(path: Path) -> ArrayTable:
    """Open a NumPy array, a column for each of its columns; pickled objects are refused."""
    return table_of_arrays(path, {"data": held(_of_npz(path, partial(np.load, allow_pickle=False), path))})


def _of_npz(path: Path, read: Callable[..., Any], *arguments: Any) -> Any:
    """What ``read`` finds; InputError for what the libraries of archives and of packing say of damage."""
    try:
        return read(*arguments)
    except (InputError, MemoryError):
        raise
    except Exception as error:  # zlib, bz2, lzma, zipfile and NumPy have each their own
        accepted = "numeric arrays saved by numpy.savez"
        raise InputError(str(path), f"not an .npz archive ({error})", accepted) from None


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
                accepted = "an archive of numeric arrays"
                raise InputError(f"{path}: {name}", "pickled Python objects, which could run a program", accepted)
            arrays[name] = Held(shape, dtype, partial(_of_npz, path, _npy_array, path, name))
    return arrays


def _npy_array(path: Path, name: str) -> Any:
    with np.load(path, allow_pickle=False) as archive:
        return archive[name]


HDF5 = Reader(name="HDF5", suffixes=(".h5", ".hdf5", ".hdf"), open=open_hdf5)
MAT = Reader(name="MATLAB", suffixes=(".mat",), open=open_mat)
NPZ = Reader(name="NumPy", suffixes=(".npz",), open=open_npz)
NPY = Reader(name="a NumPy array", suffixes=(".npy",), open=open_npy)
PARQUET = Reader(name="Parquet", suffixes=(".parquet", ".pq"), open=ParquetTable)
