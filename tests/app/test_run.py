"""The main job and a model from a file: what is found in every source, and what is left."""

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from harness.app.report import rebuild
from harness.app.run.case import ModelScenario, case_of_json
from harness.app.run.run import RunOptions, run
from harness.core.errors import InputError, SimulationError
from harness.core.scenario import FREE_DECAY
from harness.core.trajectory import Trajectory
from harness.engines.base import Task
from harness.engines.mujoco import MujocoEngine
from harness.exact.decay import free_decay
from harness.fidelity.kind import kind, kinds
from harness.model import document
from harness.model.model import Model, ModelTerm, Restoring
from harness.results import generate
from harness.results.run import RunResult, TraceResult
from harness.show.stored import read_trace

Done = tuple[RunResult, Path]
X_K, ZETA = 0.03, 0.05
SOURCES = ["reference exact", "mujoco as-shipped", "mujoco tuned", "pybullet as-shipped", "pybullet tuned"]


def trace(done: Done, label: str) -> TraceResult:
    return next(t for t in done[0].traces if f"{t.source} {t.preset}" == label)


def x_k(found: TraceResult, method: str) -> float:
    value = found.estimates[method].x_k.value
    assert value is not None
    return value


@pytest.mark.usefixtures("pybullet")
def test_every_source_is_there_in_order(done: Done) -> None:
    assert [f"{t.source} {t.preset}" for t in done[0].traces] == SOURCES
    assert not [t.error for t in done[0].traces if t.error]


def test_the_reference_gives_back_what_was_put_in(done: Done) -> None:
    found = trace(done, "reference exact")
    estimate = found.estimates["acceleration"]
    assert estimate.x_k.value == pytest.approx(X_K, rel=1e-6)
    assert estimate.zeta.value == pytest.approx(ZETA, rel=1e-6)
    assert estimate.omega_n.value == pytest.approx(10.0, rel=1e-6)
    assert found.metrics.stick_time_s == pytest.approx(2.51642, abs=5e-6)
    assert found.metrics.half_cycles == 8
    assert found.metrics.max_error_m == 0.0


def test_as_shipped_mujoco_smears_the_jump_that_the_guard_leaves_out(done: Done) -> None:
    found = trace(done, "mujoco as-shipped")
    assert abs(x_k(found, "acceleration-local")) < 0.5 * X_K
    assert x_k(found, "acceleration") == pytest.approx(X_K, rel=0.02)
    assert found.metrics.stick_time_s is None
    assert found.metrics.creep_m_s is not None
    assert found.metrics.creep_m_s < -1e-3
    assert found.dt_s == 0.002
    assert found.settings["integrator"] == "Euler"


@pytest.mark.parametrize("label", ["mujoco tuned", "pybullet tuned"])
def test_tuned_engines_give_what_was_put_in_both_ways(done: Done, label: str) -> None:
    found = trace(done, label)
    for method in ("acceleration", "acceleration-local"):
        assert x_k(found, method) == pytest.approx(X_K, rel=0.01)
    assert found.estimates["acceleration"].zeta.value == pytest.approx(ZETA, rel=0.01)
    assert found.metrics.stick_time_s == pytest.approx(2.5164, abs=0.01)
    assert found.metrics.max_error_m is not None
    assert found.metrics.max_error_m < 1e-3


def test_a_sentence_says_why_as_shipped_mujoco_reads_too_little(done: Done) -> None:
    (sentence,) = [s for s in done[0].conclusions if s.startswith("mujoco as-shipped: friction is regularised")]
    assert "30.1 mm away from it (true: 30 mm)" in sentence
    assert "11 ms before the velocity reversal" in sentence


def test_what_is_left_is_whole_and_valid(done: Done) -> None:
    result, folder = done
    assert {file.name for file in folder.iterdir()} == {"result.json", "trace.rrd", "report.html", "log.txt", "model"}
    assert all(Path(file).is_file() and Path(file).is_absolute() for file in result.files.values())
    data = json.loads((folder / "result.json").read_text())
    assert data == json.loads(result.model_dump_json(by_alias=True))
    jsonschema.validate(data, json.loads((generate.FOLDER / "harness.run-1.json").read_text()))
    assert data["schema"] == "harness.run/1"
    assert data["machine"]["packages"]["mujoco"] == "4.0.0"
    assert "http://" not in (folder / "report.html").read_text().split("<script", maxsplit=1)[0]
    assert not list(folder.parent.glob(".*"))


