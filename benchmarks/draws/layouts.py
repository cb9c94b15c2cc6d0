"""Files as loggers write them: what is read, by itself or by the line that is printed, is the motion."""

import re
import shlex
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.draws.shared import Answer
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.io.options import ReadOptions
from harness.io.recording import read_recording

_GOALS = (
    "goal_position", "goal_pos", "target_position", "cmd_position", "desired_position", "position_command", "q_des",
    "ref_position", "setpoint", "Goal Position (rad)", "position_goal", "pos_cmd", "position_ref", "commanded position",
)  # fmt: skip
_MEASURED = ("present_position", "position", "pos", "actual_position", "q", "encoder")
_BASES = {
    "v": ("v", "Gyro z (rad/s)", 1.0), "a": ("a", "Acceleration y (m/s^2)", 1.0), "x": ("x", "Laser (mm)", 1e3),
    "word": ("x", "Cart position", 1.0), "plain": ("x", "S7", 1.0), "deg": ("x", "Encoder_deg", 180.0 / np.pi),
}  # fmt: skip


def _options(line: str, rate: float) -> ReadOptions:
    """As a person who pastes a line, and says the rate where it asks for one."""
    words, said = shlex.split(line.replace("HZ", repr(rate))), {}
    names = {"--columns": ("columns", str), "--skip-rows": ("skip_rows", int), "--rate": ("rate", float)}
    for option, word in zip(words, [*words[1:], ""], strict=True):
        if option in names:
            name, kind = names[option]
            said[name] = kind(word)
    return ReadOptions(**said, drop_nan="--drop-nan" in words)


def _as_told(path: Path, rate: float) -> tuple[Recording | None, str]:
    """A file as it is read, or as the line that is printed reads it, with that line."""
    try:
        return read_recording(path), "read"
    except InputError as error:
        line = re.search(r"try: (.*?)(?:, which reads .*)?$", str(error))
        if not line:
            return None, str(error)
        try:
            return read_recording(path, _options(line[1], rate)), line[1]
        except InputError as again:
            return None, f"{line[1]} does not work: {again}"


def _cells(y: FloatArray, digits: str = "%.6g") -> list[str]:
    return [digits % one for one in y]


def answer(seed: int, number: int) -> Answer:
    """Right where the channel, its size and its time are those of the motion."""
    r = np.random.default_rng([seed, number, 11])
    n, rate = int(r.integers(120, 900)), float(r.choice([10, 25, 50, 100, 200]))
    t = np.arange(n) / rate
    w = 2.0 * np.pi * rate / r.uniform(20, 60)
    x = np.exp(-r.uniform(0.003, 0.02) * w * t) * np.cos(w * t) + 1e-3 * r.standard_normal(n)
    si = {"x": x, "v": np.gradient(x, t)}
    si["a"] = np.gradient(si["v"], t)
    channel, name, factor = _BASES[str(r.choice(list(_BASES)))]
    times = {
        "seconds": (str(r.choice(["Time (s)", "Zeit in s", "Elapsed [s]", "Clock"])), _cells(t + 3.2, "%.6f")),
        "named": ("timestamp_ms", _cells(1e3 * t, "%.3f")),
        "ms": (str(r.choice(["clk", "millis", "T"])), _cells(np.round(1e3 * t), "%d")),
        "us": ("tick", _cells(np.round(1e6 * t), "%d")),
        "since": ("stamp", _cells(1.7e9 + t, "%.4f")),
    }
    kind = str(r.choice([*times, "none"]))
    beside = {
        "constant": ("gain", ["2.5"] * n),
        "counter": ("n", _cells(rate * t, "%.0f")),
        "empty": ("Position spare", [""] * n if r.random() < 0.5 else ["nan"] * n),
        "goal": (str(r.choice(_GOALS)), _cells(3.0 * np.sin(3.0 * t), "%.4f")),
        "volts": ("battery [V]", _cells(12.0 - 0.01 * t + 0.1 * r.standard_normal(n), "%.3f")),
        "current": ("Current [A]", _cells(r.standard_normal(n), "%.4f")),
        "warm": ("temp [degC]", _cells(25.0 + 0.01 * r.standard_normal(n), "%.2f")),
    }
    rest = [(name, _cells(si[channel] * factor))]
    rest += [beside[str(one)] for one in r.choice(list(beside), int(r.integers(0, 5)), replace=False)]
    columns = [*([times[kind]] if kind != "none" else []), *(rest[i] for i in r.permutation(len(rest)))]
    separator = str(r.choice([",", ";", "\t"]))
    comma = separator != "," and r.random() < 0.3
    lines = [separator.join(head for head, _ in columns)]
    lines += [
        separator.join(row).replace(".", "," if comma else ".") for row in zip(*(c for _, c in columns), strict=True)
    ]
    if r.random() < 0.3 and kind != "none":
        lines.insert(30, lines[30])
    if r.random() < 0.2:
        lines.append(lines[-1][:3])
    if r.random() < 0.3:
        lines[0:0] = ["Logger 4.1 (c) ACME", "Operator: me"]
    if r.random() < 0.2:
        lines.insert(0, "# rig 4")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.csv"
        path.write_text("\n".join(lines) + "\n", encoding="utf-8-sig" if r.random() < 0.2 else "utf-8")
        found, said = _as_told(path, rate)
    about = f"{name}, time {kind}, {len(columns)} columns: {said.replace(str(path), '')[:120]}"
    if found is None or channel not in found or abs(len(found) - n) > 3:
        return Answer(False, about)
    size, lasts = np.std(found[channel]) / np.std(si[channel]), found.duration / (t[-1] - t[0])
    return Answer(bool(abs(size - 1.0) < 0.05 and abs(lasts - 1.0) < 0.02), about)


def goals(seed: int, number: int) -> Answer:
    """A commanded position beside the measured one, or alone: right where it is never taken for the measured one."""
    r = np.random.default_rng([seed, number, 41])
    t = np.arange(400) / 50.0
    goal = 0.5 * np.sign(np.sin(t))
    moved = np.exp(-0.1 * t) * np.cos(6.0 * t) + 1e-3 * r.standard_normal(t.size)
    columns = [(str(r.choice(_GOALS)), goal)]
    if r.random() < 0.75:
        columns.insert(int(r.integers(2)), (str(r.choice(_MEASURED)), moved))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.csv"
        rows = zip(t, *(y for _, y in columns), strict=True)
        lines = [",".join(["t", *(name for name, _ in columns)]), *(",".join(f"{v:.5g}" for v in row) for row in rows)]
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        found, said = _as_told(path, 50.0)
    taken = found is not None and "x" in found and np.corrcoef(found["x"], goal)[0, 1] > 0.99
    right = not taken and (found is not None or len(columns) == 1)
    return Answer(right, f"{[name for name, _ in columns]}: {said.replace(str(path), '')[:120]}")
