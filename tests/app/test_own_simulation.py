"""A user's own simulation in MuJoCo beside a recording: what its engine does is told from what its parameters do."""

import math
import shlex
from pathlib import Path

import mujoco
import numpy as np
import pytest

import harness
from harness.app.run.case import case_of
from harness.app.run.run import RunOptions
from harness.cli.main import run
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.slider import Slider
from harness.engines.model_files import export
from harness.exact.decay import Decay, free_decay
from harness.model.model import Model, ModelTerm
from harness.results.diagnosis import AttributionResult, DiagnosisResult
from harness.robot.own_model import own_model

M, C, K, F = 1.2, 0.9, 180.0, 0.12
X0 = 0.05
XML = """<mujoco><option timestep="0.002" gravity="0 0 0" integrator="{integrator}"/><worldbody><body>
<joint type="slide" axis="1 0 0" stiffness="{k}" damping="{c}" frictionloss="{f}"/>
<geom type="box" size=".05 .05 .05" mass="1.2"/></body></worldbody></mujoco>"""


def simulated(c: float = C, k: float = K, f: float = F, integrator: str = "Euler") -> FloatArray:
    """Rows of time, qpos, qvel, qacc over 5 s; friction as MuJoCo ships it."""
    model = mujoco.MjModel.from_xml_string(XML.format(c=c, k=k, f=f, integrator=integrator))
    data, rows = mujoco.MjData(model), []
    data.qpos[0] = X0
    for _ in range(2500):
        mujoco.mj_forward(model, data)
        rows.append((data.time, data.qpos[0], data.qvel[0], data.qacc[0]))
        mujoco.mj_step(model, data)
    return np.array(rows)


@pytest.fixture(scope="module")
def recorded() -> Recording:
    t = np.arange(0.0, 5.0, 4e-3)
    x = free_decay(Decay.of(Slider(M, C, K, F), X0), t).x
    return Recording(t, {"x": x + 2e-5 * np.random.default_rng(3).normal(size=t.size)}, "rec.csv")


def shares(found: DiagnosisResult) -> AttributionResult:
    assert found.attribution is not None
    return found.attribution


def test_a_right_simulation_has_nothing_to_change_but_its_engine(recorded: Recording, tmp_path: Path) -> None:
    path = tmp_path / "sim.csv"
    np.savetxt(path, simulated(), "%.10g", ",", header="time,qpos,qvel,qacc", comments="")
    found = shares(harness.diagnose(recorded, sim=path, engines=()))
    assert found.changes == []
    assert found.reads is not None
    assert [found.reads[name].value for name in ("c", "k", "f_k")] == pytest.approx([C / M, K / M, F / M], rel=1e-5)
    assert found.engine is not None
    assert found.engine > 0.9
    assert found.paste is not None
    model = XML.format(c=C, k=K, f=F, integrator="Euler").replace("<joint", found.paste.removesuffix("/>"))
    mended = mujoco.MjModel.from_xml_string(model)
    assert mended.dof_solref[0, 1] < -100.0


def test_a_wrong_parameter_is_the_one_to_change(recorded: Recording) -> None:
    """Read from positions alone, beside the engine's soft friction and its steps."""
    rows = simulated(f=1.3 * F)
    found = shares(harness.diagnose(recorded, sim=Recording(rows[:, 0], {"x": rows[:, 1]}, "sim.csv"), engines=()))
    assert [change.name for change in found.changes] == ["f_k"]
    assert found.changes[0].before == pytest.approx(1.3 * F / M, rel=2e-3)


def test_positions_of_a_simulation_are_held_against_an_acceleration_alone() -> None:
    """As of a phone on the slider; what the simulation lacks is the derivative of what it has."""
    t = np.arange(0.0, 5.0, 4e-3)
    a = free_decay(Decay.of(Slider(M, C, K, F), X0), t).a
    recording = Recording(t, {"a": a + 1e-3 * np.std(a) * np.random.default_rng(3).normal(size=t.size)}, "phone.csv")
    rows = simulated(f=1.3 * F)
    found = shares(harness.diagnose(recording, sim=Recording(rows[:, 0], {"x": rows[:, 1]}, "sim.csv"), engines=()))
    assert [change.name for change in found.changes] == ["f_k"]
    assert found.changes[0].before == pytest.approx(1.3 * F / M, rel=1e-4)


def test_a_simulation_of_few_digits_has_no_acceleration() -> None:
    t = np.arange(0.0, 5.0, 4e-3)
    a = free_decay(Decay.of(Slider(M, C, K, F), X0), t).a
    rough = np.round(simulated()[:, 1], 3)
    sim = Recording(simulated()[:, 0], {"x": rough}, "sim.csv")
    with pytest.raises(InputError, match=r"sim.csv: channels x; expected one or more of a"):
        harness.diagnose(Recording(t, {"a": a}, "phone.csv"), sim=sim, engines=())


