"""The page as text, and a browser that draws it: numbers, tables, sentences, nothing from elsewhere."""

import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from browsed import open_page
from show_examples import make_run_result, make_sources

from harness.core.events import Events
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.results.common import FleetTrend, P, RepeatedResult
from harness.results.identify import IdentifyResult
from harness.results.run import Metrics, RunResult
from harness.show import blocks as b
from harness.show.blocks import Figure
from harness.show.numbers import number, quantity, sentence_quantity, with_error
from harness.show.report.identify import identify_page
from harness.show.report.motion import reversal_section, turning
from harness.show.report.page import render, script_json, share, symbols, whole, write_report
from harness.show.report.repeated import repeated_table
from harness.show.report.run import run_page


@pytest.fixture(scope="module")
def page(sources: list[Trajectory], run_result: RunResult) -> str:
    return render(run_page(run_result, sources))


@pytest.mark.parametrize(
    ("value", "digits", "shown"),
    [
        (0.0, 4, "0"),
        (None, 4, "–"),
        (4.8372, 4, "4.837"),
        (-1.15, 4, "−1.150"),
        (1234567.0, 3, "1234567"),
        (3.1e-9, 2, "3.1·10⁻⁹"),
        (2.5e8, 2, "2.5·10⁸"),
        (0.99999, 2, "1.0"),
        (9.9996, 4, "10.00"),
    ],
)
def test_numbers(value: float | None, digits: int, shown: str) -> None:
    assert number(value, digits) == shown


@pytest.mark.parametrize(
    ("value", "stderr", "shown"),
    [
        (30.0021, 0.012, ("30.002", "0.012")),
        (0.0501, 3.2e-5, ("0.050100", "0.000032")),
        (-7.0, 0.5, ("−7.00", "0.50")),
        (10.0, None, ("10.00", "")),
        (10.0, 0.0, ("10.0000", "0")),
        # more digits than a double carries are not shown
        (30.0, 1e-14, ("30.0000000", "1.0·10⁻¹⁴")),
    ],
)
def test_values_are_given_to_their_standard_error(value: float, stderr: float | None, shown: tuple[str, str]) -> None:
    assert with_error(value, stderr) == shown


def test_metres_are_shown_in_millimetres() -> None:
    assert quantity(P(value=0.03, stderr=2e-5, unit="m")) == ("30.000", "0.020", "mm")
    assert quantity(P(value=None, stderr=None, unit="1", why="too few")) == ("–", "", "")
    assert sentence_quantity(P(value=0.05, stderr=1e-4, unit="1")) == "0.05000 ± 0.00010"


def test_powers_of_a_unit_are_raised() -> None:
    assert sentence_quantity(P(value=0.031, stderr=0.0017, unit="kg m^2")) == "0.0310 ± 0.0017 kg m²"


def test_a_row_is_in_the_unit_at_its_head() -> None:
    """30 mm in every column of its row, a trend in mm too; a pure number has no unit."""
    trend = FleetTrend(name="load [kg]", slope=P(value=2e-3, stderr=1e-4, unit="m per kg"), differs=True)
    value = P(value=0.03, stderr=7.5e-4, unit="m", systematic=5e-3)
    length = RepeatedResult(value=value, expanded=1.5e-3, trends=[trend], within=2e-4, between=1.7e-3, outliers=[])
    pure = length.model_copy(update={"value": P(value=0.05, stderr=1e-4, unit="1"), "trends": []})
    table = repeated_table({"x_k": length, "zeta": pure}, "Each by itself.")
    assert [row.head for row in table.rows] == ["x_k, mm", "zeta"]
    cells = [cell.text for cell in table.rows[0].cells]
    assert cells == ["30.00", "1.5", "5.0", "0.20", "1.7", "none", "2.00"]
    assert table.rows[0].cells[0].notes == ["± 0.75", "± 5.0 syst."]


def test_symbols_are_set_and_markup_is_not_let_through() -> None:
    assert symbols("x_k & <b> zeta, omega_n; max_error") == (
        "x<sub>k</sub> &amp; &lt;b&gt; ζ, ω<sub>n</sub>; max_error"
    )
    assert symbols("k_t^2/R at 2 m/s^2, 10^-5") == "k<sub>t</sub>²/R at 2 m/s², 10⁻⁵"
    assert symbols("say --sim-rate 9; a -- b") == 'say <span class="option">--sim-rate</span> 9; a -- b'