def test_the_trace_alone_gives_the_page_and_every_figure_bit_for_bit(done: Done, tmp_path: Path) -> None:
    result, folder = done
    alone = tmp_path / "alone.rrd"
    alone.write_bytes((folder / "trace.rrd").read_bytes())
    again, page = rebuild(alone)
    assert again == result
    assert page.read_bytes() == (folder / "report.html").read_bytes()


def test_stored_samples_are_those_of_the_engine(done: Done) -> None:
    stored = read_trace(done[1] / "trace.rrd").trajectories
    direct = MujocoEngine().simulate(Task(FREE_DECAY, preset="tuned"))
    for name in ("t", "x", "v", "a"):
        np.testing.assert_array_equal(getattr(stored[2], name), getattr(direct, name))


def test_an_engine_that_fails_leaves_its_reason_and_the_others_go_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(self: MujocoEngine, task: Task) -> Trajectory:
        if task.preset == "tuned":
            raise SimulationError("mujoco: it diverged at t = 0.3 s")
        return free_decay(task.scenario, np.linspace(0.0, 3.0, 301))

    monkeypatch.setattr(MujocoEngine, "simulate", fail)
    result = run(RunOptions(engines=("mujoco",)), tmp_path / "out")
    assert [t.error for t in result.traces] == [None, None, "mujoco: it diverged at t = 0.3 s"]
    assert "mujoco tuned could not be run: mujoco: it diverged at t = 0.3 s" in result.conclusions
    again, _ = rebuild(tmp_path / "out")
    assert again == result


@pytest.mark.usefixtures("pybullet")
def test_options_choose_what_is_run() -> None:
    assert RunOptions().plan == [
        ("mujoco", "as-shipped"),
        ("mujoco", "tuned"),
        ("pybullet", "as-shipped"),
        ("pybullet", "tuned"),
    ]
    options = RunOptions(engines=("mujoco", "mujoco"), presets=("tuned",), dt=5e-4)
    assert options.plan == [("mujoco", "tuned")]
    assert options.interval == 5e-4


@pytest.mark.parametrize(
    "given", [{"f_k": 0.0}, {"c": 0.0}, {"x0": 0.02}, {"c": 30.0}, {"f_s": 4.0}, {"x0": -0.5, "v0": 2.0}]
)
def test_any_slider_gets_a_result(tmp_path: Path, given: dict[str, float]) -> None:
    options = RunOptions.asked("free-decay", given=given, preset="tuned", dt=2e-3)
    result = run(options, tmp_path / "out")
    assert not [t.error for t in result.traces if t.error]
    for found in result.traces:
        for estimate in found.estimates.values():
            assert all(p.value is not None or p.why for p in (estimate.omega_n, estimate.zeta, estimate.x_k))


OTHERS = ("hold-slid", "pinch", "rolling")
"""One of each kind that is not of the suite."""


@pytest.mark.parametrize(
    "name", [name for name, one in kinds().items() if name in OTHERS or (one.part == "suite" and name != "free-decay")]
)
def test_every_scenario_of_the_suite_is_run_with_the_figures_it_is_about(tmp_path: Path, name: str) -> None:
    result = run(RunOptions.asked(name, engines=["mujoco"], preset="tuned"), tmp_path / "out")
    reference, tuned = (found.metrics.model_dump() for found in result.traces)
    case = kind(name)
    scenario = case.chosen({})
    for metric, truth in case.answers(scenario).items():
        if metric in reference:
            # whole samples of 1 ms, and of events that are counted in them
            assert reference[metric] == pytest.approx(truth, rel=2e-3, abs=1e-3), metric
            assert tuned[metric] is not None, metric
    assert bool(result.traces[1].estimates) == (scenario.action is None)
    again, _ = rebuild(tmp_path / "out")
    assert again == result
    page = (tmp_path / "out" / "report.html").read_text()
    assert f"<p>{name.replace('-', ' ')}" in page


