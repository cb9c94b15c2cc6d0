"""The scene of a recording: its channels, and the reversals with what was read from each."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from harness.core.recording import Recording
from harness.show import scene as s
from harness.show.axes import roomy
from harness.show.decimate import keep
from harness.show.pack import pack_recording
from harness.show.run_scene import DRAWN

NAMES = {"x": "position / m", "v": "speed / (m/s)", "a": "acceleration / (m/s²)", "u": "force / N"}
ANGLES = {"x": "angle / rad", "v": "speed / (rad/s)", "a": "acceleration / (rad/s²)", "u": "torque / (N m)"}
_COLORS = {"x": "#e4632d", "v": "#1f9e77", "a": "#2b7fd6", "u": "#a45bc2"}


def recording_scene(
    recording: Recording, result: Mapping[str, Any], notes: str, reversals: Sequence[tuple[float, str]] = ()
) -> s.Scene:
    """Scene of a recording.

    result : JSON-able, stored as a property. notes : Markdown. reversals : time in s and a sentence, in order.
    """
    channels = list(recording.channels)
    values = [recording[name] for name in channels]
    times = np.array([t for t, _ in reversals], dtype=np.float64)
    chosen = keep(recording.t, values, times[:64], DRAWN)
    names = ANGLES if recording.angular else NAMES
    items: list[s.Item] = [s.Page("/notes", notes)]
    views: list[s.Layout] = []
    for name in channels:
        items.append(s.Line(f"/channels/{name}", name, recording.t[chosen], recording[name][chosen], _COLORS[name]))
        views.append(s.Plot(names[name], [f"/channels/{name}"], roomy([recording[name]])))
    side: list[s.Layout] = [s.Words("notes", "/notes")]
    if reversals:
        items.append(s.Log("/reversals", times, [sentence for _, sentence in reversals]))
        side.append(s.Events("reversals", "/reversals"))
    return s.Scene(
        recording.file.rpartition("/")[2],
        items,
        s.Columns([s.Rows(views), s.Rows(side)], [3.0, 2.0]),
        {"recording-000": pack_recording(recording)},
        {"result": dict(result), "notes": {"text": notes}},
    )
