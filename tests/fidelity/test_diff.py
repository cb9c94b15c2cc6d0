"""Two engines, versions or sweeps against each other: what moved, what is new, what one of them lacks."""

import json
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from jsonschema import Draft202012Validator

import harness
from harness.app.sweep import regress as room
from harness.app.sweep.diff import Side, compared, side
from harness.app.sweep.report import finish
from harness.app.sweep.sweep import SweepOptions, sweep
from harness.cli.commands.diff import command
from harness.core.errors import InputError
from harness.fidelity.select import Selection
from harness.results.generate import schema_text
from harness.results.sweep import DiffResult
from harness.show.report.diff import diff_lines

PUBLISHED = Path(__file__).resolve().parents[2] / "reports" / "fidelity" / "baseline.json"
SHORT = partial(SweepOptions, routes=("joint",), short=True, jobs=1)
DISCRETE = "joint/as-shipped/integrator=discrete/dt=0.002"


def row(engine: str, version: str, settings: str, scenario: str, **more: Any) -> tuple[str, dict[str, Any]]:
    route = settings.partition("/")[0]
    about = {"engine": engine, "version": version, "environment": "", "route": route, "scenario": scenario}
    measured = {"dt_s": 1e-3, "metrics": {"period_s": 0.667}, "exact": {"period_s": 0.6658}, "error": None}
    return f"{engine}@{version}/{settings}/{scenario}", {**about, **measured, **more}


def rows(*found: tuple[str, dict[str, Any]]) -> Side:
    return Side("given", dict(found))


def test_two_versions_of_the_published_baseline() -> None:
    """MuJoCo 3.3.7 has no integrator discrete: those rows are skipped with its reason, and fail nothing."""
    chosen = ("joint/as-shipped/dt=own", DISCRETE)
    result = harness.diff(
        "mujoco@3.3.7", "mujoco@4.0.0", baseline=PUBLISHED, only=chosen, skip=["*/harmonic-stops", "*/*-belt"]
    )
    assert (result.before.engines, result.after.engines) == (["mujoco 3.3.7 (old)"], ["mujoco 4.0.0"])
    lacking = {name for name, why in result.skipped.items() if "no integrator discrete" in why}
    assert lacking == set(result.skipped)
    assert {name.rpartition("/")[0] for name in lacking} == {f"mujoco@4.0.0/{DISCRETE}"}
    assert result.rows == 6
    assert (result.regressions, result.moved, result.new) == (0, [], [])


def test_the_other_way_round_what_the_newer_lacks_is_a_regression() -> None:
    result = harness.diff("mujoco@4.0.0", "mujoco@3.3.7", baseline=PUBLISHED, only=[f"{DISCRETE}/belt"])
    assert [moved.verdict for moved in result.moved] == ["fails"]
    assert result.regressions == 1


def test_an_engine_against_a_sweep_of_it(tmp_path: Path) -> None:
    options = SHORT(engines=("mujoco",), only=("own/belt", "own/hold"))
    done = sweep(options, tmp_path / "before")
    finish(done, options)
    here = side("mujoco", options, None)
    for given in (str(tmp_path / "before"), str(tmp_path / "before" / "result.json")):
        stored = side(given, options, None)
        assert stored.rows == here.rows
        result = compared(stored, here, Selection())
        assert (result.rows, result.moved, result.new, result.skipped) == (2, [], [], {})
        assert "nothing moved" in result.statement
    changed = {
        name: one | {"metrics": {**one["metrics"], "creep_m_s": 1e-2}} if name.endswith("hold-97") else one
        for name, one in here.rows.items()
    }
    worse = compared(Side("before", here.rows), Side("after", changed), Selection())
    assert [(moved.metric, moved.verdict) for moved in worse.moved] == [("creep_m_s", "worse")]
    assert worse.moved[0].times is not None
    assert worse.moved[0].times > 1000.0
    known = compared(Side("before", here.rows), Side("after", changed), Selection.of(xfail=["hold-97: soft"]))
    assert (known.regressions, known.moved[0].expected) == (0, "soft")


def test_two_engines_are_matched_by_their_settings(pybullet: None) -> None:
    result = harness.diff("mujoco", "pybullet", routes=["joint"], short=True, only=["*/joint/tuned/*/[bh]*"], jobs=1)
    assert result.rows == 3
    assert {moved.name.partition("@")[0] for moved in result.moved} == {"pybullet"}
    creep = [moved for moved in result.moved if moved.metric == "creep_m_s" and moved.name.endswith("hold-97")]
    assert [moved.verdict for moved in creep] == ["better"]


