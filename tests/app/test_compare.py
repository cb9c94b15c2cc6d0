"""Traces of any origin: the same within noise or where they part; several laid over each other."""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from click.testing import CliRunner
from rerun.chunk import RrdReader

import harness
from harness.app.compare import again, compare
from harness.app.report import rebuild
from harness.app.view import overlay
from harness.cli.commands.view import command
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.slider import PAPER, Slider
from harness.exact.decay import Decay, free_decay
from harness.io.options import ReadOptions
from harness.kernels.solve import solve
from harness.model.model import Model, ModelTerm
from harness.results import generate
from harness.results.compare import CompareResult
from harness.results.run import RunResult
from harness.show import scene as s
from harness.show.blocks import Figure
from harness.show.numbers import REFERENCE
from harness.show.report.page import write_report
from harness.show.report.scenes import named, overlay_scene
from harness.show.stored import read_trace

AS_IT_IS = (ReadOptions(), ReadOptions())


def trace(
    path: Path,
    slider: Slider = PAPER,
    samples: int = 2400,
    noise: tuple[float, float] = (0.0, 0.0),
    shift: float = 0.0,
    scale: float = 1.0,
    seed: int = 1,
) -> Path:
    """x and a of the paper's case over 2.4 s; ``shift`` is that of the clock, ``scale`` multiplies a."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, 2.399, samples)
    exact = free_decay(Decay.of(slider, 1.0), t)
    x = exact.x + noise[0] * rng.normal(size=t.size)
    a = scale * (exact.a + noise[1] * rng.normal(size=t.size))
    np.savetxt(path, np.column_stack([t + shift, x, a]), "%.12g", ",", header="t,x,a", comments="")
    return path


GOOD = (1e-4, 1e-2)


def compared(sim: Path, real: Path, folder: Path) -> CompareResult:
    return compare(sim, real, AS_IT_IS, out=folder / "out")


@pytest.mark.parametrize(("samples", "shift"), [(2400, 0.0), (700, 0.0), (2400, 0.0132), (5000, -0.04)])
def test_a_motion_and_its_noisy_recording_are_the_same(tmp_path: Path, samples: int, shift: float) -> None:
    result = compared(
        trace(tmp_path / "sim.csv", samples=samples, shift=shift), trace(tmp_path / "real.csv", noise=GOOD), tmp_path
    )
    assert result.verdict == "same within noise"
    assert result.where == []
    found = result.aligned.shift_s
    assert found.value is not None
    assert found.stderr is not None
    assert abs(found.value + shift) < 4.0 * found.stderr
    assert result.noise["x"] == pytest.approx(1e-4, rel=0.1)


def test_three_per_cent_of_friction_make_a_difference(tmp_path: Path) -> None:
    sim = trace(tmp_path / "sim.csv", replace(PAPER, f_k=2.9, f_s=2.9))
    result = compared(sim, trace(tmp_path / "real.csv", noise=GOOD), tmp_path)
    assert result.verdict == "different"
    assert result.where
    assert result.rmse["x"] > 1e-3


def test_a_trace_against_itself(tmp_path: Path) -> None:
    real = trace(tmp_path / "real.csv", noise=GOOD)
    result = compared(real, real, tmp_path)
    assert result.verdict == "identical"
    assert result.rmse == {"x": 0.0, "a": 0.0}
    assert result.differences == []
    assert result.fit_percent == {"x": 100.0, "a": 100.0}
    assert [*result.traces] == ["sim", "real"]


RIG = Path(__file__).parents[2] / "docs" / "example" / "rig.csv"


def moved_clock(path: Path, by: float) -> Path:
    """The example's recording by another clock."""
    head, *rows = RIG.read_text().splitlines()
    moved = (f"{float(t) + by:.3f},{rest}" for t, rest in (row.split(",", 1) for row in rows))
    path.write_text("\n".join([head, *moved]) + "\n")
    return path


