"""Traces: written, packed, read back, and accepted by the viewer."""

import io
import os
import re
import struct
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from rerun.chunk import RrdReader
from show_examples import SCENARIO, make_sources

from harness.core.errors import HarnessError, InputError, StoreError
from harness.core.events import Mode
from harness.core.recording import Recording
from harness.core.scenario import FREE_DECAY
from harness.core.trajectory import Source, Trajectory
from harness.exact.decay import free_decay
from harness.results.identify import IdentifyResult
from harness.results.run import RunResult
from harness.show import scene, screenshot
from harness.show.blocks import Figure
from harness.show.pack import pack, pack_recording, recording_of, unpack
from harness.show.plots import axes, curve, keep, position_at, position_error, reversal_times, thinned
from harness.show.report.identify import recording_scene
from harness.show.report.motion import run_scene
from harness.show.stored import poured, read_trace
from harness.show.trace import DRAWN, write_trace

RERUN = Path(sys.executable).with_name("rerun")


def bits(trajectory: Trajectory) -> dict[str, bytes]:
    return {name: getattr(trajectory, name).tobytes() for name in ("t", "x", "v", "a")}


def figures(drawing: scene.Scene) -> dict[str, Figure]:
    return {view.name: view for view in drawing.views if isinstance(view, Figure)}


def test_trajectories_and_properties_come_back(
    trace_file: Path, sources: list[Trajectory], run_result: RunResult
) -> None:
    stored = read_trace(trace_file)
    assert [bits(one) for one in stored.trajectories] == [bits(one) for one in sources]
    assert [one.source for one in stored.trajectories] == [one.source for one in sources]
    assert stored.properties["result"] == run_result.model_dump(mode="json", by_alias=True)
    assert stored.properties["scenario"] == SCENARIO
    assert stored.recordings == []


def test_the_viewer_s_tool_verifies_one_file(trace_file: Path) -> None:
    done = subprocess.run([RERUN, "rrd", "verify", trace_file], capture_output=True, text=True, check=False)
    assert done.returncode == 0
    # a file without content passes as "0 files verified"
    assert re.search(r"\b1 file verified without error", done.stdout + done.stderr)


def test_drawn_curves_are_the_samples_at_rounded_nanoseconds(trace_file: Path, sources: list[Trajectory]) -> None:
    from rerun.chunk import RrdReader

    stream = RrdReader(trace_file).stream()
    found_t, found_x = [], []
    for chunk in stream.filter(content="/position/00", components="Scalars:scalars", is_static=False):
        batch = chunk.to_record_batch()
        found_t.append(batch.column("time").to_numpy(zero_copy_only=False).astype(np.int64))
        found_x.append(batch.column("Scalars:scalars").flatten().to_numpy(zero_copy_only=False))
    order = np.argsort(np.concatenate(found_t))
    assert np.concatenate(found_x)[order].tobytes() == (1e3 * sources[0].x).tobytes()
    assert np.array_equal(np.concatenate(found_t)[order], np.rint(sources[0].t * 1e9).astype(np.int64))


def test_long_traces_are_drawn_thin_and_stored_whole(tmp_path: Path) -> None:
    sources = make_sources(200_001)
    drawing = run_scene(sources, SCENARIO, {}, "")
    line, *_ = thinned(figures(drawing)["position"], DRAWN)
    assert line["x"].size <= DRAWN
    jump = int(np.searchsorted(sources[0].t, sources[0].events.t[0]))
    assert np.isin(sources[0].t[jump - 50 : jump + 50], line["x"]).all()
    write_trace(tmp_path / "long.rrd", drawing)
    assert [bits(one) for one in read_trace(tmp_path / "long.rrd").trajectories] == [bits(one) for one in sources]