def test_rebuilding_needs_a_trace_of_ours(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no trace[.]rrd in it"):
        rebuild(tmp_path)
    with pytest.raises(InputError, match="no such file"):
        rebuild(tmp_path / "gone.rrd")
    (tmp_path / "x.csv").write_text("t,x")
    with pytest.raises(InputError, match=r"a [.]csv file[.] Try: harness log"):
        rebuild(tmp_path / "x.csv")


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
def modelled(tmp_path_factory: pytest.TempPathFactory) -> tuple[RunResult, Path]:
    folder = tmp_path_factory.mktemp("model")
    scenario = scenario_of(file_of(MODEL, folder), None)
    return run(RunOptions(scenario, presets=("tuned",)), folder / "out"), folder / "out"


@pytest.mark.usefixtures("pybullet")
def test_engines_move_as_the_reference(modelled: tuple[RunResult, Path]) -> None:
    reference, *engines = modelled[0].traces
    assert (reference.source, reference.metrics.max_error_m) == ("reference", 0.0)
    assert [trace.source for trace in engines] == ["mujoco", "pybullet"]
    assert reference.metrics.stick_time_s is not None
    for trace in engines:
        assert trace.error is None
        assert trace.metrics.max_error_m is not None
        assert trace.metrics.max_error_m < 2e-3
        assert trace.metrics.half_cycles == reference.metrics.half_cycles
        assert trace.metrics.stick_time_s == pytest.approx(reference.metrics.stick_time_s, abs=0.02)


def test_what_acts_and_what_is_left_out_is_said(modelled: tuple[RunResult, Path]) -> None:
    result, folder = modelled
    assert any(line.startswith("stribeck: ") for line in result.conclusions)
    assert any("sensor-gain change what a sensor makes of it" in line for line in result.conclusions)
    left_out = (folder / "model" / "not_said.txt").read_text(encoding="utf-8")
    assert "xml: no stribeck (f_s = 5, v_s = 0.5)" in left_out
    assert document.load(folder / "model" / "model.json") == MODEL


def test_the_page_is_made_again_from_the_trace(modelled: tuple[RunResult, Path], tmp_path: Path) -> None:
    again, page = rebuild(modelled[1], tmp_path / "again.html")
    assert isinstance(again, RunResult)
    assert again.traces == modelled[0].traces
    assert again.conclusions == modelled[0].conclusions
    assert page.stat().st_size > 100_000


def test_a_case_is_made_again_from_what_is_written_of_it(modelled: tuple[RunResult, Path]) -> None:
    assert case_of_json(modelled[0].scenario).describe() == modelled[0].scenario


def test_it_lasts_until_it_rests_or_ten_periods(modelled: tuple[RunResult, Path], tmp_path: Path) -> None:
    rest = modelled[0].traces[0].metrics.stick_time_s
    assert rest is not None
    assert 1.2 * rest <= modelled[0].scenario["duration_s"] <= 1.3 * rest
    endless = Model(1.0, 0.1, 100.0, 0.0, x0=1.0)
    assert scenario_of(file_of(endless, tmp_path), None).duration == pytest.approx(6.3)
    assert scenario_of(file_of(endless, tmp_path), 0.5).duration == 0.5


def test_a_free_axis_needs_a_duration(tmp_path: Path) -> None:
    free = file_of(Model(1.0, 1.0, 0.0, 3.0, restoring=Restoring.NONE, v0=1.0), tmp_path)
    with pytest.raises(InputError, match="a free axis, without a period; expected --duration with it"):
        scenario_of(free, None)
    result = run(RunOptions(scenario_of(free, 0.5), presets=("tuned",)), tmp_path / "out")
    assert not [trace.error for trace in result.traces if trace.error]
    assert all((trace.metrics.max_error_m or 0.0) < 1e-3 for trace in result.traces)
