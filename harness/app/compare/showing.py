"""Two compared traces for the viewer and for the browser."""

from pathlib import Path

from harness.core.recording import Recording
from harness.diagnosis.alignment.match import Match
from harness.diagnosis.motion import motion_of
from harness.results.compare import CompareResult
from harness.show.overlay_scene import compare_scene
from harness.show.report.compare import Shown, compare_sections, compare_title
from harness.show.report.page import write_report
from harness.show.trace import write_trace


def _shown(result: CompareResult, found: Match, angular: bool) -> Shown:
    """What both show at shared times, with position and speed of each, smoothed where they were not measured."""
    names = (*result.traces,)
    motions = [motion_of(found.t, channels, found.omega) for channels in (found.sim, found.real)]
    return Shown(
        found.t,
        {c: (found.sim[c], found.real[c]) for c in found.real},
        ((motions[0].x, motions[0].v), (motions[1].x, motions[1].v)),
        (names[0], names[1]),
        angular,
    )


def write_compare_page(path: Path, result: CompareResult, found: Match, angular: bool) -> None:
    """Write the page; raises StoreError."""
    data = result.model_dump(mode="json", by_alias=True)
    write_report(path, *compare_title(data), compare_sections(_shown(result, found, angular), data))


def write_compare_trace(path: Path, result: CompareResult, sim: Recording, real: Recording, found: Match) -> None:
    """Write trace.rrd, with both traces as they were read; raises StoreError."""
    data = result.model_dump(mode="json", by_alias=True)
    write_trace(path, compare_scene(sim, real, found.clock.onto(sim.t), _shown(result, found, real.angular), data))
