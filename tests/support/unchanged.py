"""All that is said of a few recordings, as plain numbers and texts, to be held against what was said before."""

import json
import math
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass
from enum import Enum
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from harness.core.arrays import FloatArray

Figures: TypeAlias = dict[str, float | str]

SAME = 1e-7
"""Relative difference of numbers that are the same: descents end within far less, compiled and plain code too."""
LONGEST = 6
"""Numbers of an array that are kept one by one, and rows of a table; longer ones are kept as moments."""
DIGITS = 11


def flat(said: Any) -> Figures:
    """Every number and text in dataclasses, mappings and arrays, by its place."""
    return dict(_flat("", said))


def _flat(place: str, said: Any) -> Iterator[tuple[str, float | str]]:
    if is_dataclass(said) and not isinstance(said, type):
        for field in fields(said):
            yield from _flat(f"{place}.{field.name}", getattr(said, field.name))
    elif isinstance(said, dict) or hasattr(said, "items"):
        for key, value in said.items():
            yield from _flat(f"{place}.{key}", value)
    elif isinstance(said, np.ndarray) and said.size > LONGEST:
        yield f"{place}.size", float(said.size)
        known = np.nan_to_num(said.astype(float).ravel(), posinf=1.0, neginf=-1.0)
        yield f"{place}.size of all", float(np.sum(np.abs(known)))
        yield f"{place}.by place", by_place(known)
    elif isinstance(said, tuple) and len(said) > LONGEST and is_dataclass(said[0]):
        for field in fields(said[0]):
            column = [getattr(row, field.name) for row in said]
            yield from _flat(f"{place}.{field.name}", np.array([math.nan if y is None else y for y in column]))
    elif isinstance(said, np.ndarray | tuple | list):
        for i, value in enumerate(np.ravel(said).tolist() if isinstance(said, np.ndarray) else said):
            yield from _flat(f"{place}[{i}]", value)
    elif isinstance(said, bool | Enum | None.__class__):
        yield place, str(said)
    elif isinstance(said, int | float):
        yield place, float(said) if math.isfinite(said) else str(float(said))
    else:
        yield place, str(said)


def by_place(values: FloatArray) -> float:
    """One number that says of many (n,) which stands where, and does not cancel."""
    weight: FloatArray = np.linspace(0.5, 1.5, values.size) ** 2
    return float((np.abs(values) + 0.5 * values) @ weight)


def differences(now: Figures, before: Figures, same: float = SAME) -> list[str]:
    """What is not the same, a line each; same : relative difference of numbers that are."""
    lines = [f"{place}: not there before" for place in now.keys() - before.keys()]
    for place, value in before.items():
        if place not in now:
            lines.append(f"{place}: not there any more")
        elif not _same(now[place], value, same):
            lines.append(f"{place}: {now[place]!r}, before {value!r}")
    return lines


def _same(now: float | str, before: float | str, same: float) -> bool:
    if isinstance(now, str) or isinstance(before, str):
        return now == before
    return math.isclose(now, before, rel_tol=same, abs_tol=1e-12)


def write(file: Path, cases: dict[str, Callable[[], Any]]) -> None:
    """What is said of every case now, to a file."""
    lines = [f"{json.dumps(name)}: {json.dumps(_short(flat(case())))}" for name, case in cases.items()]
    file.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def _short(said: Figures) -> Figures:
    return {place: value if isinstance(value, str) else float(f"{value:.{DIGITS}g}") for place, value in said.items()}


def known(file: Path) -> dict[str, Figures]:
    """What was said of every case when the file was written."""
    read: dict[str, Figures] = json.loads(file.read_text(encoding="utf-8"))
    return read


def noisy(y: FloatArray, sigma: float, seed: int) -> FloatArray:
    """With white noise."""
    return np.asarray(y + sigma * np.random.default_rng(seed).standard_normal(y.size))
