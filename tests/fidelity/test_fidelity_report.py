"""The page of a sweep, its scorecard, orders and conclusions; the published one."""

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from browsed import open_page

from harness.app.sweep.report import finish, worst_rows
from harness.app.sweep.sweep import Sweep, SweepOptions, sweep
from harness.fidelity.compare import Ladder, slope
from harness.fidelity.laws import SERVOS, WITHOUT_EFFECT
from harness.fidelity.published import PUBLISHED as SAID
from harness.fidelity.scores import FLOOR, LABELS, badness, cards, distance, figures_of, front, points
from harness.show.numbers import number
from harness.show.report.effort import efforts
from harness.show.report.glance import Glance, glances
from harness.show.sentences import sentences

if TYPE_CHECKING:
    from playwright.sync_api import Browser

PUBLISHED = Path(__file__).resolve().parents[2] / "reports" / "fidelity"
EFFORTS = ("=100,ls_iterations=50", "=4,", "=1,ls_iterations=50")
"""Those that ship, those often trained with, and what is recommended."""
ONLY = (
    *("/as-shipped/dt=own/", "/tuned/dt=0.001/"),
    *(f"joint/trained/integrator=Euler,iterations{effort}" for effort in EFFORTS),
    *(f"ratio=100,iterations{effort}" for effort in EFFORTS),
)
SKIP = (
    *("pybullet*/contact/*", "*/free-decay-x*", "*/incline-*", "*/pinch-sphere", "*/spinning", "*/harmonic-stops"),
    *("*/contact/*-belt", "*/contact/*/hold-slid-*"),
)
"""What a page looks the same without."""
OPTIONS = SweepOptions(("mujoco", "pybullet"), ("joint", "contact"), only=ONLY, skip=SKIP, jobs=1, keep=2)
"""Every section of a page: a joint, a contact, bodies, curves of friction, and effort."""


@pytest.fixture(scope="module")
def swept(pybullet: None, tmp_path_factory: pytest.TempPathFactory) -> Sweep:
    result = sweep(OPTIONS, tmp_path_factory.mktemp("report") / "out")
    finish(result, OPTIONS)
    return result


@pytest.fixture(scope="module")
def rows(swept: Sweep) -> list[dict[str, Any]]:
    return list(swept.rows())


def test_page_is_one_file_without_network(swept: Sweep) -> None:
    page = (swept.folder / "report.html").read_text()
    assert len(page) < 5_000_000
    assert "default-src 'none'" in page  # the browser itself refuses any address
    for heading in (
        "Every engine at a glance",
        "Scorecard",
        "Error against cost",
        "Worst rows",
    ):
        assert f">{heading}<" in page
    assert ">Convergence in the step<" not in page  # two steps are no order
    files = re.findall(r'href="(traces/[^"]+)"', page)
    assert len(files) == 2
    assert all((swept.folder / file).is_file() for file in files)


def test_page_draws_without_an_error(swept: Sweep, browser: "Browser") -> None:
    page, said = open_page(browser, swept.folder / "report.html")
    plots = page.evaluate("[...document.querySelectorAll('.plot')].map(plot => plot.querySelectorAll('.trace').length)")
    page.close()
    assert said == []
    assert len(plots) >= 5
    assert all(count > 0 for count in plots)


def test_as_shipped_and_tuned_stand_beside_each_other(rows: list[dict[str, Any]]) -> None:
    found = [card for card in cards(rows) if card.route == "joint"]
    assert [(card.engine, card.preset) for card in found] == [
        ("mujoco", "as-shipped"),
        ("mujoco", "tuned"),
        ("pybullet", "as-shipped"),
        ("pybullet", "tuned"),
    ]
    assert [card.dt_s for card in found] == pytest.approx([2e-3, 1e-3, 1.0 / 240.0, 1e-3])
    for shipped, tuned in zip(found[::2], found[1::2], strict=True):
        for label in ("position", "x_k narrow", "zeta"):
            before, after = shipped.values[label], tuned.values[label]
            assert before is not None
            assert after is not None
            assert after < before


def matrix(result: Sweep) -> list[Glance]:
    rows = list(result.rows())
    return glances(rows, cards(rows), efforts(rows))


