"""Several traces laid over each other: in the same plots, a shared reference once, and what does not go together."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from rerun.chunk import RrdReader

import harness
from harness.app.report.view import overlay
from harness.cli.commands.view import command
from harness.core.errors import InputError
from harness.show import scene as s
from harness.show.blocks import Figure
from harness.show.numbers import REFERENCE
from harness.show.overlay_scene import named, overlay_scene
from harness.show.stored import read_trace


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


BAD = [
    (("coarse",), "1 traces; 2 to 10 are accepted"),
    (("coarse", "coarse"), "given twice"),
    (("coarse", "nowhere"), "no such file"),
    (("coarse", "swing"), "coarse slides, swing turns; traces of one kind of motion"),
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
