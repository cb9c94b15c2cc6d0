"""The scene of two traces laid over each other."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from harness.core.recording import Recording
from harness.show import scene as s
from harness.show.axes import roomy
from harness.show.decimate import keep
from harness.show.pack import pack_recording
from harness.show.run_scene import DRAWN

_COLORS = {"sim": "#2b7fd6", "real": "#8a93a0"}


def compare_scene(sim: Recording, real: Recording, shift: float, result: Mapping[str, Any]) -> s.Scene:
    """Scene of a comparison; ``shift`` (s) is added to the times of ``sim``. result : JSON-able, kept as a property."""
    common = [c for c in ("x", "v", "a") if c in sim and c in real]
    items: list[s.Item] = []
    views: list[s.Layout] = []
    for channel in common:
        for name, one, moved in (("real", real, 0.0), ("sim", sim, shift)):
            chosen = keep(one.t, [one[channel]], np.empty(0), DRAWN)
            path = f"/channels/{channel}/{name}"
            items.append(s.Line(path, name, one.t[chosen] + moved, one[channel][chosen], _COLORS[name]))
        paths = [f"/channels/{channel}/{name}" for name in ("real", "sim")]
        views.append(s.Plot(channel, paths, roomy([real[channel], sim[channel]])))
    notes = "\n".join([f"# {result['verdict']}", "", *(f"- {line}" for line in result["sentences"])])
    items.append(s.Page("/notes", notes))
    return s.Scene(
        "comparison",
        items,
        s.Columns([s.Rows(views), s.Rows([s.Words("notes", "/notes")])], [3.0, 2.0]),
        {"recording-000": pack_recording(sim), "recording-001": pack_recording(real)},
        {"result": dict(result), "notes": {"text": notes}},
    )