def test_the_verdict_comes_first_and_says_how_far_each_is_off(page: str) -> None:
    text = re.sub(r"<[^>]+>", "", page[page.index("<main>") : page.index("</main>")])
    assert text.index("PyBullet is off by at most 10.0 mm") < text.index("Scorecard")
    assert "As shipped, MuJoCo is off by at most 5.00 mm and never rests (it creeps at −1.15 mm/s)." in text


def test_the_answer_and_its_plots_come_before_tables(page: str) -> None:
    heads = re.findall(r"<h2[^>]*>(.*?)</h2>", page)
    assert heads[:4] == [
        "What came out",
        "Acceleration at one reversal",
        "Motion, error, acceleration",
        "Engine by engine",
    ]
    assert heads.index("Engine by engine") < heads.index("Scorecard")
    folded = page[page.index("tables: every method on every source") - 40 :]
    assert "<details><summary>" in folded[:60]
    assert "<details open><summary>Each source by each figure" in page


def test_one_reversal_is_shown_with_both_sides_of_the_exact_jump(sources: list[Trajectory]) -> None:
    (figure,) = reversal_section(sources).blocks
    assert isinstance(figure, Figure)
    (low, high), (bottom, top) = figure.layout["xaxis"]["range"], figure.layout["yaxis"]["range"]
    event = turning(sources[0].events)
    assert low < event.t[0] < high
    marks = figure.traces[-1]
    assert marks["x"].tolist() == [event.t[0]] * 2
    assert marks["y"].tolist() == [event.a_before[0], event.a_after[0]]
    assert bottom < min(marks["y"]) < max(marks["y"]) < top
    for line, source in zip(figure.traces[:-1], sources, strict=True):
        assert line["name"] == source.source.label
        assert np.all((line["x"] >= low) & (line["x"] <= high))
        inside = (source.t >= low) & (source.t <= high)
        # the exact one has both sides of the jump besides
        assert line["x"].size == np.count_nonzero(inside) + 2 * (source is sources[0])


def test_what_never_turns_has_no_reversal_to_show(sources: list[Trajectory]) -> None:
    still = [replace(one, events=Events()) for one in sources]
    page = run_page(make_run_result(sources), still)
    assert not [one for one in page.sections if one.title == "Acceleration at one reversal"]


def test_the_page_has_what_a_reader_needs(page: str) -> None:
    for part in (
        "f<sub>s</sub> = 4 N is not honoured: &lt;MuJoCo&gt;",  # ignored, escaped
        "solref</dt><dd>0.02 1",  # settings
        "<small>± 0.020</small><small>exact to 10⁻⁶</small>",  # standard errors, deviations
        "the method knows viscous damping alone",  # why an estimate was refused
        "harness run",
        "noise 7",  # seeds
        "before the speed does &amp; x<sub>k</sub> reads &lt; 30 mm.",
    ):
        assert part in page, part


def test_a_scenario_without_a_decay_has_a_page(sources: list[Trajectory]) -> None:
    found = make_run_result(sources)
    traces = [trace.model_copy(update={"metrics": Metrics.of({}), "estimates": {}}) for trace in found.traces]
    result = found.model_copy(update={"scenario": {"name": "hold-50"}, "traces": traces})
    page = render(run_page(result, sources))
    assert "No estimator was run." in page
    assert "hold-50: mujoco 4.0.0, pybullet 3.2.7" in page


def test_nothing_is_fetched_from_anywhere(page: str) -> None:
    ours = re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)
    assert not re.search(r"https?:|//[a-z]|@import|url\(", ours)
    assert not re.search(r"<(link|iframe|img|script[^>]+src)", page)
    assert "default-src 'none'" in page


@pytest.mark.parametrize("samples", [3001, 200_001])
def test_a_page_stays_below_its_limit(samples: int, tmp_path: Path) -> None:
    sources = [make_sources(samples)[0], *(make_sources(samples)[2:] * 4)]
    write_report(tmp_path / "page.html", run_page(make_run_result(sources), sources))
    assert (tmp_path / "page.html").stat().st_size <= 5_000_000


def test_a_table_of_one_row_stands_as_names_and_values() -> None:
    columns = [b.Column("as pasted", str, "mrad"), b.Column("a point", str)]
    row = b.Row("one.csv", [b.Cell("0.908"), b.Cell("1.00")])
    for rows, tables in (([row], 0), ([row, row], 1)):
        html = render(b.Page("Logs", "", [b.Section("Logs", [b.Table("log", columns, rows)])]))
        assert html.count("<table") == tables
        assert all(text in html for text in ("one.csv", "as pasted", "0.908", "mrad", "a point", "1.00"))


