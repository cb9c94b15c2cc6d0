"""The published fidelity report: ``python -m benchmarks.publish fidelity [NAME@PYTHON ...]`` makes reports/fidelity."""

import shutil
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from harness.app.sweep.regress import update
from harness.app.sweep.report import finish
from harness.app.sweep.sweep import PAGE, TRACES, Sweep, SweepOptions, sweep
from harness.core.errors import HarnessError
from harness.engines import registry
from harness.fidelity.compare import kept
from harness.show.report.page import share

WORST = 5
"""Traces of the worst rows; fewer where more would be too large."""
LARGEST = 4_400_000
"""Bytes of everything that is published, 1.5 million of them the plotting library that pages share."""
COMMAND = "python -m benchmarks.publish fidelity"


def publish(into: Path, elsewhere: Sequence[str] = ()) -> int:
    """Sweep the whole matrix; report.html, traces/ and baseline.json replace those in ``into``. Returns their bytes.

    elsewhere : engines of other interpreters besides those that are installed here, NAME@PYTHON. Rows of the baseline
    of engines and versions that were not run stay. Raises HarnessError when a row could not be run here (an older
    version elsewhere may lack what a row asks for, and says so) or the result is too large; then ``into`` stays as it
    is.
    """
    here = [name for name, why in registry.available().items() if why is None]
    options = SweepOptions(engines=(*here, *elsewhere))
    with tempfile.TemporaryDirectory(prefix="friction-harness-") as temporary:
        said = " ".join([COMMAND, *map(_by_folder, elsewhere)])
        result = sweep(options, Path(temporary) / "sweep", command=said)
        broken = [row["name"] for row in result.rows() if row["error"] is not None and not row["environment"]]
        if broken:
            raise HarnessError(f"{len(broken)} rows could not be run, {broken[0]} first; nothing was published")
        if (into / "baseline.json").is_file():
            shutil.copyfile(into / "baseline.json", result.folder / "baseline.json")
        update(result.folder / "baseline.json", {row["name"]: kept(row) for row in result.rows()}, options)
        for keep in range(WORST, -1, -1):
            files, size = _finished(result, replace(options, keep=keep))
            if size <= LARGEST:
                break
        else:
            raise HarnessError(f"the report would take {size} bytes, more than {LARGEST}; nothing was published")
        shutil.rmtree(into / TRACES, ignore_errors=True)
        (into / TRACES).mkdir(parents=True)
        for file in files:
            shutil.copyfile(file, into / file.relative_to(result.folder))
        share(result.folder / PAGE, into / PAGE)
    return size


def _finished(result: Sweep, options: SweepOptions) -> tuple[list[Path], int]:
    """The files of the report with so many traces, and their bytes."""
    shutil.rmtree(result.folder / TRACES, ignore_errors=True)
    finish(result, options)
    files = [result.folder / PAGE, result.folder / "baseline.json", *sorted((result.folder / TRACES).glob("*.rrd"))]
    return files, sum(file.stat().st_size for file in files)


def _by_folder(engine: str) -> str:
    """NAME@PYTHON with no more of the path than the environment's own folder."""
    name, _, python = engine.partition("@")
    return f"{name}@{'/'.join(Path(python).parts[-3:])}"
