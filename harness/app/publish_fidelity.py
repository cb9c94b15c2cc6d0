"""The published fidelity report: ``python -m harness.app.publish_fidelity`` makes reports/fidelity again."""

import shutil
import sys
import tempfile
from pathlib import Path

from harness.app.regress import update
from harness.app.sweep import PAGE, TRACES, SweepOptions, sweep
from harness.app.sweep_report import finish
from harness.core.errors import HarnessError
from harness.fidelity.compare import kept

WORST = 5
LARGEST = 5_000_000
"""Bytes of everything that is published."""
COMMAND = "python -m harness.app.publish_fidelity"


def publish(into: Path) -> int:
    """Sweep the whole matrix; report.html, traces/ and baseline.json replace those in ``into``. Returns their bytes.

    Raises HarnessError when a row could not be run or the result is too large; then ``into`` stays as it is.
    """
    options = SweepOptions(keep=WORST)
    with tempfile.TemporaryDirectory(prefix="friction-harness-") as temporary:
        result = sweep(options, Path(temporary) / "sweep", command=COMMAND)
        if result.failed:
            raise HarnessError(f"{result.failed} rows could not be run; nothing was published")
        finish(result, options)
        update(result.folder / "baseline.json", {row["name"]: kept(row) for row in result.rows()}, options)
        files = [result.folder / PAGE, result.folder / "baseline.json", *sorted((result.folder / TRACES).glob("*.rrd"))]
        size = sum(file.stat().st_size for file in files)
        if size > LARGEST:
            raise HarnessError(f"the report would take {size} bytes, more than {LARGEST}; nothing was published")
        shutil.rmtree(into / TRACES, ignore_errors=True)
        (into / TRACES).mkdir(parents=True)
        for file in files:
            shutil.copyfile(file, into / file.relative_to(result.folder))
    return size


if __name__ == "__main__":
    try:
        print(f"reports/fidelity: {publish(Path('reports/fidelity'))} bytes")
    except HarnessError as error:
        sys.exit(f"harness: {error}")
