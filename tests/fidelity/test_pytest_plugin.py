"""The suite as tests of an engine's own: one a row, chosen and marked as any test, on the build that is installed."""

import json
import os
from pathlib import Path

import pytest

from harness.app.sweep import regress as room
from harness.app.sweep.sweep import SweepOptions
from harness.engines import registry
from harness.fidelity.matrix import Matrix
from harness.fidelity.row import run_row

pytest_plugins = ["pytester"]

ROOT = Path(__file__).resolve().parents[2]
PUBLISHED = ROOT / "reports" / "fidelity" / "baseline.json"
PLUGIN = ("-p", "harness.app.pytest_friction", "--friction-fidelity", "--friction-engine", "mujoco")
BASELINE = ("--friction-baseline", str(PUBLISHED))
QUICK = ("-k", "joint and hold-97")
HOLD = "mujoco@4.0.0/joint/tuned/dt=0.001/hold-97"


@pytest.fixture(scope="module", autouse=True)
def loaded() -> None:
    """What pytester's runs load is forgotten after each, and Numba cannot be loaded twice."""
    engine = registry.load("mujoco")
    spec = next(spec for spec in Matrix(short=True).specs({"mujoco": engine}) if spec.name == HOLD)
    assert run_row(engine, spec).error is None
    room.compared(PUBLISHED, {}, SweepOptions(("mujoco",), short=True))


@pytest.fixture
def softer(pytester: pytest.Pytester) -> Path:
    """A baseline in which one row crept less than it does."""
    data = json.loads(PUBLISHED.read_text())
    data["rows"][HOLD]["metrics"]["creep_m_s"] *= 0.01
    path = pytester.path / "friction.json"
    path.write_text(json.dumps(data))
    return path


def test_every_row_is_a_test(pytester: pytest.Pytester) -> None:
    pytester.makepyfile("def test_of_my_own(): pass")
    done = pytester.runpytest_inprocess(*PLUGIN, *BASELINE, "--collect-only", "-q")
    ids = [line for line in done.outlines if "::" in line]
    assert len(ids) == 31
    assert f"friction-fidelity::{HOLD}" in ids
    assert ids[0].endswith("::test_of_my_own")
    chosen = pytester.runpytest_inprocess(*PLUGIN, *BASELINE, "--collect-only", "-q", "-m", "friction_fidelity", *QUICK)
    assert len([line for line in chosen.outlines if "::" in line]) == 2


def test_without_the_option_there_is_none(pytester: pytest.Pytester) -> None:
    done = pytester.runpytest_inprocess(*PLUGIN[:2], "--collect-only", "-q", "--strict-markers")
    assert not [line for line in done.outlines if "friction-fidelity" in line]


def test_rows_that_hold_pass_and_one_that_moved_fails(pytester: pytest.Pytester, softer: Path) -> None:
    pytester.runpytest_inprocess(*PLUGIN, *BASELINE, *QUICK).assert_outcomes(passed=2, deselected=28)
    worse = pytester.runpytest_inprocess(*PLUGIN, "--friction-baseline", str(softer), *QUICK)
    worse.assert_outcomes(passed=1, failed=1, deselected=28)
    assert any("creep_m_s worse" in line for line in worse.outlines)
    assert not any("Traceback" in line for line in worse.outlines)


def test_a_project_says_in_its_configuration_what_is_skipped_and_known(pytester: pytest.Pytester, softer: Path) -> None:
    pytester.makeini(
        f"""
        [pytest]
        xfail_strict = true
        friction_baseline = friction.json
        friction_engines = mujoco
        friction_skip =
            */as-shipped/*/hold-97: too slow here
        friction_xfail =
            {HOLD}: softer, known
        """
    )
    done = pytester.runpytest_inprocess("-p", "harness.app.pytest_friction", "--friction-fidelity", "-rsx", *QUICK)
    done.assert_outcomes(skipped=1, xfailed=1, deselected=28)
    assert any("too slow here" in line for line in done.outlines)
    assert any("softer, known" in line for line in done.outlines)