@pytest.mark.parametrize("by", [0.5, -3.0])
def test_a_recording_by_another_clock_is_identical(tmp_path: Path, by: float) -> None:
    result = compared(moved_clock(tmp_path / "late.csv", -by), RIG, tmp_path)
    assert result.verdict == "identical"
    assert result.aligned.shift_s.value == pytest.approx(by, abs=1e-9)
    assert [*result.traces] == ["late", "rig"]


def test_a_given_shift_is_taken_as_it_is(tmp_path: Path) -> None:
    late = moved_clock(tmp_path / "late.csv", 0.5)
    result = compare(late, RIG, AS_IT_IS, out=tmp_path / "out", shift=0.0)
    assert result.verdict == "different"
    assert result.aligned.shift_s.why == "given"
    # while the later one still waits, the other swings through to the far side and most of the way back
    assert abs(result.largest.value) == pytest.approx(0.07, abs=0.01)


def test_a_simulation_from_its_release_on_meets_a_recording_that_waits(tmp_path: Path) -> None:
    """Other damping, other stiffness: laid release on release, and said in words."""
    t = np.arange(0.0, 6.0, 2e-3)
    exact = free_decay(Decay.of(Slider(m=1.0, c=0.96, k=144.0, f_k=0.12, f_s=0.12), 0.040), t)
    np.savetxt(
        tmp_path / "mysim.csv", np.column_stack([t, exact.x, exact.a]), "%.12g", ",", header="t,x,a", comments=""
    )
    result = compared(tmp_path / "mysim.csv", RIG, tmp_path)
    shift = result.aligned.shift_s
    assert shift.value is not None
    assert shift.stderr is not None
    assert abs(shift.value - 0.5) < 3.0 * shift.stderr
    assert shift.stderr < 0.02
    zeta = next(one for one in result.differences if one.what == "zeta")
    assert zeta.first.value == pytest.approx(0.96 / (2.0 * 12.0), rel=1e-4)
    assert any(line.startswith("mysim has more dry friction: x_k 0.8333") for line in result.sentences)
    assert result.traces["mysim"].events[0].kind == "start"
    assert result.traces["rig"].events[0].kind == "release"
    assert result.traces["rig"].events[0].time_s == pytest.approx(0.5, abs=0.01)
    assert max(one.worse_by for one in result.aligned.alternatives) > 1.0


@pytest.mark.parametrize(("rate", "verdict"), [(1.0004, "same within noise"), (1.004, "different"), (0.8, "different")])
def test_a_rate_beyond_that_of_clocks_is_no_allowance(rate: float, verdict: str) -> None:
    """A clock that is slow and a spring that is stiff look alike: the worse reading decides, and both are told."""
    t = np.linspace(0.0, 2.4, 1200)
    x = free_decay(Decay.of(PAPER, 1.0), t).x
    real = Recording(t, {"x": x + 1e-4 * np.random.default_rng(1).normal(size=t.size)})
    result = harness.compare(Recording(rate * t, {"x": x}), real)
    scale = result.aligned.scale
    assert scale.value is not None
    assert scale.stderr is not None
    assert abs(scale.value - 1.0 / rate) < 4.0 * scale.stderr < 1e-3
    assert result.verdict == verdict
    assert result.aligned.scale_applied == (verdict == "same within noise")
    said = " ".join(result.sentences)
    assert ("stiffness" in said) == (verdict == "different")
    assert "clock" in said


def test_a_force_that_drives_both_proves_a_clock() -> None:
    """The same force and motion by a clock that is 0.5 % fast."""
    t, random = np.arange(0.0, 20.0, 0.01), np.random.default_rng(4)
    u = np.convolve(random.normal(size=t.size), np.hanning(40), "same")
    x = np.convolve(u, np.exp(-0.02 * np.arange(400)) * np.sin(0.1 * np.arange(400)))[: t.size]
    noisy = {"x": x + 1e-3 * np.std(x) * random.normal(size=t.size), "u": u + 1e-3 * random.normal(size=t.size)}
    result = harness.compare(Recording(1.005 * t, {"x": x, "u": u}), Recording(t, noisy))
    assert result.aligned.scale_applied
    assert result.aligned.scale.value == pytest.approx(1.0 / 1.005, abs=1e-4)
    assert result.verdict == "same within noise"