def written(folder: Path, text: str, name: str = "slider.xml") -> Path:
    path = folder / name
    path.write_text(text)
    return path


@pytest.mark.parametrize(("f", "names"), [(F, []), (1.3 * F, ["f_k"])])
def test_a_model_of_mujocos_own_is_run_in_mujoco(
    recorded: Recording, tmp_path: Path, f: float, names: list[str]
) -> None:
    """At the file's own step, with its own options."""
    path = written(tmp_path, XML.format(c=C, k=K, f=f, integrator="Euler"))
    found = shares(harness.diagnose(recorded, model=path, engines=()))
    assert [change.name for change in found.changes] == names
    assert found.engine is not None
    assert found.engine > 0.02
    assert "step 2 ms" in found.configuration
    assert found.paste is not None


def test_a_run_of_a_model_of_mujocos_own_is_what_mujoco_makes_of_it(tmp_path: Path) -> None:
    path = written(tmp_path, XML.format(c=C, k=K, f=F, integrator="implicitfast"))
    result = harness.run(model=path, x0=X0, engines=["mujoco"], preset="as-shipped", duration=1.0, out=tmp_path / "out")
    (own,) = (trace for trace in result.traces if trace.source == "mujoco")
    assert (own.dt_s, own.settings["integrator"]) == (0.002, "implicitfast")
    rows = simulated(integrator="implicitfast")[:500]
    exact = free_decay(Decay.of(Slider(M, C, K, F), X0), rows[:, 0]).x
    assert own.metrics.max_error_m == pytest.approx(np.max(np.abs(rows[:, 1] - exact)), rel=0.05)


ONE = """<mujoco><option timestep="0.002"/><worldbody><body><joint type="{type}" axis="{axis}" {words}/>
<geom size=".1" mass="1" pos="{pos}"/></body></worldbody></mujoco>"""
CURVED = 'stiffness="40 10 80" damping=".3 .2" frictionloss="1" springref=".1"'


@pytest.mark.parametrize(
    "text",
    [
        ONE.format(type="slide", axis="1 0 0", words='stiffness="40" damping=".3 .9" frictionloss="1"', pos="0 0 0"),
        ONE.format(type="slide", axis="0 0 1", words=CURVED, pos="0 0 0"),
        ONE.format(type="slide", axis="1 0 2", words='stiffness="40" damping=".3" springref=".1"', pos="0 0 0"),
        ONE.format(type="slide", axis="0 0 1", words='damping=".3 .2" frictionloss="1"', pos="0 0 0"),
        ONE.format(type="hinge", axis="0 1 0", words='damping=".03 .2" frictionloss=".1"', pos=".4 0 .1"),
        ONE.format(type="hinge", axis="0 0 1", words='stiffness="4 0 9" damping=".03" springref="20"', pos=".4 0 .1"),
    ],
    ids=["drag", "curved under gravity", "slack elsewhere", "falls", "pendulum with drag", "rotor"],
)
def test_the_exact_motion_of_a_model_of_mujocos_own_is_what_its_small_steps_tend_to(tmp_path: Path, text: str) -> None:
    """Polynomials, gravity along the axis and a spring that is slack elsewhere: x is measured from where it rests."""
    path = written(tmp_path, text)
    case = case_of(RunOptions.asked(None, path, None, {"x0": 0.2, "duration": 1.0}).scenario)
    exact = case.exact(np.linspace(0.0, 1.0, 101))
    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.timestep, model.dof_solref[:], model.dof_solimp[:] = 1e-4, [-1.0, -9000.0], [0.9999, 0.9999, 1e-3, 0.5, 2]
    data, x = mujoco.MjData(model), []
    data.qpos[0] = 0.2 + own_model(path).rest
    for _ in range(101):
        x.append(data.qpos[0])
        mujoco.mj_step(model, data, 100)
    assert np.array(x) - x[0] == pytest.approx(exact.x - exact.x[0], abs=2e-4)


@pytest.mark.parametrize(
    "term",
    [
        ModelTerm.named("quadratic-drag", c2=0.9),
        ModelTerm.named("quadratic-stiffness", k2=20.0),
        ModelTerm.named("cubic-stiffness", k3=80.0),
        ModelTerm.named("constant-force", force=3.0),
        ModelTerm.named("end-stop", gap=0.2, k_stop=900.0),
        ModelTerm.named("end-stop:positive", gap=0.2, k_stop=900.0),
        ModelTerm.named("end-stop:negative", gap=0.1, k_stop=900.0),
        ModelTerm.named("backlash", gap=0.05),
    ],
    ids=lambda one: one.term.key,
)
def test_an_exported_model_runs_as_the_model_itself(tmp_path: Path, term: ModelTerm) -> None:
    model = Model(1.0, 0.3, 40.0, 1.0, x0=0.3, terms=(term,))
    export(model, tmp_path)
    t = np.linspace(0.0, 2.0, 201)
    itself = case_of(RunOptions.asked(None, model, None, {"duration": 2.0}).scenario).exact(t).x
    rest = own_model(tmp_path / "slider.xml").rest
    given = {"x0": 0.3 - rest, "duration": 2.0}
    again = case_of(RunOptions.asked(None, tmp_path / "slider.xml", None, given).scenario).exact(t).x
    assert rest == pytest.approx(3.0 / 40.0 if term.term.name == "constant-force" else 0.0)
    assert again + rest == pytest.approx(itself, abs=1e-9)


