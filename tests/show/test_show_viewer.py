"""The trace in the viewer, without a screen: every view is content."""

import struct
from pathlib import Path

import pytest

from harness.show import screenshot

needs_driver = pytest.mark.skipif(screenshot.driver() is not None, reason=screenshot.driver() or "")


@needs_driver
@pytest.mark.slow
def test_no_view_of_a_run_reports_anything(trace_file: Path) -> None:
    shot = screenshot.take(trace_file, 1.2)
    assert shot.reports == {
        name: []
        for name in (
            "position / mm",
            "engine minus reference / mm",
            "acceleration / (m/s²)",
            "stick and slip",
            "sliders",
            "speed / (m/s) over position / mm",
            "notes",
            "parameters",
            "reversals",
        )
    }
    assert shot.png[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = struct.unpack(">II", shot.png[16:24])
    assert width >= 1280
    assert height >= 720


@pytest.mark.parametrize("arguments", [[], ["one.rrd"], ["a", "b", "c", "d"]])
def test_usage_is_one_line(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert screenshot.main(arguments) == 2
    assert capsys.readouterr().err.count("\n") == 1