@pytest.mark.parametrize("schema", ["harness.compare/1", "harness.compare/2"])
def test_the_page_is_made_again_from_the_trace_alone(tmp_path: Path, schema: str) -> None:
    real = trace(tmp_path / "real.csv", noise=GOOD)
    result = compared(trace(tmp_path / "sim.csv", replace(PAPER, f_k=2.9, f_s=2.9)), real, tmp_path)
    trace_file = tmp_path / "out" / "trace.rrd"
    if schema == "harness.compare/1":
        stored = read_trace(trace_file)
        data = {k: v for k, v in stored.properties["result"].items() if k in KEPT}
        data |= {"schema": schema, "aligned": {"shift_s": data["aligned"]["shift_s"]}}
        page = tmp_path / "old.html"
        made, shown = again(stored, data)
        write_report(page, shown)
        assert made.traces == result.traces
    else:
        remade, page = rebuild(trace_file, tmp_path / "again.html")
        assert remade == result
    assert page.read_text() == (tmp_path / "out" / "report.html").read_text()


KEPT = {"schema", "files", "aligned", "noise", "rmse", "where", "verdict", "command", "machine", "outputs"}
"""Some of what harness.compare/1 held."""


def test_what_is_left_is_whole_and_valid(tmp_path: Path) -> None:
    sim = trace(tmp_path / "sim.csv", replace(PAPER, f_k=2.9, f_s=2.9))
    result = compared(sim, trace(tmp_path / "real.csv", noise=GOOD), tmp_path)
    folder = tmp_path / "out"
    assert {file.name for file in folder.iterdir()} == {"result.json", "trace.rrd", "report.html", "log.txt"}
    data = json.loads((folder / "result.json").read_text())
    jsonschema.validate(data, json.loads((generate.FOLDER / "harness.compare-2.json").read_text()))
    assert CompareResult.model_validate(data) == result
    page = (folder / "report.html").read_text()
    assert "has less dry friction" in page
    assert "at all times" not in page


def test_traces_of_a_run_are_compared_by_name(done: tuple[RunResult, Path], tmp_path: Path) -> None:
    _, folder = done
    rrd = folder / "trace.rrd"
    result = compare(rrd, rrd, AS_IT_IS, ("mujoco as-shipped", "reference exact"), tmp_path / "out")
    assert result.verdict == "different"


@pytest.mark.parametrize(
    ("scale", "start", "message"),
    [
        (1e-6, 1e3, "e+06 periods"),
        (1e-4, 0.0, "time alignment: traces that overlap nowhere; expected two traces of one motion"),
    ],
)
def test_traces_that_share_no_time_are_told_so(tmp_path: Path, scale: float, start: float, message: str) -> None:
    t = np.arange(400) / 200.0
    x = np.exp(-0.5 * t) * np.cos(10.0 * t)
    np.savetxt(tmp_path / "sim.csv", np.column_stack([t, x]), header="t,x", delimiter=",", comments="")
    np.savetxt(
        tmp_path / "real.csv",
        np.column_stack([scale * t + start, x]),
        header="t,x",
        delimiter=",",
        comments="",
        fmt="%.15g",
    )
    with pytest.raises(InputError, match=re.escape(message)):
        compared(tmp_path / "sim.csv", tmp_path / "real.csv", tmp_path / "out")


@pytest.mark.parametrize("seed", range(3))
def test_the_speed_of_a_slider_that_has_come_to_rest_tells_nothing_of_a_simulation(seed: int) -> None:
    t, dense = np.arange(0.0, 4.0, 0.01), np.arange(0.0, 4.0, 0.007)
    slider = Decay.of(Slider(1.0, 1.6, 300.0, 0.4), 0.05)
    random = np.random.default_rng(seed)
    moved, there = free_decay(slider, t), free_decay(slider, dense)
    noisy = {"x": moved.x + 2e-5 * random.standard_normal(t.size), "v": moved.v + 4e-4 * random.standard_normal(t.size)}
    found = harness.compare(Recording(dense, {"x": there.x, "v": there.v}), Recording(t, noisy))
    assert found.verdict == "same within noise"