def test_every_reversal_is_marked_with_its_jump(sources: list[Trajectory]) -> None:
    drawing = run_scene(sources, SCENARIO, {}, "")
    log = next(view for view in drawing.views if isinstance(view, scene.Events))
    before, after = figures(drawing)["acceleration"].traces[-1]["y"].reshape(-1, 2).T
    jumps = after - before
    # f_k / m on either side of zero: 2 x 3 N / 1 kg at each of the seven reversals, and less where it sticks
    assert np.allclose(np.abs(jumps[:7]), 6.0, rtol=1e-12)
    assert len(log.texts) == len(sources[0].events) == 8
    assert "sticks at x = 10.511 mm" in log.texts[-1]


def test_the_drawn_motion_of_a_small_slider_is_magnified(sources: list[Trajectory], urdf: Path) -> None:
    small = Trajectory(sources[0].t, sources[0].x * 1e-3, sources[0].v, sources[0].a, sources[0].source)
    space = next(v for v in run_scene([small], SCENARIO, {}, "", urdf).views if isinstance(v, scene.Space))
    assert isinstance(space.bodies[0], scene.Body)
    assert space.bodies[0].values[0] == pytest.approx(1.0)


@pytest.mark.parametrize(("speed", "said"), [(0.0, "stick"), (1e-3, "creep")])
def test_a_slider_that_rests_can_be_shown_and_one_that_creeps_is_told(
    tmp_path: Path, urdf: Path, speed: float, said: str
) -> None:
    t = np.linspace(0.0, 1.0, 101)
    held = Trajectory(t, np.zeros(101), np.zeros(101), np.zeros(101), Source("reference", "exact"))
    held_back = np.full(101, int(Mode.STICK), dtype=np.int8)
    source = Source("mujoco", "as-shipped")
    creeping = Trajectory(t, speed * t, np.full(101, speed), np.zeros(101), source, mode=held_back)
    drawing = run_scene([held, creeping], {"name": "hold-50"}, {}, "", urdf)
    (lanes,) = (view for view in drawing.views if isinstance(view, scene.Lanes))
    assert [lane.states for lane in lanes.lanes] == [[said]]
    write_trace(tmp_path / "hold.rrd", drawing)
    assert len(read_trace(tmp_path / "hold.rrd").trajectories) == 2


def test_a_recording_comes_back(tmp_path: Path, recording: Recording, identify_result: IdentifyResult) -> None:
    path = tmp_path / "recording.rrd"
    write_trace(path, recording_scene(recording, identify_result))
    stored = read_trace(path)
    assert stored.trajectories == []
    assert stored.recordings[0]["a"].tobytes() == recording["a"].tobytes()
    assert stored.properties["result"] == identify_result.model_dump(mode="json", by_alias=True)


def _cut_short(path: Path, whole: Path) -> None:
    path.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])


def _foreign(path: Path) -> None:
    import rerun as rr

    stream = rr.RecordingStream("another-program")
    stream.save(path)
    stream.log("x", rr.TextDocument("hello"), static=True)
    stream.disconnect()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda path, whole: None, "no such file"),
        (lambda path, whole: path.write_text("t,x\n0,1\n"), "cannot be read"),
        (lambda path, whole: path.write_bytes(b""), "expected a whole"),
        (_cut_short, "expected a whole"),
        (lambda path, whole: _foreign(path), "holds no trajectory of this program"),
    ],
)
def test_what_is_no_trace_of_ours_is_refused(tmp_path: Path, trace_file: Path, make: Any, message: str) -> None:
    path = tmp_path / "given.rrd"
    make(path, trace_file)
    with pytest.raises(InputError, match=message) as caught:
        read_trace(path)
    assert str(path) in str(caught.value)


def test_a_folder_that_is_not_there_is_said_and_nothing_is_left(tmp_path: Path, sources: list[Trajectory]) -> None:
    with pytest.raises(StoreError, match="no such folder; expected an existing one"):
        write_trace(tmp_path / "missing" / "t.rrd", run_scene(sources, SCENARIO, {}, ""))
    with pytest.raises(HarnessError, match="cannot be read"):
        write_trace(tmp_path / "t.rrd", run_scene(sources, SCENARIO, {}, "", tmp_path / "no.urdf"))
    assert list(tmp_path.iterdir()) == []


