"""The gate: a degraded setting is caught, noise in speed is not; rows against figures that engines are known by."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from jsonschema import Draft202012Validator
from lxml import etree

import harness
from harness.app.sweep import regress as room
from harness.app.sweep.report import keep_worst, recomputed
from harness.app.sweep.sweep import SweepOptions, sweep
from harness.cli.commands.regress import command
from harness.core.errors import InputError
from harness.engines import registry
from harness.engines.base import Preset, Route
from harness.fidelity.compare import TOLERANCES, kept, moves
from harness.fidelity.kind import Metrics, suite
from harness.fidelity.matrix import Matrix
from harness.fidelity.row import Spec, run_row
from harness.results.generate import schema_text
from harness.results.sweep import RegressResult

PUBLISHED = Path(__file__).resolve().parents[2] / "reports" / "fidelity" / "baseline.json"
ONE = SweepOptions(("mujoco",), ("joint",), short=True, jobs=1)


@cache
def rows_with(setting: str, value: Any) -> room.Rows:
    """The short rows of MuJoCo's joint, with a setting changed behind the back of the matrix."""
    engine = registry.load("mujoco")
    specs = Matrix(("joint",), short=True).specs({"mujoco": engine})
    return {s.name: kept(run_row(engine, replace(s, changed=((setting, value),))).model_dump()) for s in specs}


@pytest.fixture(scope="module")
def fresh() -> room.Rows:
    """The short rows of every installed engine."""
    return room.fresh_rows(SweepOptions(short=True, jobs=1))


@pytest.fixture(scope="module")
def rows(fresh: room.Rows) -> room.Rows:
    """Those of MuJoCo's joint."""
    specs = Matrix(("joint",), short=True).specs({"mujoco": registry.load("mujoco")})
    return {spec.name: fresh[spec.name] for spec in specs}


@pytest.fixture
def baseline(rows: room.Rows, tmp_path: Path) -> Path:
    room.update(tmp_path / "baseline.json", rows, ONE)
    return tmp_path / "baseline.json"


def test_the_published_baseline_holds_for_every_installed_engine(fresh: room.Rows) -> None:
    """The short form of the gate, as every change has to pass it."""
    result = room.compared(PUBLISHED, fresh, SweepOptions(short=True, jobs=1))
    assert [room.sentence(moved) for moved in result.moved] == []
    assert result.rows >= 50


@pytest.mark.full
def test_the_whole_published_baseline_holds() -> None:
    options = SweepOptions()
    result = room.compared(PUBLISHED, room.fresh_rows(options), options)
    assert [room.sentence(moved) for moved in result.moved] == []


def test_every_metric_of_the_baseline_has_a_tolerance_with_an_origin() -> None:
    found = {metric for row in room.load_baseline(PUBLISHED).rows.values() for metric in row.metrics}
    assert found == set(TOLERANCES)
    assert all(len(limit.origin) > 10 for limit in TOLERANCES.values())


def test_the_published_baseline_is_of_the_locked_versions() -> None:
    machine = room.load_baseline(PUBLISHED).machine
    assert machine.packages["mujoco"] == "4.0.0"
    assert machine.packages["pybullet"] == "3.2.7"


@pytest.mark.parametrize(
    ("setting", "value", "metric"),
    [
        ("solimpfriction", (0.8, 0.85, 0.001, 0.5, 2.0), "creep_m_s"),
        ("solreffriction", (0.03, 1.0), "reversal_lead_s"),
        ("integrator", "discrete", "zeta_rel_error"),
    ],
)
def test_a_planted_regression_is_caught(setting: str, value: Any, metric: str, baseline: Path) -> None:
    result = room.compared(baseline, rows_with(setting, value), ONE)
    worse = {moved.metric for moved in result.moved if moved.verdict == "worse"}
    assert metric in worse
    assert result.regressions >= 3