def test_the_matrix_has_the_worst_of_every_engine_as_shipped_and_tuned(swept: Sweep) -> None:
    found = matrix(swept)
    assert [(line.card.engine, line.card.preset) for line in found] == [
        (engine, preset) for engine in ("mujoco", "pybullet") for preset in ("as-shipped", "tuned")
    ]
    columns = {"free decay": "free-decay", "hold": "hold-", "belt": "belt", "harmonic": "harmonic"}
    for line in found:
        mine = [row for row in swept.rows() if (row["engine"], row["preset"]) == (line.card.engine, line.card.preset)]
        for column, scenario in columns.items():
            own = [row for row in mine if row["route"] == "joint" and row["scenario"].startswith(scenario)]
            far = [distance(row, figure) for row in own for figure in figures_of(row["scenario"])]
            assert line.worst[column][0] == max(value for value in far if value is not None)
    shipped, tuned = found[0].worst, found[1].worst
    assert all(tuned[column][0] < shipped[column][0] for column in shipped)
    # as people train, and with the effort that is recommended
    assert shipped["as people train"][1].startswith("4/8: ")
    assert tuned["as people train"][1].startswith("4/50: ")
    assert tuned["contact"][0] < 0.05 < shipped["contact"][0]
    assert not {"contact", "as people train"} & set(found[2].worst)


def test_the_page_begins_with_it_and_folds_its_other_tables(swept: Sweep, browser: "Browser") -> None:
    page, said = open_page(browser, swept.folder / "report.html")
    heads = page.evaluate("[...document.querySelector('table').tHead.rows[0].cells].map(cell => cell.innerText)")
    first = page.evaluate("document.querySelector('section').querySelectorAll('table').length")
    legend = page.evaluate("[...document.querySelectorAll('.legend span')].map(one => one.className)")
    told = page.evaluate("document.querySelector('section').querySelectorAll('.said dt').length")
    loose = page.evaluate(
        "[...document.querySelectorAll('section ~ section table')].filter(t => !t.closest('details')).length"
    )
    page.close()
    assert said == []
    assert [head.split("\n")[0].replace("\u00ad", "") for head in heads] == [
        "engine", "free decay", "hold", "belt", "harmonic", "contact", "as people train"
    ]  # fmt: skip
    assert (first, told, loose) == (1, 2, 0)
    assert legend == [f"grade-{grade}" for grade in range(5)]


@pytest.mark.parametrize(
    ("width", "tables"), [(1280, ".scroll"), (500, ".scroll:has(.compact)"), (360, ".scroll:has(.compact)")]
)
def test_nothing_is_cut(swept: Sweep, browser: "Browser", width: int, tables: str) -> None:
    """Of any table on a screen of 1,280 pixels, of the matrix on a phone."""
    page, _ = open_page(browser, swept.folder / "report.html", width=width)
    page.evaluate("document.querySelectorAll('details').forEach(one => { one.open = true; })")
    shown = page.evaluate(f"[...document.querySelectorAll('{tables}')].map(one => one.scrollWidth - one.clientWidth)")
    beyond = page.evaluate("document.documentElement.scrollWidth")
    page.close()
    assert shown
    assert max(shown) <= 0
    assert beyond <= width


def test_engines_repeat_themselves_and_friction_has_its_table(rows: list[dict[str, Any]], swept: Sweep) -> None:
    again = {(row["name"], between): far for row in rows for between, far in (row.get("apart_m") or {}).items()}
    assert len(again) == 6  # as shipped and tuned, on each route of both
    assert set(again.values()) == {0.0}
    page = (swept.folder / "report.html").read_text()
    assert ">repeats" in page
    assert ">Static, Stribeck and polynomial friction<" in page


def test_effort_is_drawn_with_what_is_recommended_and_its_cost(swept: Sweep) -> None:
    page = (swept.folder / "report.html").read_text()
    best = [one for one in efforts(list(swept.rows())) if one.recommended]
    assert [(one.row["route"], one.effort) for one in best] == [("joint", (1, 50)), ("contact", (4, 50))]
    for one in best:
        assert f"at {number(one.steps_per_s / 1e3, 3)} thousand steps a second" in page
    for name in ("creep", "rest", "decrement"):
        assert f'id="plot-effort-{name}"' in page


