"""What every use case leaves in a folder: its result, page, trace and log."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from harness.app.shared.deliver import to_json
from harness.app.shared.progress import NAME, journal
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.io.store import OutputFolder, output_folder
from harness.results.common import Curves, Paged
from harness.show.blocks import Page
from harness.show.report.page import write_report
from harness.show.scene import Scene

FILES = {"result": "result.json", "report": "report.html", "rrd": "trace.rrd", "log": NAME}


@contextmanager
def leaving(name: str, out: Path | None) -> Iterator[OutputFolder]:
    """A folder (None for reports/NAME-TIME here) that appears, with the log, when the block has ended well."""
    with output_folder(name, out) as output, journal(output / NAME):
        yield output
        output.commit()


def curves_of(motions: Mapping[str, Trajectory | Recording]) -> Curves:
    """Motions by name as plain columns."""
    return {
        name: {"t": one.t, **one.channels}
        if isinstance(one, Recording)
        else {"t": one.t, "x": one.x, "v": one.v, "a": one.a, **({} if one.u is None else {"u": one.u})}
        for name, one in motions.items()
    }


def leave(
    output: OutputFolder, result: Paged, page: Page, scene: Scene | None = None, curves: Curves | None = None
) -> None:
    """Write result, trace and page, which the result keeps as well; raises StoreError.

    curves : the motions on it, None for those that the result has.
    """
    result.drawn(page, result.curves if curves is None else curves)
    (output / FILES["result"]).write_text(to_json(result), encoding="utf-8")
    if scene is not None:
        # imported when it is needed: it brings the viewer's library along
        from harness.show.trace import write_trace

        write_trace(output / FILES["rrd"], scene)
    write_report(output / FILES["report"], page)