def test_what_is_new_gone_or_was_not_run() -> None:
    before = rows(
        row("a", "1", "joint/tuned/dt=0.001", "belt"),
        row("a", "1", "joint/tuned/dt=0.001", "hold-50"),
        row("a", "1", "joint/tuned/dt=0.002", "belt"),
        row("a", "1", "contact/tuned/dt=0.001", "belt"),
        row("b", "1", "joint/tuned/dt=0.001", "belt"),
    )
    after = rows(
        row("a", "2", "joint/tuned/dt=0.001", "belt"),
        row("a", "2", "joint/tuned/dt=0.004", "belt"),
        row("a", "2", "joint/noslip/dt=0.002", "hold-50"),
        row("c", "1", "joint/tuned/dt=0.001", "belt"),
    )
    result = compared(before, after, Selection())
    # its settings were run and its scenario was: it is gone
    assert [(moved.name, moved.verdict) for moved in result.moved] == [("a@2/joint/tuned/dt=0.001/hold-50", "missing")]
    assert sorted(result.new) == ["a@2/joint/noslip/dt=0.002/hold-50", "a@2/joint/tuned/dt=0.004/belt"]
    assert set(result.skipped) == {"b 1", "c 1", "a@2/joint/tuned/dt=0.002/belt", "a@2/contact/tuned/dt=0.001/belt"}
    assert result.rows == 1


def test_what_another_engine_cannot_run_is_no_regression() -> None:
    before = rows(row("a", "1", "joint/tuned/dt=0.001", "belt"))
    after = rows(row("b", "1", "joint/tuned/dt=0.001", "belt", error="no belts", metrics={}))
    result = compared(before, after, Selection())
    assert (result.regressions, list(result.skipped.values())) == (0, ["b 1 lacks it: no belts"])


def test_the_worst_comes_first() -> None:
    settings = "joint/tuned/dt=0.001"
    before = [row("a", "1", settings, name) for name in ("belt", "harmonic", "hold-50")]
    periods = {"belt": 0.70, "harmonic": 0.668, "hold-50": 0.6658}
    after = [row("a", "2", settings, name, metrics={"period_s": value}) for name, value in periods.items()]
    result = compared(rows(*before), rows(*after), Selection())
    assert [(moved.name.rpartition("/")[2], moved.verdict) for moved in result.moved] == [
        ("belt", "worse"),
        ("harmonic", "worse"),
        ("hold-50", "better"),
    ]
    assert result.moved[0].times == pytest.approx((0.70 - 0.667) / 0.5e-3, rel=1e-6)
    assert [line.verdict for line in diff_lines(result)] == ["worse", "worse", "better"]


def test_command_leaves_a_page_and_obeys_its_schema(tmp_path: Path) -> None:
    line = ["mujoco@3.3.7", "mujoco@4.0.0", "--baseline", str(PUBLISHED), "--out", str(tmp_path / "out"), "--json", "-"]
    done = CliRunner().invoke(command, [*line, "-k", "joint/as-shipped"], standalone_mode=False)
    data = json.loads(done.stdout)
    Draft202012Validator(json.loads(schema_text("harness.diff/1", DiffResult))).validate(data)
    assert json.loads((tmp_path / "out" / "result.json").read_text()) == data
    assert done.return_value == (1 if data["regressions"] else 0)
    page = (tmp_path / "out" / "report.html").read_text()
    for moved in data["moved"]:
        assert moved["metric"] in page
    assert "no integrator discrete" in page
    plain = CliRunner().invoke(
        command, [*line[:-4], "-k", "own/belt", "--out", str(tmp_path / "b")], standalone_mode=False
    )
    assert plain.return_value == 0
    assert "nothing moved" in " ".join(plain.stdout.split())


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("mujco", "did you mean mujoco"),
        ("mujoco@1.0", r"Try: python3 -m venv old && old/bin/pip install mujoco==1\.0"),
        ("nix/bin/here", "one of "),
    ],
)
def test_what_is_neither_engine_nor_sweep_is_refused(given: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        side(given, SHORT(), PUBLISHED)


def test_the_folder_of_a_published_baseline_is_its_rows() -> None:
    folder = PUBLISHED.parent
    assert side(str(folder), SHORT(), None).rows == side(str(PUBLISHED), SHORT(), None).rows
    with pytest.raises(InputError, match=r"reports: no result\.json and no baseline\.json"):
        side(str(folder.parent), SHORT(), None)


def test_a_file_that_is_no_sweep_is_refused(tmp_path: Path) -> None:
    (tmp_path / "result.json").write_text('{"schema": "harness.run/1"}')
    with pytest.raises(InputError, match=r"result\.json: no harness\.sweep/1"):
        side(str(tmp_path), SHORT(), None)
    with pytest.raises(InputError, match="has no such rows"):
        harness.diff("mujoco@4.0.0", "mujoco@3.3.7", baseline=PUBLISHED, only=["nosuch"])


def test_the_same_version_from_a_baseline_is_compared_with_what_runs_here() -> None:
    options = replace(SHORT(), only=("joint/tuned/dt=0.001/hold-97",))
    stored, here = side("mujoco@4.0.0", options, PUBLISHED), side("mujoco", options, None)
    assert compared(stored, here, Selection()).moved == []
    assert set(stored.rows) == set(here.rows) == {"mujoco@4.0.0/joint/tuned/dt=0.001/hold-97"}
    assert room.counterpart(("mujoco", "4.0.0", ""), [("mujoco", "3.3.7", "old")]) == ("mujoco", "3.3.7", "old")
