"""The page in a browser: no error, no request, every plot drawn, a zoom that shows the samples."""

from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from browsed import open_page

from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.results.identify import IdentifyResult
from harness.results.run import RunResult
from harness.show.report.identify import identify_page
from harness.show.report.page import share, whole, write_report
from harness.show.report.run import run_page

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page


@pytest.fixture(scope="module")
def drawn_run(tmp_path_factory: pytest.TempPathFactory, sources: list[Trajectory], run_result: RunResult) -> Path:
    path = tmp_path_factory.mktemp("page") / "report.html"
    write_report(path, run_page(run_result, sources))
    return path


def wait_for_mode(page: "Page", mode: str) -> None:
    """Until the engine's acceleration is drawn in this mode (the page forbids eval, so no wait_for_function)."""
    for _ in range(100):
        if page.evaluate("document.getElementById('plot-acceleration').data[1].mode") == mode:
            return
        page.wait_for_timeout(100)
    pytest.fail(f"the curve was not drawn as {mode}")


def drawn(page: "Page") -> dict[str, int]:
    """Number of curves with a path in each plot that says it was drawn."""
    script = """() => Object.fromEntries([...document.querySelectorAll(".plot")].map((plot) => [plot.dataset.figure,
        plot.dataset.drawn === "true" ? plot.querySelectorAll(".scatterlayer .trace path").length : -1]))"""
    found: dict[str, int] = page.evaluate(script)
    return found


@pytest.mark.parametrize(("scheme", "alone"), [("light", True), ("dark", False)])
def test_the_page_of_a_run_is_drawn_without_a_word(
    browser: "Browser", drawn_run: Path, scheme: str, alone: bool, tmp_path: Path
) -> None:
    published = tmp_path / "run" / "report.html"
    published.parent.mkdir()
    share(drawn_run, published)
    assert published.stat().st_size < 0.5 * drawn_run.stat().st_size
    assert whole(published) == drawn_run.read_bytes()
    page, said = open_page(browser, drawn_run if alone else published, scheme)
    counts = drawn(page)
    assert set(counts) == {"reversal", "position", "error", "acceleration", "phase"}
    assert counts["position"] >= 3
    assert counts["error"] >= 2
    assert counts["acceleration"] >= 4
    assert counts["phase"] >= 3
    page.click("#theme")
    page.wait_for_timeout(300)
    assert said == []
    page.close()


def test_no_button_of_a_plot_shares_anything(browser: "Browser", drawn_run: Path) -> None:
    page, _ = open_page(browser, drawn_run, "light")
    titles = page.evaluate(
        "[...document.querySelectorAll('.modebar-btn')].map((one) => one.getAttribute('data-title').toLowerCase())"
    )
    assert "zoom in" in titles
    assert not [
        title for title in titles if any(word in title for word in ("share", "cloud", "send", "edit", "upload"))
    ]
    page.close()


def test_a_zoom_to_a_jump_shows_single_samples(browser: "Browser", drawn_run: Path, sources: list[Trajectory]) -> None:
    page, said = open_page(browser, drawn_run, "light")
    page.click(".zoom button:nth-of-type(2)")
    wait_for_mode(page, "lines+markers")
    event = float(sources[0].events.t[0])
    for name in ("position", "error", "acceleration"):
        low, high = page.evaluate(f"document.getElementById('plot-{name}').layout.xaxis.range")
        assert low < event < high
        assert high - low < 0.1
    # the drawn numbers are the samples themselves: as many as there are in the source, and equal to the last bit
    shown = page.evaluate("Array.from(document.getElementById('plot-acceleration').data[1].y)")
    assert shown == sources[1].a.tolist()
    page.click(".zoom button:nth-of-type(1)")
    wait_for_mode(page, "lines")
    assert said == []
    page.close()


def test_the_page_of_a_recording_is_drawn(
    browser: "Browser", tmp_path: Path, recording: Recording, identify_result: IdentifyResult
) -> None:
    path = tmp_path / "report.html"
    write_report(path, identify_page(identify_result, recording))
    page, said = open_page(browser, path, "light")
    counts = drawn(page)
    assert set(counts) == {"channel-x", "channel-a", "reversals-x_k", "reversals-zeta"}
    assert all(count > 0 for count in counts.values())
    assert said == []
    page.close()
