"""Example data: the exact decay, and made-up engines that differ from it in known ways."""

from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.events import Mode
from harness.core.scenario import FREE_DECAY
from harness.core.trajectory import Source, Trajectory
from harness.exact.decay import free_decay
from harness.results.run import RunResult

SCENARIO: dict[str, Any] = {
    "name": "free-decay",
    "slider": {"m": 1.0, "c": 1.0, "k": 100.0, "f_k": 3.0, "f_s": 3.0},
    "truth": {"omega_n": 10.0, "zeta": 0.05, "x_k": 0.03},
    "release": {"x0": 1.0, "v0": 0.0},
    "duration_s": 3.0,
}
MACHINE = {"python": "3.11.7", "packages": {"numpy": "2"}, "system": "Linux", "cores": 2, "seeds": {"noise": 7}}


def make_sources(samples: int = 3001) -> list[Trajectory]:
    """The reference, an as-shipped and a tuned engine; the as-shipped one has its own, coarser time stamps."""
    t: FloatArray = np.linspace(0.0, 3.0, samples, dtype=np.float64)
    reference = free_decay(FREE_DECAY, t)
    coarse = free_decay(FREE_DECAY, np.arange(1501, dtype=np.float64) * 2e-3)
    shipped = Trajectory(
        coarse.t,
        coarse.x + 5e-3 * np.sin(10.0 * coarse.t),
        coarse.v,
        coarse.a,
        Source(
            "mujoco",
            "as-shipped",
            "4.0.0",
            2e-3,
            {"integrator": "Euler", "solref": [0.02, 1.0], "noslip_iterations": 0},
            ("f_s = 4 N is not honoured: <MuJoCo> has one friction level",),
            0.02,
        ),
        extra={"friction_force": -3.0 * np.sign(coarse.v)},
    )
    tuned = Trajectory(
        reference.t,
        reference.x * (1.0 + 1e-3),
        reference.v,
        reference.a,
        Source("pybullet", "tuned", "3.2.7", 1e-3, {"dt": 1e-3}),
        u=np.zeros(samples),
        mode=np.full(samples, int(Mode.SLIP_POSITIVE), dtype=np.int8),
    )
    return [reference, shipped, tuned]


def quantity(value: float | None, stderr: float | None, unit: str, why: str | None = None) -> dict[str, Any]:
    return {"value": value, "stderr": stderr, "unit": unit, "why": why}


def estimate(x_k: float, per_reversal: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        "omega_n": quantity(10.0001, 2e-4, "rad/s"),
        "zeta": quantity(0.0501, 3e-5, "1"),
        "x_k": quantity(x_k, 2e-5, "m"),
        "reversals": 7,
        "per_reversal": per_reversal,
    }


def make_run_result(trajectories: list[Trajectory]) -> RunResult:
    """A harness.run/1 for the sources above."""
    refused = {
        "omega_n": quantity(10.0, None, "rad/s", "one period only"),
        "zeta": quantity(0.07, 0.004, "1"),
        "x_k": quantity(None, None, "m", "the method knows viscous damping alone"),
        "reversals": 7,
        "per_reversal": [],
    }
    traces = [
        {
            "source": trajectory.source.name,
            "preset": trajectory.source.preset,
            "version": trajectory.source.version,
            "settings": dict(trajectory.source.settings),
            "ignored": list(trajectory.source.ignored),
            "dt_s": trajectory.source.dt,
            "wall_s": trajectory.source.wall_s,
            "samples": len(trajectory),
            "metrics": {
                "max_error_m": 5e-3 * i,
                "rest_error_m": 1e-4 * i,
                "stick_time_s": None if i == 1 else 2.51642,
                "creep_m_s": -1.15e-3 if i == 1 else 0.0,
                "half_cycles": 8,
                "reversal_lead_s": 0.0098 if i == 1 else 0.0,
                "energy_error": 1e-3 * i,
            },
            "estimates": {
                "acceleration": estimate(0.03, []),
                "acceleration-local": estimate(0.006 if i == 1 else 0.03, []),
                "log-decrement": refused,
            },
        }
        for i, trajectory in enumerate(trajectories)
    ]
    return RunResult.model_validate(
        {
            "schema": "harness.run/1",
            "scenario": SCENARIO,
            "traces": traces,
            "conclusions": ["As shipped, friction reverses 9.8 ms before the speed does & x_k reads < 30 mm."],
            "command": "harness run",
            "machine": MACHINE,
            "files": {"report": "/out/report.html", "rrd": "/out/trace.rrd"},
        }
    )
