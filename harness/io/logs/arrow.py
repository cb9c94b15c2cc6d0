"""Parquet whose columns may be lists, one number a joint, read batch by batch."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import InputError
from harness.io.table import Table
from harness.io.units import split_header

ROWS = 1 << 16
"""Of a batch: what is in memory beside the columns that are asked for."""
WIDEST = 256
"""Numbers of a list that are columns; a picture is none."""


class ArrowTable(Table):
    """A Parquet file; a column of lists is as many columns as a list is long, NAME[0] and so on.

    names : of a list's elements, by column. ``keep`` : which rows are read; all where it is None.
    """

    def __init__(self, path: Path, names: Mapping[str, Sequence[str]] | None = None) -> None:
        import pyarrow as pa
        import pyarrow.parquet as pq

        try:
            self._file = pq.ParquetFile(path)
        except (pa.ArrowException, OSError) as error:
            accepted = "a readable Parquet file is accepted"
            raise InputError(str(path), f"not a Parquet file ({error})", accepted) from None
        self.keep: BoolArray | None = None
        self._source: list[tuple[str, int | None]] = []
        headers: list[str] = []
        for column in self._file.schema_arrow:
            if not _is_list(column.type):
                self._source.append((column.name, None))
                headers.append(column.name)
                continue
            width = self._width(path, column.name)
            given = list((names or {}).get(column.name, ()))
            labels = given if len(given) == width else [f"{column.name}[{k}]" for k in range(width)]
            self._source += [(column.name, k) for k in range(width)]
            headers += labels
        split = [split_header(header) for header in headers]
        units = {i: u for i, (_, u) in enumerate(split) if u is not None}
        super().__init__(path, [name for name, _ in split], units, headers)

    def _width(self, path: Path, name: str) -> int:
        """How many numbers the lists of a column hold, by the first of them; 0 where they are no numbers."""
        import pyarrow as pa

        kind = self._file.schema_arrow.field(name).type
        if not (pa.types.is_integer(kind.value_type) or pa.types.is_floating(kind.value_type)):
            return 0
        if pa.types.is_fixed_size_list(kind):
            width = int(kind.list_size)
        else:
            first = next(self._batches(path, name, 1), None)
            width = len(first[0].as_py() or ()) if first is not None and len(first) else 0
        return width if width <= WIDEST else 0

    def _batches(self, path: Path, name: str, size: int = ROWS) -> Iterator[Any]:
        """A column piece by piece."""
        import pyarrow as pa

        try:
            for batch in self._file.iter_batches(batch_size=size, columns=[name]):
                yield batch.column(0)
        except (pa.ArrowException, OSError) as error:
            accepted = "a readable Parquet file is accepted"
            raise InputError(f"{path}: column {name}", f"unreadable ({error})", accepted) from None

    def read(self, positions: Sequence[int]) -> list[FloatArray]:
        """See Table; each column of the file is read once."""
        wanted: dict[str, list[int | None]] = {}
        for i in positions:
            name, part = self._source[i]
            wanted.setdefault(name, []).append(part)
        found = {(name, part): v for name, parts in wanted.items() for part, v in self._columns(name, parts).items()}
        return [found[self._source[i]] for i in positions]

    def _columns(self, name: str, parts: list[int | None]) -> dict[int | None, FloatArray]:
        """A column of numbers, or elements of a column of lists; the rows that are kept."""
        import pyarrow as pa

        kind = self._file.schema_arrow.field(name).type
        number = kind.value_type if _is_list(kind) else kind
        where = f"{self.path}: row 1, column {name}"
        if not (pa.types.is_integer(number) or pa.types.is_floating(number) or pa.types.is_decimal(number)):
            raise InputError(where, f"a column of type {kind}", "a column of numbers is accepted")
        width = sum(source == name for source, _ in self._source) if _is_list(kind) else 1
        pieces: dict[int | None, list[FloatArray]] = {part: [] for part in parts}
        for batch in self._batches(self.path, name):
            numbers = batch.flatten() if _is_list(kind) else batch
            flat = numbers.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False)
            if flat.size != width * len(batch) or (_is_list(kind) and batch.null_count):
                accepted = f"lists of {width} numbers, as in the first row, are accepted"
                raise InputError(f"{self.path}: column {name}", "lists of several lengths", accepted)
            rows = flat.reshape(-1, width)
            for part, found in pieces.items():
                found.append(np.array(rows[:, part or 0]))
        whole = {part: np.concatenate(found) if found else np.empty(0) for part, found in pieces.items()}
        return whole if self.keep is None else {part: values[self.keep] for part, values in whole.items()}


def _is_list(kind: Any) -> bool:
    import pyarrow as pa

    return bool(pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind))
