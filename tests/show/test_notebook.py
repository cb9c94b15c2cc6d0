"""A result in a notebook: the page in a frame, the numbers as a table."""

import gzip
import pickle
import sys
from base64 import b64decode
from html import escape, unescape
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Literal

import pytest
from browsed import open_page

from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.results.identify import IdentifyResult
from harness.show.report.identify import identify_page
from harness.show.report.page import render

if TYPE_CHECKING:
    from playwright.sync_api import Browser


def unpacked(frame: str) -> str:
    """The page in a notebook's frame."""
    document = unescape(frame.partition('srcdoc="')[2].partition('" style')[0])
    data = document.partition('text/plain">')[2].partition("<")[0]
    return gzip.decompress(b64decode(data)).decode("utf-8")


def test_a_browser_draws_what_a_frame_holds(
    browser: "Browser", identify_result: IdentifyResult, recording: Recording, tmp_path: Path
) -> None:
    drawn = identify_result.model_copy(deep=True).drawn(lambda result: identify_page(result, recording))
    (tmp_path / "cell.html").write_text(
        f'<!doctype html><html data-ready="true">{drawn._repr_html_()}', encoding="utf-8"
    )
    page, said = open_page(browser, tmp_path / "cell.html")
    frame = page.frame_locator("iframe")
    assert frame.locator("h1").inner_text().startswith("Friction and damping of")
    frame.locator("html[data-ready='true'] .main-svg").first.wait_for(timeout=60_000)
    assert said == []


def test_a_result_shows_its_page_from_memory_or_from_its_file(
    identify_result: IdentifyResult, recording: Recording, tmp_path: Path
) -> None:
    alone = identify_result.model_copy(deep=True)
    assert alone._repr_html_() == f"<pre>{escape(str(alone))}</pre>"
    assert "estimates.acceleration.x_k = " in str(alone)
    page = identify_page(identify_result, recording)
    drawn = identify_result.model_copy(deep=True).drawn(lambda result: identify_page(result, recording))
    shown = drawn._repr_html_()
    assert unpacked(shown) == render(page)
    assert len(shown) < len(render(page)) / 2
    assert drawn == identify_result
    report = tmp_path / "report.html"
    report.write_text(render(page), encoding="utf-8")
    written = pickle.loads(pickle.dumps(identify_result.model_copy(update={"files": {"report": str(report)}})))
    assert written._repr_html_() == shown


@pytest.mark.parametrize("library", ["plotly", "matplotlib"])
def test_every_plot_of_the_page_is_drawn_by_either_library(
    library: Literal["plotly", "matplotlib"], identify_result: IdentifyResult, recording: Recording
) -> None:
    result = identify_result.model_copy(deep=True).drawn(identify_page(identify_result, recording))
    assert {"channel-x", "reversals-x_k"} <= set(result.plots)
    for name in result.plots:
        drawn = result.plot(name, library)
        if library == "plotly":
            lines, label = [line.x for line in drawn.data], drawn.layout.yaxis.title.text
        else:
            (plane,) = drawn.axes
            lines, label = [line.get_xdata() for line in plane.lines] + plane.collections, plane.get_ylabel()
            drawn.draw_without_rendering()
        assert lines
        assert label
    with pytest.raises(InputError, match="channel-x"):
        result.plot("channel-y")
    with pytest.raises(InputError, match="read from a file"):
        pickle.loads(pickle.dumps(result)).plot()


def test_what_is_completed_is_what_a_result_says_and_does(identify_result: IdentifyResult) -> None:
    offered = {name for name in dir(identify_result) if not name.startswith("_")}
    assert offered >= {"estimates", "warnings", "plot", "plots", "curves", "to_frame"}
    assert not any(name.startswith(("model_", "parse", "schema")) for name in offered)


def test_numbers_with_errors_and_units_are_a_table(
    identify_result: IdentifyResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(InputError, match="pip install pandas"):
        identify_result.to_frame()

    class Frame(SimpleNamespace):
        def astype(self, kinds: dict[str, type]) -> "Frame":
            return Frame(kinds=kinds, **vars(self))

    pandas: Any = SimpleNamespace(
        MultiIndex=SimpleNamespace(from_tuples=lambda pairs, names: (names, pairs)),
        DataFrame=lambda columns, index: Frame(columns=columns, index=index),
    )
    monkeypatch.setitem(sys.modules, "pandas", pandas)
    table = identify_result.to_frame()
    names, places = table.index
    assert names == ["part", "quantity"]
    at = places.index(("estimates.acceleration", "x_k"))
    x_k = identify_result.estimates["acceleration"].x_k
    assert [table.columns[name][at] for name in table.columns] == [
        x_k.value,
        x_k.stderr,
        x_k.systematic,
        x_k.unit,
        x_k.why,
    ]
    assert places[-1] == ("", "sensor_phase_rad")
    assert table.kinds == dict.fromkeys(("value", "stderr", "systematic"), float)