def test_the_page_and_the_scene_do_not_load_the_viewer() -> None:
    code = (
        "import sys; import harness.show.report.motion, harness.show.report.scenes, harness.show.report.run, "
        "harness.show.report.identify, harness.show.report.page, harness.show.screenshot; "
        "sys.exit('rerun' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_trace_that_is_written_leaves_little_behind(tmp_path: Path) -> None:
    """A stream of the viewer's library keeps two threads when it is closed, and so does each blueprint."""
    one = scene.Scene("one", Figure("x", [curve("x", np.arange(3.0), np.ones(3), "ink")], axes("t", "x")), {"x": b"1"})
    write_trace(tmp_path / "first.rrd", one)
    before = psutil.Process().num_threads()
    for i in range(8):
        write_trace(tmp_path / f"{i}.rrd", one)
    assert psutil.Process().num_threads() - before <= 2 * 8


finite = st.floats(allow_nan=False, allow_infinity=False)


@given(st.lists(finite, min_size=1, max_size=60))
def test_any_doubles_come_back_bit_for_bit(values: list[float]) -> None:
    column = np.array(values)
    back, about = unpack(pack({"c": column}, {"k": 1}))
    assert back["c"].tobytes() == column.tobytes()
    assert about == {"k": 1}


def test_a_smooth_motion_takes_little_room(sources: list[Trajectory]) -> None:
    t = np.arange(100_000) * 3e-6
    smooth = {"t": t, "x": np.exp(-0.5 * t) * np.cos(10.0 * t)}
    assert len(pack(smooth, {})) < 0.2 * sum(column.nbytes for column in smooth.values())


def motion(t: np.ndarray) -> Trajectory:
    return Trajectory(t, np.sin(3.0 * t), 3.0 * np.cos(3.0 * t), -9.0 * np.sin(3.0 * t), Source("made up"))


@pytest.mark.parametrize("n", [10_001, 54_321, 100_000])
def test_spikes_ends_and_reversals_survive(n: int) -> None:
    t = np.linspace(0.0, 1.0, n)
    x = np.zeros(n)
    x[n // 3], x[n // 5] = 1.0, -1.0
    chosen = keep(t, [x], np.array([0.5]), 2000)
    assert chosen.size <= 2000
    assert np.all(np.diff(chosen) > 0)
    assert {0, n // 3, n // 5, n - 1} <= set(chosen.tolist())
    centre = int(np.searchsorted(t, 0.5))
    assert set(range(centre - 500, centre + 500)) <= set(chosen.tolist())


def test_reversals_without_events_lie_between_the_samples() -> None:
    t = np.linspace(0.0, 3.0, 4001)
    expected = (np.arange(3) + 0.5) * np.pi / 3.0
    assert np.allclose(reversal_times(motion(t))[:3], expected[expected < 3.0], atol=1e-6)


def test_interpolation_is_exact_at_samples_and_of_fourth_order_between() -> None:
    errors = []
    for n in (101, 201, 401):
        reference = motion(np.linspace(0.0, 3.0, n))
        assert np.array_equal(position_at(reference, reference.t)[0], reference.x)
        between = 0.5 * (reference.t[1:] + reference.t[:-1])
        errors.append(np.max(np.abs(position_at(reference, between)[0] - np.sin(3.0 * between))))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.allclose(orders, 4.0, atol=0.1)


def test_no_error_is_claimed_where_the_reference_has_ended() -> None:
    reference = motion(np.linspace(0.0, 1.0, 101))
    longer = motion(np.linspace(0.0, 2.0, 201))
    error = position_error(longer.t, longer.x, reference)
    assert np.isnan(error[longer.t > 1.0]).all()
    assert np.max(np.abs(error[longer.t <= 1.0])) < 1e-7


PIECE = bytes(range(256)) * 4096


def write(name: str, pieces: int) -> None:
    """What a library does in a thread of its own."""
    with open(name, "wb", buffering=0) as pipe:
        for _ in range(pieces):
            pipe.write(PIECE)


def test_what_is_written_arrives(tmp_path: Path) -> None:
    with poured(tmp_path / "a") as pipe:
        thread = threading.Thread(target=write, args=(pipe.name, 5))
        thread.start()
        thread.join()
        pipe.opened()
    assert (tmp_path / "a").read_bytes() == 5 * PIECE


def test_a_full_disk_keeps_nobody_waiting_and_is_told() -> None:
    with pytest.raises(OSError, match="No space left"), poured(Path("/dev/full")) as pipe:
        write(pipe.name, 5)


def test_an_error_of_the_writer_passes_and_leaves_no_descriptor(tmp_path: Path) -> None:
    before = len(os.listdir("/dev/fd"))
    with pytest.raises(ValueError, match="a bug"), poured(tmp_path / "a"):
        raise ValueError("a bug")
    assert len(os.listdir("/dev/fd")) == before


@pytest.mark.parametrize("room", [30_000, 60_000, 90_000])
def test_a_trace_on_a_full_disk_ends_with_one_line(tmp_path: Path, room: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A disk that is full after so many bytes, wherever in the file that is."""

    class Disk:
        left = room

        def write(self, data: memoryview) -> int:
            if not Disk.left:
                raise OSError(28, "No space left on device")
            taken = min(Disk.left, len(data))
            Disk.left -= taken
            return taken

    from harness.show import stored

    whole = stored.Pipe
    monkeypatch.setattr(stored, "Pipe", lambda file: whole(Disk()))  # type: ignore[arg-type]
    scene = run_scene([free_decay(FREE_DECAY, np.linspace(0.0, 3.0, 20_001))], {"name": "free-decay"}, {}, "A test.")
    with pytest.raises(StoreError, match=r"t\.rrd: no space left on the device") as caught:
        write_trace(tmp_path / "t.rrd", scene)
    assert Disk.left == 0
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_every_slider_is_where_its_view_looks(trace_file: Path) -> None:
    shapes = {"Boxes3D:half_sizes", "Cylinders3D:lengths"}
    chunks = RrdReader(trace_file).stream()
    drawn = {one.entity_path for one in chunks if shapes.intersection(one.to_record_batch().schema.names)}
    assert len(drawn) > 10
    for path in drawn:  # not under one part with slashes of its own, which no view names
        assert re.match(r"/sliders-\d+-[\w-]+/", path), path


needs_driver = pytest.mark.skipif(screenshot.driver() is not None, reason=screenshot.driver() or "")


@needs_driver
@pytest.mark.slow
def test_no_view_of_a_run_reports_anything(trace_file: Path) -> None:
    shot = screenshot.take(trace_file, 1.2)
    assert shot.reports == {
        name: []
        for name in (
            "position / mm",
            "engine minus reference / mm",
            "acceleration / (m/s²)",
            "stick and slip",
            "sliders",
            "speed / (m/s) over position / mm",
            "notes",
            "parameters",
            "reversals",
        )
    }
    assert shot.png[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = struct.unpack(">II", shot.png[16:24])
    assert width >= 1280
    assert height >= 720
    seen = Image.open(io.BytesIO(shot.png)).convert("RGB").crop((width * 3 // 5, height // 15, width, height // 3))
    assert len(seen.getcolors(width * height) or ()) > 100  # the sliders, lit; an empty view has one colour


@pytest.mark.parametrize("arguments", [[], ["one.rrd"], ["a", "b", "c", "d"]])
def test_usage_is_one_line(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert screenshot.main(arguments) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_a_table_of_speeds_comes_back_as_one() -> None:
    speed = np.linspace(0.5, 6.0, 12)
    table = Recording(np.arange(12.0), {"v": speed, "u": 0.3 + 0.1 * speed}, "curve.csv", steady=True)
    columns, about = unpack(pack_recording(table))
    back = recording_of(columns, about)
    assert (back.steady, back.cut(speed > 1.0).steady, len(back)) == (True, True, 12)