def test_noise_in_speed_is_not(rows: room.Rows, baseline: Path) -> None:
    engine = registry.load("mujoco")
    spec = next(iter(Matrix(("joint",), short=True).specs({"mujoco": engine})))
    run = run_row(engine, spec)
    noisy = run.model_copy(update={"wall_s": 7.0 * (run.wall_s or 1.0), "steps_per_s": (run.steps_per_s or 1.0) / 7.0})
    slow = rows | {spec.name: kept(noisy.model_dump())}
    assert slow == rows
    assert room.compared(baseline, slow, ONE).moved == []


BEFORE: dict[str, Any] = {
    "metrics": {"period_s": 0.667, "creep_m_s": 0.0},
    "exact": {"period_s": 0.6658},
    "error": None,
}


@pytest.mark.parametrize(
    ("change", "verdicts"),
    [
        ({}, []),
        ({"metrics": {"period_s": 0.6671, "creep_m_s": 5e-10}}, []),
        ({"metrics": {"period_s": 0.668, "creep_m_s": 0.0}}, ["worse"]),
        ({"metrics": {"period_s": 0.6659, "creep_m_s": 0.0}}, ["better"]),
        ({"metrics": {"period_s": 0.6632, "creep_m_s": -1e-3}}, ["worse", "worse"]),
        ({"metrics": {"period_s": None, "creep_m_s": 0.0}}, ["lost"]),
        ({"metrics": {}, "error": "diverged"}, ["fails"]),
    ],
)
def test_verdicts(change: dict[str, Any], verdicts: list[str]) -> None:
    before = BEFORE | {"dt_s": 1e-3}
    assert [move.verdict for move in moves("row", before, before | change)] == verdicts


def test_rows_that_come_and_go() -> None:
    row = BEFORE | {"dt_s": 1e-3}
    assert [move.verdict for move in moves("row", row, None)] == ["missing"]
    assert [move.verdict for move in moves("row", None, row)] == ["new"]
    assert [move.verdict for move in moves("row", row | {"error": "no"}, row)] == ["works"]


def test_a_missing_row_is_a_regression_only_of_a_whole_matrix(rows: room.Rows, baseline: Path) -> None:
    fewer = dict(list(rows.items())[:-1])
    assert room.compared(baseline, fewer, ONE).regressions == 0
    whole = room.compared(baseline, fewer, SweepOptions(("mujoco",)))
    assert [moved.verdict for moved in whole.moved] == ["missing"]


def test_update_of_one_engine_keeps_the_others(rows: room.Rows, baseline: Path) -> None:
    other = {name.replace("mujoco", "pybullet"): row | {"engine": "pybullet"} for name, row in rows.items()}
    room.update(baseline, other, SweepOptions(("pybullet",)))
    assert set(room.load_baseline(baseline).rows) == set(rows) | set(other)


@pytest.mark.parametrize("part", [{"short": True}, {"routes": ("joint",)}, {"steps": (1e-3,)}, {"presets": ("tuned",)}])
def test_update_of_a_part_keeps_the_rest_and_of_the_whole_drops_what_is_gone(
    part: dict[str, Any], rows: room.Rows, baseline: Path
) -> None:
    fewer = dict(list(rows.items())[:-1])
    room.update(baseline, fewer, SweepOptions(("mujoco",), **part))
    assert set(room.load_baseline(baseline).rows) == set(rows)
    room.update(baseline, fewer, SweepOptions(("mujoco",)))
    assert set(room.load_baseline(baseline).rows) == set(fewer)


@pytest.fixture(scope="module")
def traces(tmp_path_factory: pytest.TempPathFactory) -> Path:
    options = replace(ONE, routes=("joint", "contact"), keep=2)
    result = sweep(options, tmp_path_factory.mktemp("regress") / "out")
    written = keep_worst(result, options)
    assert len(written) == 2
    return result.folder / "traces"


def test_stored_traces_give_every_metric_bitwise_again(traces: Path) -> None:
    result = harness.regress(traces=traces)
    assert (result.rows, result.moved) == (2, [])
    row, before = recomputed(sorted(traces.glob("*.rrd"))[0])
    assert row["metrics"] == before
    assert any(value is not None for value in before.values())