def test_distance_is_against_exact(rows: list[dict[str, Any]]) -> None:
    for row in rows:
        for figure in figures_of(row["scenario"]):
            if row["metrics"].get(figure.metric) is not None:
                exactly = row | {"metrics": row["metrics"] | {figure.metric: row["exact"].get(figure.metric, 0.0)}}
                assert distance(exactly, figure) == 0.0
                found = distance(row, figure)
                assert found is not None
                assert found >= 0.0


def test_conclusions_name_what_to_change_and_what_stays(rows: list[dict[str, Any]]) -> None:
    said = sentences(cards(rows))
    text = " ".join(said)
    assert "MuJoCo 4.0.0, joint friction: as shipped x_k narrow off by 100 %" in text
    assert "integrator to RK4" in text
    assert "linearDamping to 0" in text
    assert "what stays wrong after that: nothing above 1 %" in text


def test_front_holds_what_nothing_beats(rows: list[dict[str, Any]]) -> None:
    every = points(rows)
    best = front(every)
    for point in every:
        assert FLOOR <= point.score < 1.0
        assert any(one.cost <= point.cost and one.score <= point.score for one in best)
    for one in best:
        assert not any(point.cost < one.cost and point.score < one.score for point in every)


def test_worst_rows_come_from_different_places_first(swept: Sweep, rows: list[dict[str, Any]]) -> None:
    worst = worst_rows(swept, 6)
    assert badness(worst[0]) == max(badness(row) for row in rows)
    groups = [(row["engine"], row["route"], row["scenario"]) for row in worst]
    assert len(set(groups)) == 6
    assert len(worst_rows(swept, 10_000)) == len(rows)
    assert len({row["key"] for row in worst_rows(swept, 10_000)}) == len(rows)


def test_orders_are_the_slope_of_a_power(rows: list[dict[str, Any]]) -> None:
    dt = [4e-3, 2e-3, 1e-3, 5e-4]
    order, spread = slope(dt, [7.0 * step**3 for step in dt])
    assert order == pytest.approx(3.0, abs=1e-12)
    assert spread == pytest.approx(1.0, abs=1e-12)
    crooked = slope(dt, [2.0 * dt[0], dt[1], dt[2], dt[3]])
    assert crooked[1] > 1.1
    ladder = Ladder()
    for row in rows:
        ladder.add(row)
    # two steps are not enough, and a row of random sliders does not count
    assert {order.preset for order in ladder.orders()} <= {"as-shipped"}


def test_the_page_has_the_servos_and_the_silent_words_of_the_document() -> None:
    text = (Path(__file__).resolve().parents[2] / "docs" / "fidelity.md").read_text(encoding="utf-8")
    for one in WITHOUT_EFFECT:
        assert any(line.startswith(f"| {one.engine} |") and one.what in line for line in text.splitlines()), one
    for servo in SERVOS:
        false, zeta = f"{servo.false_damping:+.3g}" if servo.false_damping else "0", f"{servo.zeta:.3f}"
        assert any(line.startswith(f"| {servo.who} | {servo.n} | {false} | {zeta}") for line in text.splitlines()), (
            servo
        )


def test_what_others_publish_is_held_against_rows_of_the_baseline(swept: Sweep) -> None:
    rows = json.loads((PUBLISHED / "baseline.json").read_text())["rows"]
    page = (swept.folder / "report.html").read_text()
    own = {row["name"] for row in swept.rows()}
    for one in SAID:
        # rows that a sweep has not are not said to be "here"
        assert (one.why in page) == (one.row in own)
        assert one.row in rows
        if one.value is not None:
            assert rows[one.row]["metrics"][one.metric] == pytest.approx(one.value, rel=0.01)


def test_the_published_report_is_small_and_whole() -> None:
    files = [path for path in PUBLISHED.rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files) <= 5_000_000
    page = (PUBLISHED / "report.html").read_text()
    links = re.findall(r'href="(traces/[^"]+)"', page)
    assert links
    assert all((PUBLISHED / link).is_file() for link in links)
    assert "python -m benchmarks.publish fidelity" in page
    assert len(LABELS) == len(set(LABELS))