@pytest.mark.parametrize("suffix", ["xml", "urdf"])
def test_a_model_that_does_not_say_where_it_begins_is_run_by_the_proposed_line(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], suffix: str
) -> None:
    export(Model(1.0, 0.3, 40.0, 1.0, x0=0.3, terms=(ModelTerm.named("backlash", gap=0.4),)), tmp_path)
    line = ["run", "--model", str(tmp_path / f"slider.{suffix}"), "--engine", "mujoco", "--preset", "tuned", "--quiet"]
    line += ["--out", str(tmp_path / "out")]
    assert run(line) == 2
    assert run(shlex.split(capfd.readouterr().err.partition("Try: harness ")[2])) == 0


@pytest.mark.parametrize(
    "term",
    [ModelTerm.named("end-stop:positive", gap=0.2, k_stop=900.0), ModelTerm.named("backlash", gap=0.05)],
    ids=lambda one: one.term.key,
)
@pytest.mark.usefixtures("pybullet")
def test_an_export_moves_in_both_engines_as_the_reference(tmp_path: Path, term: ModelTerm) -> None:
    """Tuned, within 2 mm of a motion of 300 mm over a second and a half; what acts is said with its units."""
    export(Model(1.0, 0.3, 40.0, 1.0, x0=0.3, terms=(term,)), tmp_path)
    file = tmp_path / "slider.xml"
    result = harness.run(model=file, x0=0.3, preset="tuned", duration=1.5, out=tmp_path / "out")
    errors = {trace.source: trace.metrics.max_error_m for trace in result.traces if trace.source != "reference"}
    assert set(errors) == {"mujoco", "pybullet"}
    assert all(error is not None and error < 2e-3 for error in errors.values())
    assert any(f"{term.values[0]:g} m" in one for one in result.conclusions)


@pytest.mark.parametrize(("x0", "said"), [(0.15, False), (0.5, True)])
def test_a_motion_past_the_end_of_a_joints_range_is_said(tmp_path: Path, x0: float, said: bool) -> None:
    text = ONE.format(type="slide", axis="1 0 0", words='stiffness="40" limited="true" range="-.2 .2"', pos="0 0 0")
    options = RunOptions.asked(None, written(tmp_path, text), None, {"x0": x0, "duration": 1.0})
    found = case_of(options.scenario).conclusions([])
    assert any("-0.2 to 0.2 m" in one and "are not simulated" in one for one in found) == said


TWO = XML.format(c=C, k=K, f=F, integrator="Euler").replace("</body>", '<body><joint/><geom size="1"/></body></body>')
HANGS = """<mujoco><worldbody><body><joint axis="0 1 0" stiffness="1"/><geom size=".1" pos="0 0 -1"/></body></worldbody>
</mujoco>"""


@pytest.mark.parametrize(
    ("text", "x0", "message"),
    [
        (TWO, 1.0, "2 joints"),
        (HANGS, 1.0, "spring beside gravity"),
        (ONE.format(type="slide", axis="1 0 0", words='damping="1 0 2"', pos="0 0 0"), 1.0, "cube of the speed"),
        (ONE.format(type="slide", axis="1 0 0", words='stiffness="-2"', pos="0 0 0"), 1.0, "to no place"),
        (XML.format(c=C, k=K, f=F, integrator="Euler"), None, "--x0"),
    ],
)
def test_a_model_that_is_no_slider_is_refused(tmp_path: Path, text: str, x0: float | None, message: str) -> None:
    with pytest.raises(InputError, match=message):
        harness.run(model=written(tmp_path, text), x0=x0)


def test_an_engine_that_a_trace_does_not_tell_has_no_share(recorded: Recording) -> None:
    """An exact motion: parameters and engine are one, and what is drawn adds up."""
    t = np.arange(0.0, 5.0, 1e-3)
    x = free_decay(Decay.of(Slider(M, 1.4 * C, K, F), X0), t).x
    found = shares(harness.diagnose(recorded, sim=Recording(t, {"x": x}, "sim.csv"), engines=()))
    assert found.engine is None
    assert found.why is not None
    assert [change.name for change in found.changes] == ["c"]
    assert math.isclose(sum(bar.share for bar in found.bars), 1.0)