def test_the_baseline_is_a_fixture_that_a_project_may_replace(pytester: pytest.Pytester, softer: Path) -> None:
    pytester.makeconftest(
        f"""
        import pathlib, pytest
        @pytest.fixture(scope="session")
        def friction_baseline():
            return pathlib.Path({str(softer)!r})
        """
    )
    pytester.runpytest_inprocess(*PLUGIN, *QUICK).assert_outcomes(passed=1, failed=1, deselected=28)


def test_without_a_baseline_or_with_another_engines_every_row_says_so(pytester: pytest.Pytester) -> None:
    done = pytester.runpytest_inprocess(*PLUGIN, *QUICK)
    done.assert_outcomes(errors=2, deselected=28)
    assert any("--update, then --friction-baseline friction.json" in line for line in done.outlines)
    data = json.loads(PUBLISHED.read_text())
    data["rows"] = {name: row for name, row in data["rows"].items() if row["engine"] == "dart"}
    (pytester.path / "other.json").write_text(json.dumps(data))
    other = pytester.runpytest_inprocess(*PLUGIN, "--friction-baseline", "other.json", *QUICK)
    other.assert_outcomes(failed=2, deselected=28)
    assert any("the baseline has no row of mujoco" in line for line in other.outlines)


def test_an_engine_that_there_is_not_is_a_usage_error(pytester: pytest.Pytester) -> None:
    done = pytester.runpytest_inprocess(*PLUGIN, "--friction-engine", "mujco", *BASELINE)
    assert done.ret == pytest.ExitCode.USAGE_ERROR
    assert any("--friction-engine: 'mujco'" in line and "did you mean mujoco" in line for line in done.errlines)


def test_a_baseline_that_is_named_and_is_none_is_a_usage_error(pytester: pytest.Pytester) -> None:
    (pytester.path / "notes.json").write_text("{}")
    for name, found in (("gone.json", "No such file"), ("notes.json", "no harness.baseline/1")):
        done = pytester.runpytest_inprocess(*PLUGIN, "--friction-baseline", name, *QUICK)
        assert done.ret == pytest.ExitCode.USAGE_ERROR
        assert any(found in line and line.endswith("friction.json --update") for line in done.errlines)


def test_the_whole_matrix_has_a_test_that_no_row_is_gone(pytester: pytest.Pytester) -> None:
    data = json.loads(PUBLISHED.read_text())
    data["rows"][f"{HOLD}-of-old"] = data["rows"][HOLD]
    (pytester.path / "older.json").write_text(json.dumps(data))
    line = (*PLUGIN, "--friction-whole", "-k", "no-row-is-gone")
    pytester.runpytest_inprocess(*line, *BASELINE).assert_outcomes(passed=1, deselected=len(all_rows()))
    gone = pytester.runpytest_inprocess(*line, "--friction-baseline", "older.json")
    gone.assert_outcomes(failed=1, deselected=len(all_rows()))
    assert any("hold-97-of-old" in line for line in gone.outlines)


def all_rows() -> list[str]:
    return [spec.name for spec in Matrix().specs({"mujoco": registry.load("mujoco")})]


def test_rows_are_shared_out_among_processes(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("xdist")
    monkeypatch.setenv("PYTHONPATH", f"{ROOT}{os.pathsep}{os.environ.get('PYTHONPATH', '')}")
    done = pytester.runpytest_subprocess(*PLUGIN, *BASELINE, *QUICK, "-n", "1", "-v")
    done.assert_outcomes(passed=2)
    assert any(line.startswith("[gw0]") and HOLD in line for line in done.outlines)


def test_sentences_for_a_test_of_ones_own(
    pytester: pytest.Pytester, softer: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    held = {name: row.model_dump() for name, row in room.load_baseline(PUBLISHED).rows.items()}
    monkeypatch.setattr(room, "fresh_rows", lambda options: {HOLD: held[HOLD]})
    pytester.makepyfile("def test_friction(friction_regressions):\n    assert friction_regressions('mujoco') == []\n")
    pytester.runpytest_inprocess(*PLUGIN[:2], *BASELINE).assert_outcomes(passed=1)
    pytester.runpytest_inprocess(*PLUGIN[:2], "--friction-baseline", str(softer)).assert_outcomes(failed=1)
