"""The scene of two traces laid over each other."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.show import scene as s
from harness.show.axes import padded, plane_grid, roomy
from harness.show.decimate import keep
from harness.show.pack import pack_recording
from harness.show.recording_scene import ANGLES, NAMES
from harness.show.report.compare import Shown, compare_headline
from harness.show.run_scene import DRAWN

_COLORS = ("#e4632d", "#8a93a0")
_APART = "#2b7fd6"


def compare_scene(
    sim: Recording, real: Recording, moved: FloatArray, shown: Shown, result: Mapping[str, Any]
) -> s.Scene:
    """Scene of a comparison.

    moved : times of ``sim`` (n,) by the clock of ``real``, s. shown : both at shared times. result : JSON-able, kept as
    a property.
    """
    labels = ANGLES if shown.angular else NAMES
    items: list[s.Item] = []
    views: list[s.Layout] = []
    for channel, pair in shown.channels.items():
        paths = []
        for name, one, t, color in zip(shown.names, (sim, real), (moved, real.t), _COLORS, strict=True):
            chosen = keep(t, [one[channel]], np.empty(0), DRAWN)
            paths.append(f"/channels/{channel}/{'first' if one is sim else 'second'}")
            items.append(s.Line(paths[-1], name, t[chosen], one[channel][chosen], color))
        views.append(s.Plot(labels[channel], paths, roomy([real[channel], sim[channel]])))
        apart = pair[1] - pair[0]
        chosen = keep(shown.t, [apart], np.empty(0), DRAWN)
        path = f"/difference/{channel}"
        items.append(s.Line(path, f"{shown.names[1]} minus {shown.names[0]}", shown.t[chosen], apart[chosen], _APART))
        views.append(s.Plot(f"difference of {labels[channel]}", [path], roomy([apart]) if np.ptp(apart) else None))
    phase, plane = _phase(shown)
    notes = "\n".join(
        [f"# {result['verdict']}", "", compare_headline(result), "", *(f"- {line}" for line in result["sentences"])]
    )
    items += [*phase, s.Page("/notes", notes)]
    return s.Scene(
        "comparison",
        items,
        s.Columns([s.Rows(views), s.Rows([plane, s.Words("notes", "/notes")])], [3.0, 2.0]),
        {"recording-000": pack_recording(sim), "recording-001": pack_recording(real)},
        {"result": dict(result), "notes": {"text": notes}},
    )


def _phase(shown: Shown) -> tuple[list[s.Item], s.Plane]:
    """Speed over position of both, the speed to a scale that makes them about as high as wide."""
    spans = [max(float(np.ptp(one[i])) for one in shown.motion) for i in (0, 1)]
    scale = 10.0 ** round(float(np.log10(spans[1] / spans[0]))) if min(spans) > 0.0 else 1.0
    bounds = [padded([one[i] / by for one in shown.motion], 0.05) for i, by in ((0, 1.0), (1, scale))]
    axes = (("angle / rad", 1.0), ("speed / (rad/s)", scale))
    if not shown.angular:
        axes = (("x / mm", 1e3), ("v / (mm/s)", 1e3 * scale))
    items: list[s.Item] = [plane_grid("/phase/axes", bounds[0], bounds[1], axes[0], axes[1])]
    chosen = keep(shown.t, [y for pair in shown.motion for y in pair], np.empty(0), DRAWN)
    for name, (x, v), color, place in zip(shown.names, shown.motion, _COLORS, ("first", "second"), strict=True):
        points = np.column_stack([x[chosen], v[chosen] / scale])
        items.append(s.Orbit(f"/phase/{place}", name, points, color, (shown.t[chosen], points)))
    return items, s.Plane("phase portrait, v over x", ["/phase"], bounds[0], bounds[1])
