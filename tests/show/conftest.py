"""Fixtures of example data; what they are made of is in show_examples."""

from pathlib import Path

import numpy as np
import pytest
from show_examples import MACHINE, SCENARIO, estimate, make_run_result, make_sources, quantity

from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.results.identify import IdentifyResult
from harness.results.run import RunResult


@pytest.fixture(scope="session")
def sources() -> list[Trajectory]:
    return make_sources()


@pytest.fixture(scope="session")
def run_result(sources: list[Trajectory]) -> RunResult:
    return make_run_result(sources)


@pytest.fixture(scope="session")
def recording(sources: list[Trajectory]) -> Recording:
    reference = sources[0]
    noise = np.random.default_rng(3)
    channels = {
        "x": reference.x + 1e-4 * noise.normal(size=len(reference)),
        "a": reference.a + 0.3 * noise.normal(size=len(reference)),
    }
    return Recording(reference.t, channels, "bench.csv", "ab" * 32, {"x": "mm"}, notes=("2 gaps are skipped.",))


@pytest.fixture(scope="session")
def identify_result(sources: list[Trajectory]) -> IdentifyResult:
    per_reversal = [
        {"t": float(t), "X": 0.5, "a_before": 1.0, "a_after": 7.0, "x_k": 0.03 + 1e-5 * i, "stderr": 2e-5, "zeta": 0.05}
        for i, t in enumerate(sources[0].events.t[:-1])
    ]
    return IdentifyResult.model_validate(
        {
            "schema": "harness.identify/1",
            "recording": {
                "file": "/data/bench.csv",
                "sha256": "ab" * 32,
                "samples": 3001,
                "channels": ["x", "a"],
                "rate_hz": 1000.0,
                "duration_s": 3.0,
                "noise": {"x": 1e-4, "a": 0.3},
                "notes": ["2 gaps are skipped."],
            },
            "estimates": {"acceleration": estimate(0.03, per_reversal), "displacement": estimate(0.0301, [])},
            "sensor_phase_rad": quantity(0.216, 0.003, "rad"),
            "warnings": [],
            "machine": MACHINE,
            "files": {},
        }
    )


@pytest.fixture(scope="session")
def urdf() -> Path:
    return Path(__file__).parents[2] / "models" / "slider.urdf"


@pytest.fixture(scope="session")
def trace_file(
    tmp_path_factory: pytest.TempPathFactory, sources: list[Trajectory], run_result: RunResult, urdf: Path
) -> Path:
    from harness.show.report.motion import run_scene
    from harness.show.trace import write_trace

    path = tmp_path_factory.mktemp("trace") / "trace.rrd"
    write_trace(path, run_scene(sources, SCENARIO, run_result, "# Notes\n\nThe grey curve is exact.", urdf))
    return path
