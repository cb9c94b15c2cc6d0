"""JSON and JSON lines: a list of records, or lists by name, wherever in the document the longest stands."""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.bounded import read_bytes
from harness.core.errors import InputError
from harness.io.columns import word_of
from harness.io.reader import Reader
from harness.io.table import ArrayTable, held, table_of_arrays
from harness.io.times import Clock

_QUOTED = re.compile(r"[+-]?\d{1,30}(?:\.\d{0,30})?(?:[eE][+-]?\d{1,3})?")
"""A number as text."""
_MOST_NAMES = 256
"""Columns that are made of records."""
_ACCEPTED = "a list of records, or lists of numbers by name"


def open_json(path: Path) -> ArrayTable:
    """The columns of a document. Raises InputError for what is no JSON, or holds no table."""
    data = read_bytes(path)
    try:
        text = data.decode("utf-8-sig")
        lines = path.suffix.lower() != ".json"
        content = [json.loads(line) for line in text.splitlines() if line.strip()] if lines else json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(str(path), f"not JSON ({error})", _ACCEPTED) from None
    content, others = _of_one_sensor(content)
    best = _runs(content) or max(_tables(content), key=lambda one: max(map(len, one.values())), default={})
    if not best:
        raise InputError(str(path), "no table in it", _ACCEPTED)
    clocks = {name: Clock() for name in best}
    columns = {name: np.array([_number(v, clocks[name]) for v in values], np.float64) for name, values in best.items()}
    table = table_of_arrays(path, {name: held(values) for name, values in columns.items()})
    firsts = [clock.first for clock in clocks.values()]
    table.dated |= {i: first for i, first in enumerate(firsts) if first}
    table.mended += [others] if others else []
    return table


_SENSOR = "sensor"
"""The key by which a phone's records say whose they are."""


def _of_one_sensor(content: Any) -> tuple[Any, str]:
    """The records of one sensor, where those of several stand in one list, their keys before its name, and the sentence
    that says which; of these, one of speed goes before one of acceleration, and that before any other.
    """
    rows = content if isinstance(content, list) else []
    found: dict[str, list[dict[str, Any]]] = {}
    for row in rows:
        if isinstance(row, dict) and isinstance(row.get(_SENSOR), str):
            found.setdefault(row[_SENSOR], []).append(row)
    if not found:
        return content, ""
    order = ("x", "v", "a")
    rank = {name: order.index(channel) if (channel := word_of(name)) in order else len(order) for name in found}
    name = min(found, key=lambda one: (rank[one], -len(found[one])))
    own = [{f"{name}.{key}" if key in _AXES else key: value for key, value in row.items()} for row in found[name]]
    shown = ", ".join(found)
    return own, f"Of the sensors {shown}, {name} is read." if len(found) > 1 else ""


_AXES = ("x", "y", "z")


_SYSID = {"fast-forward", "fast-backward", "slow-forward", "slow-backward"}
"""Tests of WPILib's SysId, each of rows of time, voltage, position and speed."""
_OF_SYSID = ("time [s]", "voltage [V]", "position", "velocity")


def _runs(content: Any) -> Mapping[str, Sequence[Any]]:
    """The columns of several tables of one kind beside each other, ``NAME: column``; {} where there are none."""
    if not isinstance(content, dict):
        return {}
    found = {str(name): one for name, one in content.items() if isinstance(one, list) and len(one) > 1}
    tables = {name: next(_tables(rows), {}) for name, rows in found.items()}
    if len(tables) < 2 or len({tuple(one) for one in tables.values()}) > 1 or not all(map(len, tables.values())):
        return {}
    of_sysid = set(tables) >= _SYSID and len(next(iter(tables.values()))) == len(_OF_SYSID)
    unit = str(content.get("units", "")).lower() if of_sysid else ""
    last = ("", "", f" [{unit}]", f" [{unit}/s]") if unit else [""] * len(_OF_SYSID)
    return {
        f"{name}: {_OF_SYSID[i] + last[i] if of_sysid else column}": values
        for name, one in tables.items()
        for i, (column, values) in enumerate(one.items())
    }


def _tables(content: Any) -> Iterator[Mapping[str, Sequence[Any]]]:
    """Columns by name, of everything in a document that is a table."""
    if isinstance(content, dict):
        lists = _lists(content)
        if lists:
            yield lists
        below = {str(k): list(_lists(v).values()) for k, v in content.items() if isinstance(v, dict)}
        streams = {name: of[0] for name, of in below.items() if len(of) == 1}
        if len(streams) > 1 and len(set(map(len, streams.values()))) == 1:
            yield streams
        for value in content.values():
            yield from _tables(value)
    elif isinstance(content, list) and content and all(isinstance(one, dict | list) for one in content):
        flat = [dict(_flat("", one)) for one in content]
        names = list(dict.fromkeys(name for one in flat for name in one))[:_MOST_NAMES]
        if names:
            yield {name: [one.get(name) for one in flat] for name in names}


def _lists(content: dict[str, Any]) -> dict[str, list[Any]]:
    """Lists of numbers of a document, by name."""
    return {str(k): v for k, v in content.items() if isinstance(v, list) and v and all(map(_is_number, v))}


def _flat(prefix: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Numbers and times of a record by their names, those within it behind a point."""
    if isinstance(value, dict) and prefix and _is_number(value.get("value")) and isinstance(value.get("unit"), str):
        prefix, value = f"{prefix} [{value['unit']}]", value["value"]
    inside = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, one in inside:
        yield from _flat(f"{prefix}.{key}" if prefix else str(key), one)
    if isinstance(value, bool) or (_is_number(value) and value is not None):
        yield prefix, value


def _is_number(value: Any) -> bool:
    """Whether a value is a number, in quotes too, none, or a date with its time of day."""
    if isinstance(value, str):
        return bool(_QUOTED.fullmatch(value)) or Clock().seconds(value) is not None
    return value is None or (isinstance(value, int | float) and not isinstance(value, bool))


def _number(value: Any, clock: Clock) -> float:
    if isinstance(value, str):
        seconds = float(value) if _QUOTED.fullmatch(value) else clock.seconds(value)
        return float("nan") if seconds is None else seconds
    return float("nan") if value is None else float(value)


JSON = Reader(name="JSON", suffixes=(".json", ".jsonl", ".ndjson"), open=open_json)
