"""Trajectories and recordings as compact bytes that come back bit for bit.

Neighbouring samples of a smooth motion share most of their leading bits, so differences of the bit patterns, taken as
integers, are small numbers. Each column is stored as its n-th such difference in a Parquet table (delta-bit-packed,
zstd): about 1.3 bytes a value for a motion sampled a million times, 8 for noise. Wrap-around of the integers is exact
in both directions, so nothing is rounded, and -0.0 keeps its sign.
"""

import json
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from harness.core.arrays import FloatArray, IntArray
from harness.core.events import Events
from harness.core.recording import Recording
from harness.core.trajectory import Source, Trajectory

HIGHEST_ORDER = 3
_EXTRA = "extra/"
_CHANNEL = "channel/"


def _differences(bits: IntArray, order: int) -> IntArray:
    for _ in range(order):
        step = np.empty_like(bits)
        step[0] = bits[0]
        np.subtract(bits[1:], bits[:-1], out=step[1:])
        bits = step
    return bits


def _best_order(bits: IntArray) -> int:
    """Order of difference with the fewest significant bits, judged on three short stretches."""
    starts = {0, max(0, bits.size // 2 - 512), max(0, bits.size - 1024)}
    cost = []
    for order in range(min(HIGHEST_ORDER, bits.size - 1) + 1):
        pieces = [_differences(bits[start : start + 1024], order)[order:] for start in starts]
        cost.append(float(np.mean(np.log2(1.0 + np.abs(np.concatenate(pieces, dtype=np.float64))))))
    return int(np.argmin(cost))


def pack(columns: Mapping[str, FloatArray], about: Mapping[str, Any]) -> bytes:
    """Columns of equal length (float64) and a JSON-able description as one Parquet table in memory."""
    orders, table = {}, {}
    for name, values in columns.items():
        bits = np.ascontiguousarray(values, dtype=np.float64).view(np.int64)
        orders[name] = _best_order(bits)
        table[name] = pa.array(_differences(bits, orders[name]))
    text = json.dumps({"orders": orders, "about": about}, default=plain)
    sink = pa.BufferOutputStream()
    pq.write_table(
        pa.table(table).replace_schema_metadata({"harness": text}),
        sink,
        compression="zstd",
        use_dictionary=False,
        column_encoding=dict.fromkeys(table, "DELTA_BINARY_PACKED"),
        write_statistics=False,
    )
    return bytes(sink.getvalue())


def unpack(data: bytes) -> tuple[dict[str, FloatArray], dict[str, Any]]:
    """What ``pack`` was given: columns, bit for bit, and the description."""
    table = pq.ParquetFile(pa.BufferReader(data))
    text = json.loads(table.schema_arrow.metadata[b"harness"])
    columns = {}
    for name, order in text["orders"].items():
        if not 0 <= order <= HIGHEST_ORDER:
            raise ValueError(f"differences of order {order}, not of 0 to {HIGHEST_ORDER}")
        # one at a time, and summed where it stands: ten million samples are read within bounds
        bits = np.require(table.read(columns=[name], use_threads=False).column(0).to_numpy(), requirements="W")
        for _ in range(order):
            np.cumsum(bits, out=bits)
        columns[name] = bits.view(np.float64)
    return columns, text["about"]


def plain(value: object) -> object:
    """For json.dumps: what settings may hold that JSON does not know (arrays, numpy numbers, read-only mappings)."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, (set, frozenset)):
        return sorted(value, key=str)
    return str(value)


def pack_trajectory(trajectory: Trajectory) -> bytes:
    """Everything a trajectory holds, its source and events included."""
    columns = {"t": trajectory.t, "x": trajectory.x, "v": trajectory.v, "a": trajectory.a}
    if trajectory.u is not None:
        columns["u"] = trajectory.u
    if trajectory.mode is not None:
        columns["mode"] = trajectory.mode.astype(np.float64)
    columns |= {_EXTRA + name: values for name, values in trajectory.extra.items()}
    source, events = trajectory.source, trajectory.events
    about = {
        "kind": "trajectory",
        "source": {
            "name": source.name,
            "preset": source.preset,
            "version": source.version,
            "dt": source.dt,
            "settings": dict(source.settings),
            "ignored": list(source.ignored),
            "wall_s": source.wall_s,
        },
        # Python's JSON writes the shortest decimal that reads back as the same double
        "events": {name: getattr(events, name).tolist() for name in ("t", "kind", "x", "a_before", "a_after")},
    }
    return pack(columns, about)


def packed(parts: Mapping[str, Sequence[Trajectory | Recording]]) -> dict[str, bytes]:
    """Each under its kind and number; the packing leaves the interpreter, so that two cores share it."""
    named = {f"{kind}-{i:03d}": one for kind, ones in parts.items() for i, one in enumerate(ones)}

    def pack_one(one: Trajectory | Recording) -> bytes:
        return pack_trajectory(one) if isinstance(one, Trajectory) else pack_recording(one)

    with ThreadPoolExecutor(2) as pool:
        return dict(zip(named, pool.map(pack_one, named.values()), strict=True))


def trajectory_of(columns: Mapping[str, FloatArray], about: Mapping[str, Any]) -> Trajectory:
    """The trajectory whose packed bytes unpack to this."""
    source = about["source"]
    mode = columns.get("mode")
    return Trajectory(
        columns["t"],
        columns["x"],
        columns["v"],
        columns["a"],
        Source(**{**source, "ignored": tuple(source["ignored"])}),
        u=columns.get("u"),
        mode=None if mode is None else mode.astype(np.int8),
        extra={name.removeprefix(_EXTRA): column for name, column in columns.items() if name.startswith(_EXTRA)},
        events=Events(**about["events"]),
    )


def pack_recording(recording: Recording) -> bytes:
    columns = {"t": recording.t} | {_CHANNEL + name: values for name, values in recording.channels.items()}
    about = {
        "kind": "recording",
        "file": recording.file,
        "sha256": recording.sha256,
        "units": dict(recording.units),
        "angular": recording.angular,
        "steady": recording.steady,
        "notes": list(recording.notes),
        "extra": dict(recording.extra),
    }
    return pack(columns, about)


def recording_of(columns: Mapping[str, FloatArray], about: Mapping[str, Any]) -> Recording:
    channels = {name.removeprefix(_CHANNEL): column for name, column in columns.items() if name != "t"}
    return Recording(
        columns["t"],
        channels,
        about["file"],
        about["sha256"],
        about["units"],
        about["angular"],
        tuple(about["notes"]),
        about["extra"],
        steady=about.get("steady", False),  # traces of before it was told
    )
