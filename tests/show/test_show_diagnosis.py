"""The pages and the trace of a diagnosis: what they say, and that a browser draws them."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from browsed import open_page
from diagnose_examples import STOP, example

from harness.cli.diagnosis_tables import say_diagnosis as print_diagnosis
from harness.core.recording import Recording
from harness.core.trajectory import Source, Trajectory
from harness.kernels.solve import simulate
from harness.results.common import ModelEntry, P, Where
from harness.results.diagnosis import (
    AttributionResult,
    ChangeResult,
    DiagnosisResult,
    EvidenceResult,
    FailedDiagnosis,
    FitPercent,
    PredictionResult,
    RemainderResult,
    RuleResult,
    SeenLawResult,
    SurfaceResult,
    TableResult,
    UnreadRecording,
    read_diagnosis,
)
from harness.show.blocks import Figure, Page
from harness.show.report.diagnosis import diagnosis_page, gained, index_page
from harness.show.report.diagnosis_figures import nameless
from harness.show.report.page import Pool, render, write_report
from harness.show.report.scenes import diagnosis_scene
from harness.show.stored import read_trace
from harness.show.trace import write_trace

if TYPE_CHECKING:
    from playwright.sync_api import Browser

T = np.linspace(0.0, 4.0, 500)
Case = tuple[DiagnosisResult, Recording, list[Trajectory]]


def motion(name: str, terms: bool) -> Trajectory:
    found = simulate(STOP if terms else STOP.with_terms(), T)
    extra = {"shown x": found.x, "shown a": found.a}
    return Trajectory(T, found.x, found.v, found.a, Source("reference", name), extra=extra, events=found.events)


@pytest.fixture(scope="module")
def case() -> Case:
    simulated = [motion("baseline", False), motion("refined", True)]
    noise = np.random.default_rng(0)
    channels = {"x": simulated[1].x + noise.normal(0.0, 1e-4, T.size), "a": simulated[1].a}
    place = Where(time_s=[[0.0, 0.5], [1.0, 1.2]], regime="one-side", condition="x > 0.05 m", share=0.8)
    number = P(value=10.0, stderr=0.01, unit="rad/s")
    result = example("bench.csv")
    result = result.model_copy(
        update={
            "where": [place],
            "baseline": result.baseline.model_copy(update={"parameters": {"omega_n": number}}),
            "evidence": [
                EvidenceResult(name="end-stop", delta_bic=900.0),
                EvidenceResult(name="stribeck", delta_bic=-6.0),
            ],
            "attribution": AttributionResult(
                engine=-0.01, parameters=0.0, missing_physics=0.9, unexplained=0.01, noise=0.1, configuration="mujoco"
            ),
            "warnings": ["</script><b>no markup</b>"],
        }
    )
    return result, Recording(T, channels, "bench.csv"), simulated


def test_the_verdict_comes_first_and_nothing_of_a_file_becomes_markup(case: Case) -> None:
    page = render(diagnosis_page(*case))
    sections = ("Residual, before and after", "Where it acts", "Model and numbers", "Evidence", "Details", "Files")
    order = ["misses a stop.", *(f"<h2>{title}" for title in sections)]
    places = [page.index(text) for text in order]
    assert places == sorted(places)
    assert "holds 80 % of the mismatch" in page
    assert "in place of end-stop: cubic-stiffness (worse by 8.0 in BIC)" in page
    assert "No better than the base model alone: stribeck." in page
    assert "<b>no markup</b>" not in page


def test_the_trace_holds_recording_and_simulations_bit_for_bit(case: Case, tmp_path: Path) -> None:
    _, recording, simulated = case
    law = SeenLawResult(
        names=["end-stop"], over="x", level=False, at=[-0.02, 0.0, 0.02], at_unit="m", seen=[0.1, 0.0, -0.1],
        stderr=[0.01, 0.01, 0.02], fitted=[0.1, 0.0, -0.1], base=[0.0, 0.0, 0.0], force_unit="N",
    )  # fmt: skip
    result = case[0].model_copy(update={"laws": [law]})
    write_trace(tmp_path / "trace.rrd", diagnosis_scene(result, recording, simulated))
    stored = read_trace(tmp_path / "trace.rrd")
    names = [view.name for view in diagnosis_scene(result, recording, simulated).views]
    assert names.index("law-0") == names.index("verdict") + 1
    assert stored.properties["result"] == result.model_dump(mode="json", by_alias=True)
    np.testing.assert_array_equal(stored.recordings[0]["x"], recording["x"])
    for stored_one, made in zip(stored.trajectories, simulated, strict=True):
        assert stored_one.source == made.source
        np.testing.assert_array_equal(stored_one.extra["shown a"], made.extra["shown a"])


def test_a_users_own_simulation_is_a_third_curve_as_far_as_it_reaches(case: Case, tmp_path: Path) -> None:
    result, recording, simulated = case
    part = simulated[0].t[10:200]
    shown_x = np.cos(part)
    own = Trajectory(part, shown_x, 0.0 * part, 0.0 * part, Source("yours", "as given"), extra={"shown x": shown_x})
    changed = ChangeResult(kind="parameter", name="c", before=0.8, after=0.4, unit="N s/m", said="c: 0.8 to 0.4 N s/m")
    told = AttributionResult(
        engine=0.0, why="a trace alone", parameters=-0.4, missing_physics=1.4, unexplained=0.0, noise=0.0,
        changes=[changed], sentences=["The parameters hide the missing term: c 0.8 stands for 0.4 and end-stop."],
    )  # fmt: skip
    result = result.model_copy(update={"attribution": told, "settings": {**result.settings, "sim": "mine.csv"}})
    scene = diagnosis_scene(result, recording, [*simulated, own])
    drawn = {view.name: [trace["name"] for trace in view.traces] for view in scene.views if isinstance(view, Figure)}
    assert drawn["channel-x"][-1] == "your simulation"
    write_trace(tmp_path / "trace.rrd", scene)
    assert [len(kept) for kept in read_trace(tmp_path / "trace.rrd").trajectories][2] == part.size
    page = render(diagnosis_page(result, recording, [*simulated, own]))
    assert "your simulation" in page
    assert "c: 0.8 to 0.4 N s/m." in page
    assert "engine and parameters" in page
    assert "stands for 0.4 and end-stop" in page


def index() -> Page:
    good = example("a.csv").model_copy(update={"files": {"report": "/d/a/r.html"}})
    failed = FailedDiagnosis(
        recording=UnreadRecording(file="bad.csv"), error="bad.csv: 2 samples; expected at least 50"
    )
    return index_page([good, failed], Path("/d"), "harness diagnose")


def test_the_page_of_many_has_a_row_and_a_link_each() -> None:
    page = render(index())
    assert '<a href="a/r.html">a.csv</a>' in page
    assert "bad.csv: 2 samples; expected at least 50" in page
    assert "1 missing physics, 1 could not be diagnosed" in page


def test_a_browser_draws_every_figure_without_a_word(browser: "Browser", case: Case, tmp_path: Path) -> None:
    path, many = tmp_path / "report.html", tmp_path / "index.html"
    write_report(path, diagnosis_page(*case))
    write_report(many, index())
    for file, wanted in (
        (path, {"channel-x", "channel-a", "residual-x", "residual-a", "plane", "evidence", "attribution"}),
        (many, set[str]()),
    ):
        page, said = open_page(browser, file, "dark")
        marks = ".scatterlayer .trace path, .barlayer .point path"
        plots = "[...document.querySelectorAll('.plot')]"
        script = f"{plots}.filter((p) => p.querySelectorAll('{marks}').length).map((p) => p.dataset.figure)"
        assert (set(page.evaluate(script)), said) == (wanted, [])
        page.close()


def graded(result: DiagnosisResult, verdict: str, grade: str) -> DiagnosisResult:
    """The example with a misfit that its mechanism takes off in part."""
    told = PredictionResult(
        baseline_rmse={"x": 2e-3, "a": 0.0}, refined_rmse={"x": 1e-3, "a": 0.0}, blocks=[0.25], spans_s=[[1.0, 2.0]]
    )
    named = {"grade": grade, "share": 0.72, "holdout": told, "forward": told}
    depends = {"x": 0.3, "v": 0.0, "t": 0.41, "direction": 0.0, "amplitude": 0.4}
    ended = ModelEntry(name="end-stop", variant="positive", parameters={"gap": 0.1, "k_s": 900.0})
    changed = {
        "verdict": verdict,
        "refined_model": result.refined_model.model_copy(update={"terms": [ended]}),
        "mechanisms": [result.mechanisms[0].model_copy(update=named)],
        "remainder": RemainderResult(share=0.28, over_noise=3.4, looks_like="what is left is", depends_on=depends),
        "fit_percent": FitPercent(baseline={"x": 98.25}, refined={"x": 99.125}),
        "evidence": [EvidenceResult(name="end-stop", delta_bic=9e6, share=0.72)],
        "rules": [RuleResult(name="least-ratio", value=1.25, unit="ratio of squares", origin="a simulation")],
    }
    return result.model_copy(update=changed)


@pytest.mark.parametrize(
    ("verdict", "grade", "words"),
    [
        ("main_effect", "main", "main effect"),
        ("one_of", "one-of", "candidate"),
        ("unexplained", "part", "part of it"),
        ("unexplained", "minor", "minor part"),
    ],
)
def test_a_graded_verdict_says_how_much_it_takes_and_what_it_leaves(
    case: Case, verdict: str, grade: str, words: str
) -> None:
    result, recording, simulated = case
    result = graded(result, verdict, grade)
    found = diagnosis_page(result, recording, simulated)
    titles = [section.title for section in found.sections]
    assert titles[1] == "Residual, before and after"
    page = render(found)
    for text in (
        f"<td>{words}</td>",
        "<td>72.0</td>",
        "<td>0.50</td>",
        "leaves 28.0 % of the misfit unexplained; its residual is 3.40 times the sensors&#39; noise",
        "Fit of x (NRMSE) rises from 98.25 to 99.12 %.",
        '"share of the misfit / %"',
        "<summary>Rules that decided</summary>",
        '"with end-stop"',
    ):
        assert text in page
    assert 'in BIC"' not in page
    scene = diagnosis_scene(result, recording, simulated)
    drawn = {view.name: [trace["name"] for trace in view.traces] for view in scene.views if isinstance(view, Figure)}
    assert drawn["channel-x"][-1] == "with end-stop"
    assert drawn["residual-x"][-1] == "with end-stop"


def test_a_page_of_an_older_result_lacks_what_that_did_not_say(case: Case) -> None:
    result, recording, simulated = case
    new = ("remainder", "fit_percent", "rules")
    older = {key: value for key, value in result.model_dump(mode="json", by_alias=True).items() if key not in new} | {
        "schema": "harness.diagnosis/1"
    }
    older["mechanisms"] = [
        {key: value for key, value in one.items() if key not in ("grade", "share", "holdout", "forward")}
        for one in older["mechanisms"]
    ]
    page = render(diagnosis_page(read_diagnosis(older), recording, simulated))
    assert "What the best model leaves" not in page
    assert "Rules that decided" not in page
    assert "BIC gained" in page


def test_eighty_columns_hold_every_digit(case: Case, capsys: pytest.CaptureFixture[str]) -> None:
    result = graded(case[0], "one_of", "one-of")
    named = [
        result.mechanisms[0].model_copy(update={"name": name})
        for name in ("position-dependent-friction", "power-law-damping")
    ]
    print_diagnosis(result.model_copy(update={"mechanisms": named, "files": {"report": "r.html"}}))
    lines = [line for line in capsys.readouterr().out.splitlines() if line[:1] in "┏┃┡│└"]
    assert max(map(len, lines)) <= 80
    assert not any("…" in line for line in lines)
    assert sum("one-of" in line and "72 %" in line and line.count("x 0.5") == 2 for line in lines) == 2
    assert any("98.25 %" in line and "99.12 %" in line for line in lines)


@pytest.mark.parametrize(
    ("after", "said"),
    [
        ((3.5, 98.0), ["falls from 14.59 to 3.500 (1 when only noise is left).", "rises from 64.43 to 98.00 %."]),
        ((20.0, -52.85), ["rises from 14.59 to 20.00 (1 when only noise is left).", "falls from 64.43 to −52.85 %."]),
        ((None, 98.0), ["rises from 64.43 to 98.00 %."]),
    ],
)
def test_a_figure_rises_or_falls_as_it_does(after: tuple[float | None, float], said: list[str]) -> None:
    """A force fits better with a law, by which the motion need not be followed better."""
    chi2, fit = after
    one = example("bench.csv")
    before = one.baseline.model_copy(update={"chi2_per_point": None if chi2 is None else 14.59})
    percent = FitPercent(baseline={"x": 64.43}, refined={"x": fit})
    refined = one.refined.model_copy(update={"chi2_per_point": chi2})
    result = one.model_copy(update={"baseline": before, "refined": refined, "fit_percent": percent})
    found = gained(result)
    heads = ["Fit of x (NRMSE)"] if chi2 is None else ["Chi-square per point", "Fit of x (NRMSE)"]
    assert found == [f"{head} {words}" for head, words in zip(heads, said, strict=True)]
    assert gained(result.model_copy(update={"mechanisms": []}))[-1] == "Fit of x (NRMSE) is 64.43 %."


SIDE = [-1.0, 0.0, 1.0]
CURVE: dict[str, Any] = {
    "form": "f(x)",
    "of": "x",
    "at": SIDE,
    "at_unit": "m",
    "force": [0.1, 0.2, 0.3],
    "stderr": [0.01, 0.01, 0.01],
    "force_unit": "N",
    "gauge": "no straight line",
    "described": "odd",
    "nearest": [{"name": "cubic-stiffness", "share": 0.8}],
}
PLANE: dict[str, Any] = {
    "form": "f(x, v)",
    "x": SIDE,
    "x_unit": "m",
    "v": SIDE,
    "v_unit": "m/s",
    "force": [[None, -0.5, None], [0.0, 0.1, 0.0], [None, 0.4, None]],
    "stderr": [[None, 0.1, None], [0.2, 0.1, 0.2], [None, 0.1, None]],
    "force_unit": "N",
    "gauge": "no force of position alone",
    "described": "a resistance that depends on the place too",
}


def figures(curves: int, plane: bool) -> list[Figure]:
    tables = [TableResult.model_validate(CURVE)] * curves
    surface = SurfaceResult.model_validate(PLANE) if plane else None
    found = nameless(example("bench.csv", tables=tables, surface=surface)).blocks
    return [block for block in found if isinstance(block, Figure)]


def test_a_curve_is_drawn_with_its_band_and_what_comes_near() -> None:
    (figure,) = figures(1, False)
    assert len(figure.traces) == 3
    assert np.allclose(figure.traces[1]["y"] - figure.traces[0]["y"], 0.04)
    assert "cubic-stiffness (80 % of it)" in figure.caption


def test_a_plane_is_blank_where_nothing_is_known() -> None:
    curve, plane = figures(1, True)
    assert curve.name != plane.name
    assert plane.traces[0]["z"][0] == [None, -0.5, None]
    assert (plane.traces[0]["zmin"], plane.traces[0]["zmax"]) == (-0.5, 0.5)
    assert "A resistance that depends on the place too" in plane.caption
    assert "there nothing is known" in plane.caption
    # as the page writes it: no number that JSON does not have
    json.dumps(Pool().spec(plane), allow_nan=False)


def test_a_plane_stands_alone() -> None:
    (plane,) = figures(0, True)
    assert plane.layout["yaxis"]["title"]["text"] == "speed / (m/s)"