def curves(scene: s.Scene) -> dict[str, Sequence[Mapping[str, Any]]]:
    return {view.name: view.traces for view in scene.views if isinstance(view, Figure)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two runs of one slider, and one of another."""
    place = tmp_path_factory.mktemp("overlay")
    for name, step in (("coarse", 4e-3), ("fine", 1e-3)):
        harness.run(engines=["mujoco"], preset="tuned", dt=step, duration=0.5, out=place / name)
    harness.run(f_k=2.0, engines=(), duration=0.5, out=place / "other")
    return place


def test_runs_share_their_plots_and_their_reference(folder: Path) -> None:
    traces = {name: read_trace(folder / name / "trace.rrd") for name in ("coarse", "fine", "other")}
    scene = overlay_scene(traces)
    lines = curves(scene)["x"]
    assert [line["name"] for line in lines] == [
        "fine: reference exact",
        "other: reference exact",
        "coarse: mujoco tuned",
        "fine: mujoco tuned",
    ]
    assert [line["line"]["color"] for line in lines[:2]] == [REFERENCE, REFERENCE]
    assert len({line["line"]["color"] for line in lines}) == 3
    exact = traces["fine"].trajectories[1]
    assert np.array_equal(lines[3]["y"], 1e3 * exact.x)
    assert np.array_equal(lines[3]["x"], exact.t)
    pages = [view.text for view in scene.views if isinstance(view, s.Words)]
    assert pages == [trace.properties["notes"]["text"] for trace in traces.values()]


def test_two_of_one_scenario_have_their_errors_against_its_reference(folder: Path) -> None:
    traces = {name: read_trace(folder / name / "trace.rrd") for name in ("coarse", "fine")}
    scene = overlay_scene(traces)
    lines = curves(scene)
    assert lines["x"][0]["name"] == "reference exact"
    for error, trace in zip(lines["error"], traces.values(), strict=True):
        reference, engine = trace.trajectories
        apart = 1e3 * (engine.x - np.interp(engine.t, reference.t, reference.x))
        # a straight line between samples of 1 or 4 ms bends by up to h^2 / 8 times 100 m/s^2
        assert error["y"] == pytest.approx(apart, abs=0.25)
    coarse, fine = (float(np.abs(error["y"]).max()) for error in lines["error"])
    assert coarse > 3.0 * fine
    assert lines["error"][0]["line"]["color"] != lines["error"][1]["line"]["color"]


def test_the_command_writes_one_file(folder: Path, tmp_path: Path) -> None:
    target = tmp_path / "both.rrd"
    places = [str(folder / "coarse"), str(folder / "fine" / "trace.rrd")]
    done = CliRunner().invoke(command, [*places, "--save", str(target)], standalone_mode=False)
    assert (done.return_value, done.output) == (0, f"trace: {target}\n")
    paths = {chunk.entity_path for chunk in RrdReader(target).stream()}
    assert {"/x/00", "/x/01", "/x/02", "/v/02", "/a/02", "/words/trace-rrd"} <= paths


def test_a_recording_lies_over_a_recording(folder: Path, tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    t = np.arange(0.0, 4.0, 5e-3)
    for name in ("monday", "tuesday"):
        x = 0.05 * np.exp(-0.4 * t) * np.cos(10.0 * t) + 1e-5 * rng.standard_normal(t.size)
        harness.identify(harness.Recording(t, {"x": x}, file=f"{name}.csv"), out=tmp_path / name)
    scene = overlay_scene({name: read_trace(tmp_path / name / "trace.rrd") for name in ("monday", "tuesday")})
    assert [line["name"] for line in curves(scene)["x"]] == ["monday: monday.csv", "tuesday: tuesday.csv"]


def test_a_law_in_both_at_two_amplitudes_is_said_to_show_as_friction_that_differs() -> None:
    """One slider with drag, let go from 80 and from 84 mm: its zeta and x_k are the same, the estimates are not."""
    t, drag = np.arange(0.0, 9.0, 4e-3), (ModelTerm.named("quadratic-drag", c2=1.5),)

    def swung(x0: float, seed: int) -> Recording:
        motion, rng = solve(Model(1.0, 0.25, 60.0, 0.35, x0=x0, terms=drag), t), np.random.default_rng(seed)
        channels = {"x": motion.x + rng.normal(0.0, 2e-5, t.size), "a": motion.a + rng.normal(0.0, 5e-3, t.size)}
        return Recording(t, channels, f"from-{1e3 * x0:.0f}-mm.csv")

    found = harness.compare(swung(0.08, 0), swung(0.084, 1))
    assert {"zeta", "x_k"} & {one.what for one in found.differences if (one.significance or 0.0) > 5.0}
    assert any("are those of viscous and dry friction alone" in one for one in found.sentences)


BAD = [
    (("coarse",), "1 traces; expected 2 to 10"),
    (("coarse", "coarse"), "given twice"),
    (("coarse", "nowhere"), "no such file"),
    (("coarse", "swing"), "coarse slides, swing turns; expected traces of one kind of motion"),
]


@pytest.mark.parametrize(("places", "message"), BAD)
def test_what_does_not_go_together(places: tuple[str, ...], message: str, folder: Path, tmp_path: Path) -> None:
    if "swing" in places and not (folder / "swing").exists():
        harness.run(restoring="pendulum", engines=(), duration=0.5, out=folder / "swing")
    with pytest.raises(InputError, match=message):
        overlay([folder / place for place in places], tmp_path / "out.rrd")
    assert not (tmp_path / "out.rrd").exists()


def test_names_are_short_where_they_can_be() -> None:
    assert named(["a/run", "b/tuned/"]) == ["run", "tuned"]
    assert named(["a/run", "b/run"]) == ["a/run", "b/run"]


@pytest.mark.parametrize(
    ("columns", "asked"),
    [
        ("x=x,a=0.101972*a", "x=x,a=0.101972*a[g]"),
        ("x=1000*x,a=a", "x=1000*x[mm],a=a"),
        ("x=x,a=-1*a", "x=x,a=-1*-1*a"),
        ("x=a,a=x", "x=x,a=a"),
    ],
)
def test_channels_of_another_unit_sign_or_name_are_refused_with_what_mends_them(
    tmp_path: Path, columns: str, asked: str
) -> None:
    one = trace(tmp_path / "one.csv", noise=(1e-4, 0.05))
    options = ReadOptions(columns=f"t=t,{columns}")
    with pytest.raises(InputError) as error:
        harness.diagnose(harness.load(one, columns=options.columns), out=tmp_path / "d")
    assert f"--columns t=t,{asked}" in error.value.accepted.replace("'", "")
    other = trace(tmp_path / "other.csv", noise=(1e-4, 0.05), seed=2)
    with pytest.raises(InputError) as error:
        compare(one, other, (options, ReadOptions()), out=tmp_path / "c")
    assert f"--sim-columns t=t,{asked}" in error.value.accepted.replace("'", "")
    mended = ReadOptions(columns=f"t=t,{asked}")
    found = compare(one, other, (mended, ReadOptions()), out=tmp_path / "m")
    assert found.verdict == "same within noise"


def test_a_position_in_another_unit_than_the_other_traces_is_refused(tmp_path: Path) -> None:
    one, other = (trace(tmp_path / f"{seed}.csv", noise=(1e-4, 0.05), seed=seed) for seed in (1, 2))
    alone, in_mm = ReadOptions(columns="t=t,x=x"), ReadOptions(columns="t=t,x=1000*x")
    with pytest.raises(InputError, match="goes 1000 times as far") as error:
        compare(one, other, (alone, in_mm), out=tmp_path / "c")
    assert "--columns 't=t,x=1000*x[mm]'" in error.value.accepted
