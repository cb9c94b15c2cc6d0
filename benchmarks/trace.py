"""Traces of four sources with a million samples each. ``python -m benchmarks.trace`` prints seconds and megabytes."""

import statistics
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks.registry import Pair, benchmark
from harness.core.arrays import FloatArray
from harness.core.events import Events
from harness.core.scenario import FREE_DECAY
from harness.core.trajectory import Source, Trajectory
from harness.exact.decay import free_decay
from harness.show.report.motion import run_scene
from harness.show.stored import read_trace
from harness.show.trace import write_trace

SAMPLES = 1_000_000


def _sources() -> list[Trajectory]:
    """The exact decay, and three that differ from it as engines do: own rounding, own time stamps."""
    found = []
    for i, name in enumerate(("reference", "mujoco", "pybullet", "dart")):
        t: FloatArray = np.arange(SAMPLES, dtype=np.float64) * (3.0 / SAMPLES * (1.0 + 0.01 * i))
        exact = free_decay(FREE_DECAY, t)
        scale = 1.0 + 1e-3 * i
        source = exact.source if i == 0 else Source(name, "tuned", "1", 3.0 / SAMPLES)
        events = exact.events if i == 0 else Events()
        found.append(
            Trajectory(t, exact.x * scale, exact.v * scale, exact.a * scale, source, mode=exact.mode, events=events)
        )
    return found


def _write(path: Path, sources: list[Trajectory]) -> None:
    write_trace(path, run_scene(sources, {"name": "free-decay"}, {}, "A benchmark."))


def _plain(path: Path, sources: list[Trajectory]) -> None:
    """The least that could be done: the four positions as they are, one call each block, nothing else stored."""
    import rerun as rr

    recording = rr.RecordingStream("benchmark", send_properties=False)
    recording.save(path)
    for i, source in enumerate(sources):
        stamps = np.rint(source.t * 1e9).astype("timedelta64[ns]")
        for start in range(0, SAMPLES, 65_536):
            block = slice(start, start + 65_536)
            columns = rr.Scalars.columns(scalars=source.x[block])
            recording.send_columns(f"/position/{i}", [rr.TimeColumn("time", duration=stamps[block])], columns)
    recording.flush()
    recording.disconnect()


@benchmark(
    "trace of 4 x 1e6 samples",
    peer="send_columns of the four positions alone, one entity each, nothing else stored",
    timed="write_trace: t, x, v, a and mode of all four bit for bit, curves, blueprint; file on disk",
    target=2.1,  # 1 s where the peer takes 0.47 s
)
def trace_of_four() -> Pair:
    folder = Path(tempfile.mkdtemp(prefix="friction-harness-benchmark-"))
    sources = _sources()
    return Pair(lambda: _write(folder / "ours.rrd", sources), lambda: _plain(folder / "plain.rrd", sources), rounds=5)


def main() -> None:
    sources = _sources()
    with tempfile.TemporaryDirectory() as folder:
        seconds: dict[str, list[float]] = {"ours": [], "plain": []}
        for _ in range(5):
            for name, write in (("ours", _write), ("plain", _plain)):
                start = time.perf_counter()
                write(Path(folder) / f"{name}.rrd", sources)
                seconds[name].append(time.perf_counter() - start)
        for name, taken in seconds.items():
            size = (Path(folder) / f"{name}.rrd").stat().st_size / 1e6
            print(f"{name}: {statistics.median(taken):.3f} s, {size:.1f} MB, 4 x {SAMPLES} samples")
        start = time.perf_counter()
        back = read_trace(Path(folder) / "ours.rrd").trajectories
        print(f"read back: {time.perf_counter() - start:.3f} s")
        same = all(a.x.tobytes() == b.x.tobytes() for a, b in zip(sources, back, strict=True))
        print(f"bit for bit the same: {same}")


if __name__ == "__main__":
    main()
