"""The page of a recording as it was read, before anything is fitted."""

from pathlib import PurePath

from harness.core.recording import Recording
from harness.show.blocks import Facts, Figure, Items, Page, Section
from harness.show.plots import ANGLES, CHANNELS, GROUP, axes, curve, per, zoom


def recording_page(recording: Recording) -> Page:
    """Each channel over time, which column it is, and what was mended."""
    figures = []
    for name, values in recording.channels.items():
        label, unit, factor = (ANGLES if recording.angular else CHANNELS)[name]
        layout = axes("time / s", f"{label} / {per(unit)}", showlegend=False)
        traces = [curve(name, recording.t, values * factor, "ink", unit, 1.4)]
        figures.append(Figure(f"channel-{name}", traces, layout, "", GROUP, 300))
    said = f"{len(recording)} samples at {recording.rate:.6g} Hz, {recording.duration:.4g} s"
    sections = [
        Section("What was read", [Facts(dict(recording.columns)), Items(recording.notes)]),
        Section("The recording", [zoom([], recording.duration), *figures]),
    ]
    return Page(f"{PurePath(recording.file).name} as it was read", said, sections)