def test_text_cannot_leave_its_script() -> None:
    assert "</script" not in script_json({"a": "</script><script>alert(1)</script>"})


def test_the_page_of_a_recording(recording: Recording, identify_result: IdentifyResult) -> None:
    page = render(identify_page(identify_result, recording))
    assert "Friction and damping of bench.csv" in page
    assert "x<sub>k</sub> = 30.000 ± 0.020 mm, ζ = 0.050100 ± 0.000030" in page
    assert "0.2160 ± 0.0030 rad" in page
    assert "2 gaps are skipped." in page
    assert 'id="plot-reversals-x_k"' in page
    assert page.count("Bars are one standard error") == 1  # for x_k; zeta has none


if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page


def test_what_is_too_wide_for_its_place_is_whole_there(browser: "Browser", tmp_path: Path) -> None:
    many = [b.Column(f"heading {i}", str, "mm") for i in range(12)]
    table = b.Table("case", many, [b.Row(f"row {i}", [b.Cell("0.1234", ("± 0.0012",))] * 12) for i in range(2)])
    long = b.Table("case", [b.Column("said", str)], [b.Row("one", [b.Cell("a long sentence " * 9)])] * 2)
    names = ["single effects named or not ruled out", "controls that were claimed, of those held out for this"]
    shares = [{"type": "scatter", "mode": "markers", "x": [10.0, 90.0], "y": names, "showlegend": False}]
    lines = [{"type": "scatter", "x": [0.0, 1.0], "y": [i, 1.0], "name": f"engine {i}, " + "x " * 25} for i in range(9)]
    category = {"xaxis": {"title": {"text": "part of the mean square mismatch / %"}}, "yaxis": {"type": "category"}}
    halves = {"xaxis": {"domain": [0.0, 0.485]}, "xaxis2": {"domain": [0.515, 1.0]}, "yaxis2": {"anchor": "x2"}}
    said = ["viscous and Coulomb", "with tabulated-stiffness and tabulated-friction"]
    place = {"xref": "paper", "yref": "paper", "y": 1.0, "xanchor": "left", "yanchor": "bottom", "showarrow": False}
    heads = [{"text": text, "x": x, **place} for text, x in zip(said, (0.0, 0.515), strict=True)]
    dots = [{"type": "scatter", "mode": "markers", "x": [0.0, 1.0], "y": [0.0, 1.0], "showlegend": False}] * 2
    dots[1] = dots[1] | {"xaxis": "x2", "yaxis": "y2"}
    planes = Figure("planes", dots, {"yaxis": {}, **halves, "annotations": heads})
    close = [{"type": "scatter", "x": ["one", "two", "three"], "y": [0.019985, 0.020013, 0.019993]}]
    plots: list[b.Block] = [
        planes,
        Figure("shares", shares, category),
        Figure("lines", lines, {"xaxis": {}, "yaxis": {}}),
        Figure("digits", close, {"xaxis": {}, "yaxis": {"title": {"text": "zeta"}}}, height=260),
    ]
    sections = [b.Section("All", [b.Folded("table", [table]), long, b.Code("harness " + "x" * 200), *plots])]
    write_report(tmp_path / "page.html", b.Page("Wide", "", sections))
    beyond = """() => [...document.querySelectorAll(".scroll, pre")]
        .filter((one) => one.scrollWidth > one.clientWidth + 1).length
        + [...document.querySelectorAll(".plot")].flatMap((plot) => [...plot.querySelectorAll("svg text")]
        .map((text) => [text.getBoundingClientRect(), plot.getBoundingClientRect()])
        .filter(([text, plot]) => text.right > plot.right + 1 || text.left < plot.left - 1)).length"""
    across = """() => [...document.querySelectorAll(".plot")].flatMap((plot) => {
        const boxes = (of) => [...plot.querySelectorAll(of)].map((one) => one.getBoundingClientRect());
        return boxes(".ytitle").flatMap((title) => boxes(".ytick text").filter((tick) => tick.left < title.right));
        }).length"""
    for width in (400, 1280):
        page, said = open_page(browser, tmp_path / "page.html", width=width)
        assert page.evaluate(across) == 0, width
        page.click("summary")
        page.wait_for_timeout(100)
        assert page.evaluate(beyond) == 0, width
        assert (page.locator("td").first.get_attribute("data-head") == "heading 0 mm") == (width == 400)
        assert said == []
        page.close()


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
