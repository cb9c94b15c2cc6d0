"""A model from a file, run in the reference and both engines."""

import json
from pathlib import Path

import pytest

from harness.app.report.rebuild import rebuild
from harness.app.run.case import ModelScenario, case_of_json
from harness.app.run.run import RunOptions, run
from harness.core.errors import InputError
from harness.model import document
from harness.model.model import Model, ModelTerm, Restoring
from harness.results.run import RunResult

MODEL = Model(
    1.0,
    1.0,
    100.0,
    3.0,
    x0=1.0,
    terms=(
        ModelTerm.named("stribeck", f_s=5.0, v_s=0.5),
        ModelTerm.named("cubic-stiffness", k3=40.0),
        ModelTerm.named("sensor-gain", gain=1.1),
    ),
)


def file_of(model: Model, folder: Path) -> Path:
    file = folder / "model.json"
    file.write_text(json.dumps(document.to_document(model)), encoding="utf-8")
    return file


def scenario_of(file: Path, duration: float | None) -> ModelScenario:
    return ModelScenario.of(document.load(file), duration, str(file))


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> tuple[RunResult, Path]:
    folder = tmp_path_factory.mktemp("model")
    scenario = scenario_of(file_of(MODEL, folder), None)
    return run(RunOptions(scenario, presets=("tuned",)), folder / "out"), folder / "out"


@pytest.mark.usefixtures("pybullet")
def test_engines_move_as_the_reference(done: tuple[RunResult, Path]) -> None:
    reference, *engines = done[0].traces
    assert (reference.source, reference.metrics.max_error_m) == ("reference", 0.0)
    assert [trace.source for trace in engines] == ["mujoco", "pybullet"]
    assert reference.metrics.stick_time_s is not None
    for trace in engines:
        assert trace.error is None
        assert trace.metrics.max_error_m is not None
        assert trace.metrics.max_error_m < 2e-3
        assert trace.metrics.half_cycles == reference.metrics.half_cycles
        assert trace.metrics.stick_time_s == pytest.approx(reference.metrics.stick_time_s, abs=0.02)


def test_what_acts_and_what_is_left_out_is_said(done: tuple[RunResult, Path]) -> None:
    result, folder = done
    assert any(line.startswith("stribeck: ") for line in result.conclusions)
    assert any("sensor-gain change what a sensor makes of it" in line for line in result.conclusions)
    left_out = (folder / "model" / "not_said.txt").read_text(encoding="utf-8")
    assert "xml: no stribeck (f_s = 5, v_s = 0.5)" in left_out
    assert document.load(folder / "model" / "model.json") == MODEL


def test_the_page_is_made_again_from_the_trace(done: tuple[RunResult, Path], tmp_path: Path) -> None:
    again, page = rebuild(done[1], tmp_path / "again.html")
    assert isinstance(again, RunResult)
    assert again.traces == done[0].traces
    assert again.conclusions == done[0].conclusions
    assert page.stat().st_size > 100_000


def test_a_case_is_made_again_from_what_is_written_of_it(done: tuple[RunResult, Path]) -> None:
    assert case_of_json(done[0].scenario).describe() == done[0].scenario


def test_it_lasts_until_it_rests_or_ten_periods(done: tuple[RunResult, Path], tmp_path: Path) -> None:
    rest = done[0].traces[0].metrics.stick_time_s
    assert rest is not None
    assert 1.2 * rest <= done[0].scenario["duration_s"] <= 1.3 * rest
    endless = Model(1.0, 0.1, 100.0, 0.0, x0=1.0)
    assert scenario_of(file_of(endless, tmp_path), None).duration == pytest.approx(6.3)
    assert scenario_of(file_of(endless, tmp_path), 0.5).duration == 0.5


def test_a_free_axis_needs_a_duration(tmp_path: Path) -> None:
    free = file_of(Model(1.0, 1.0, 0.0, 3.0, restoring=Restoring.NONE, v0=1.0), tmp_path)
    with pytest.raises(InputError, match="a free axis, without a period; --duration is needed with it"):
        scenario_of(free, None)
    result = run(RunOptions(scenario_of(free, 0.5), presets=("tuned",)), tmp_path / "out")
    assert not [trace.error for trace in result.traces if trace.error]
    assert all((trace.metrics.max_error_m or 0.0) < 1e-3 for trace in result.traces)