def test_stored_traces_gate_against_the_baseline_without_an_engine(
    traces: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(registry, "load", None)
    result = room.compared_traces(traces, PUBLISHED)
    assert (result.rows, result.moved) == (2, [])


def test_a_change_of_a_metric_is_seen_in_stored_traces(traces: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from harness.fidelity.scenarios import hold as hold_metrics

    monkeypatch.setattr(hold_metrics, "drift_m", lambda trace: 1.0)
    monkeypatch.setattr("harness.fidelity.row.recovered", lambda trace, scenario: {"zeta": 0.06})
    assert room.compared_traces(traces, PUBLISHED).regressions > 0


def test_command(baseline: Path, tmp_path: Path) -> None:
    junit = tmp_path / "friction.xml"
    arguments = ["--baseline", str(baseline), "--engine", "mujoco", "--route", "joint", "--short", "--jobs", "1"]
    done = CliRunner().invoke(command, [*arguments, "--junit", str(junit), "--json", "-"], standalone_mode=False)
    assert done.return_value == 0
    data = json.loads(done.stdout)
    Draft202012Validator(json.loads(schema_text("harness.regress/1", RegressResult))).validate(data)
    suite = etree.parse(str(junit)).find("testsuite")
    assert suite.get("failures") == "0"
    assert int(suite.get("tests")) == data["rows"] == len(suite.findall("testcase"))


def test_junit_names_what_failed(rows: room.Rows, baseline: Path) -> None:
    result = room.compared(baseline, rows_with("integrator", "discrete"), ONE)
    suite = etree.fromstring(room.junit(result, rows).encode()).find("testsuite")
    failed = [case for case in suite if case.find("failure") is not None]
    assert len(failed) == int(suite.get("failures")) > 0
    assert "worse" in failed[0].find("failure").get("message")


@pytest.mark.parametrize(
    ("content", "message"),
    [(None, "No such file or directory. Try: --baseline friction.json --update"), ("{}", "no harness.baseline/1")],
)
def test_bad_baselines(content: str | None, message: str, tmp_path: Path) -> None:
    path = tmp_path / "b.json"
    if content is not None:
        path.write_text(content)
    with pytest.raises(InputError, match=message):
        room.load_baseline(path)


def metrics(engine: str, route: Route, base: Preset, dt: float | None, scenario: str, **changed: object) -> Metrics:
    found = registry.load(engine)
    case = suite(route)[scenario]
    row = run_row(found, Spec(engine, found.version(), route, "x", base, tuple(changed.items()), dt, case))
    assert row.error is None
    return row.metrics


def test_a_stiff_contact_throws_a_fast_box_up() -> None:
    changed = {"cone": "elliptic", "solref": (0.002, 1.0), "solimp": (0.9999, 0.9999, 0.001, 0.5, 2.0)}
    fast = metrics("mujoco", "contact", "as-shipped", 1e-3, "free-decay-x10", **changed)["lift_m"]
    slow = metrics("mujoco", "contact", "as-shipped", 1e-3, "free-decay", **changed)["lift_m"]
    assert fast is not None
    assert slow is not None
    assert 0.170 < fast < 0.250
    assert slow < 1e-4


def test_what_cannot_run_is_a_row_with_its_reason() -> None:
    engine = registry.load("mujoco")
    case = suite("joint")["free-decay"]
    for changed, dt, message in (
        ((("integrator", "Verlet"),), 1e-3, "one of Euler, RK4"),
        ((("no_such", 1),), 1e-3, "mujoco setting no_such: unknown"),
        ((), 0.3, "diverged"),
    ):
        row = run_row(engine, Spec("mujoco", "x", "joint", "bad", "as-shipped", changed, dt, case))
        assert row.error is not None
        assert message in row.error
        assert row.metrics == {}
