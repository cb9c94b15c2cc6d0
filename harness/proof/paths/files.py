"""Files as loggers write them, and several of them as one recording of a proof."""

import re
from collections.abc import Mapping, Sequence

import numpy as np

from harness.core.arrays import FloatArray
from harness.proof.paths.forms import Rng

_DEG = 180.0 / np.pi
_STRAIGHT: Sequence[Mapping[str, tuple[str, float]]] = (
    {"t": ("t [s]", 1.0), "x": ("x [m]", 1.0), "v": ("v [m/s]", 1.0), "a": ("a [m/s^2]", 1.0), "u": ("u [N]", 1.0)},
    {
        "t": ("Time (s)", 1.0),
        "x": ("Position (mm)", 1e3),
        "v": ("Velocity (mm/s)", 1e3),
        "a": ("Acceleration (m/s^2)", 1.0),
        "u": ("Force (N)", 1.0),
    },
    {
        "t": ("time_ms", 1e3),
        "x": ("position_mm", 1e3),
        "v": ("velocity [m/s]", 1.0),
        "a": ("acc [m/s^2]", 1.0),
        "u": ("force_N", 1.0),
    },
)
_TURNING: Sequence[Mapping[str, tuple[str, float]]] = (
    {"t": ("t [s]", 1.0), "x": ("x [rad]", 1.0), "v": ("v [rad/s]", 1.0), "u": ("u [N*m]", 1.0)},
    {
        "t": ("Time (s)", 1.0),
        "x": ("Angle (deg)", _DEG),
        "v": ("Angular velocity (rad/s)", 1.0),
        "u": ("Torque (N*m)", 1.0),
    },
    {
        "t": ("time_ms", 1e3),
        "x": ("angle_deg", _DEG),
        "v": ("v [rpm]", 60.0 / (2.0 * np.pi)),
        "u": ("torque [N*m]", 1.0),
    },
)
"""Headers of a column and its unit over the SI one."""


def written(rng: Rng, t: FloatArray | None, channels: Mapping[str, FloatArray], turning: bool) -> str:
    """A file. t : (n,), None of a table without times; channels : (n,) each, SI."""
    heads = (_TURNING if turning else _STRAIGHT)[int(rng.integers(3))]
    columns = {} if t is None else {heads["t"][0]: [f"{one:.10g}" for one in heads["t"][1] * t]}
    columns |= {heads[c][0]: [f"{one:.7g}" for one in heads[c][1] * y] for c, y in channels.items()}
    n = len(next(iter(columns.values())))
    if rng.random() < 0.3 and t is not None:
        columns["temperature [degC]"] = [f"{one:.1f}" for one in 24.0 + 0.1 * rng.standard_normal(n)]
    separator = str(rng.choice([",", ";", "\t"]))
    comma = separator != "," and rng.random() < 0.4
    rows = [separator.join(row).replace(".", "," if comma else ".") for row in zip(*columns.values(), strict=True)]
    lines = [separator.join(columns), *rows]
    if rng.random() < 0.25:
        lines[0:0] = ["Logger 4.1", "Operator: lab"]
    return "\n".join(lines) + "\n"


_MARK = "==> "


def packed(files: Mapping[str, str]) -> bytes:
    """Several files as one, each under its name, as ``head`` prints them."""
    return "".join(f"{_MARK}{name}\n{text}" for name, text in files.items()).encode()


def unpacked(recording: bytes) -> dict[str, str] | None:
    """The files of a recording that was packed, by name; None of any other."""
    if not recording.startswith(_MARK.encode()):
        return None
    parts = recording.decode().split(_MARK)[1:]
    return {name: text for name, _, text in (part.partition("\n") for part in parts)}


def numbers_in(line: str) -> list[float]:
    """The numbers of a line whatever parts them; none in a line of words."""
    cells = re.split(r"[;\t]", line) if re.search(r"[;\t]", line) else line.split(",")
    try:
        return [float(cell.replace(",", ".")) for cell in cells]
    except ValueError:
        return []
