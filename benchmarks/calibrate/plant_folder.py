"""Recordings that ``python -m benchmarks.recordings`` left in a folder, measured one by one in place of new draws."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from harness.app.diagnose.options import DiagnoseOptions
from harness.app.shared.reading import read
from harness.core.recording import Recording

R = TypeVar("R")


def measured(row: Callable[[Recording, Mapping[str, Any]], R], folder: Path, seed: int, index: int) -> R | None:
    """``row`` of a recording and its answer, by number; None beyond the last. The seed is not used."""
    truths = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    names = sorted(truths)
    if index >= len(names):
        return None
    return row(read(folder / names[index], DiagnoseOptions().reading), truths[names[index]])
