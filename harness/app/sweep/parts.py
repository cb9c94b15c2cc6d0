"""Rows of a sweep on disk: Parquet parts that are written whole, read one by one, and set aside when damaged."""

import json
import os
import threading
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from harness.core.errors import HarnessError, StoreError
from harness.core.writing import explained, replacing, sweep
from harness.engines.registry import load
from harness.fidelity.row import Bundle, Spec, failed, run_row, run_rows

_load = cache(load)
_one_at_a_time = threading.Lock()
"""Engines speak through descriptors that belong to the process; a cluster's worker may have several threads."""


def compute(spec: Spec) -> dict[str, Any]:
    """The row of a spec as plain data; whatever goes wrong is in the row."""
    with _one_at_a_time:
        try:
            engine = _load(spec.engine)
        except HarnessError as error:
            return failed(spec, str(error)).model_dump()
        found = engine.version()
        if found != spec.version:
            return failed(spec, f"this worker has {spec.engine} {found}, not {spec.version}").model_dump()
        return run_row(engine, spec).model_dump()


def computed(bundle: Bundle, one: Callable[[Spec], dict[str, Any]] = compute) -> list[dict[str, Any]]:
    """The rows of a bundle; ``one`` makes that of a single spec."""
    if len(bundle.specs) == 1:
        return [one(bundle.specs[0])]
    with _one_at_a_time:
        try:
            return [row.model_dump() for row in run_rows(_load(bundle.specs[0].engine), bundle.specs)]
        except HarnessError as error:
            return lost(bundle, str(error))


def lost(bundle: Bundle, why: str) -> list[dict[str, Any]]:
    return [failed_row(spec, why) for spec in bundle.specs]


def failed_row(spec: Spec, why: str) -> dict[str, Any]:
    return failed(spec, why).model_dump()


Row = dict[str, Any]

FOLDER = "rows"
AS_TEXT = ("settings", "changed", "slider", "setup", "not_again")
"""Fields of free form; they are JSON text in a part. The last is not of every row."""
AS_MAP = ("metrics", "exact", "effort", "apart_m")
"""Numbers by name; the last two are not of every row."""


class Parts:
    """The parts below one folder.

    damaged : names of parts that could not be read and were set aside; their rows have to be computed again.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder / FOLDER
        self.damaged: list[str] = []
        with explained(self._folder):
            self._folder.mkdir(parents=True, exist_ok=True)
            sweep(self._folder)

    @property
    def folder(self) -> Path:
        return self._folder

    def write(self, rows: Sequence[Row]) -> None:
        """Write one part, whole or not at all; raises StoreError."""
        if not rows:
            return
        import pyarrow as pa
        import pyarrow.parquet as pq

        flat = [
            row
            | {name: json.dumps(row[name], sort_keys=True) for name in AS_TEXT if row.get(name) is not None}
            | {name: list(row[name].items()) for name in AS_MAP if row.get(name) is not None}
            for row in rows
        ]
        table = pa.Table.from_pylist(flat, schema=_schema())
        path = self._folder / f"part-{self._next():06d}.parquet"
        with replacing(path) as beside:
            pq.write_table(table, beside, compression="zstd", write_page_checksum=True)

    def read(self) -> Iterator[Row]:
        """Every row, one part in memory at a time; a damaged part is set aside under the name NAME.damaged."""
        for path in self._paths():
            yield from self._rows(path)

    def keys(self) -> set[int]:
        """Keys of the rows there are, as integers."""
        found: set[int] = set()
        for path in self._paths():
            found.update(int(row["key"], 16) for row in self._rows(path, ["key"]))
        return found

    def _paths(self) -> list[Path]:
        return sorted(self._folder.glob("part-*.parquet"))

    def _next(self) -> int:
        numbers = [int(path.name[5:11]) for path in self._folder.glob("part-*.parquet*") if path.name[5:11].isdigit()]
        return max(numbers, default=0) + 1

    def _rows(self, path: Path, columns: list[str] | None = None) -> list[Row]:
        import pyarrow as pa
        import pyarrow.parquet as pq

        try:
            # the whole part, so that damage anywhere in it is found here and not later
            table = pq.ParquetFile(path, page_checksum_verification=True).read()
            if columns is not None:
                return list(table.select(columns).to_pylist())
            rows = table.to_pylist(maps_as_pydicts="strict")
            return [row | {name: json.loads(row[name]) for name in AS_TEXT if row.get(name)} for row in rows]
        except (pa.ArrowException, OSError, ValueError, KeyError, TypeError):
            self.damaged.append(path.name)
            with explained(path):
                os.replace(path, path.with_name(path.name + ".damaged"))
            return []


def _schema() -> Any:
    import pyarrow as pa

    text, real = pa.string(), pa.float64()
    kinds = {name: pa.map_(text, real) for name in AS_MAP} | dict.fromkeys(AS_TEXT, text)
    kinds |= {"ignored": pa.list_(text), "samples": pa.int64(), "draw": pa.int64()}
    kinds |= dict.fromkeys(("dt_s", "wall_s", "steps_per_s"), real)
    order = (
        "key name engine version environment route preset settings changed ignored integrator dt_s scenario slider"
        " setup draw metrics exact effort apart_m not_again samples wall_s steps_per_s error"
    )
    return pa.schema([(name, kinds.get(name, text)) for name in order.split()])


def check_new(folder: Path) -> None:
    """Raise StoreError when a folder holds rows already and nobody asked to go on with them."""
    if any((folder / FOLDER).glob("part-*.parquet")):
        raise StoreError(f"--out {folder}: holds rows of a sweep; --resume goes on with them, or name a new folder")
