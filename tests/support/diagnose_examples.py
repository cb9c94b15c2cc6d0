"""A small recording with a known cause, and a result by hand."""

from pathlib import Path

import numpy as np

from harness.app.shared.machine import this_machine
from harness.kernels.solve import simulate
from harness.model.model import Model, ModelTerm
from harness.results.common import BaseParameters, ModelDocument, P, RecordingInfo, Where
from harness.results.diagnosis import (
    AlternativeResult,
    DiagnosisResult,
    EngineResult,
    FitResult,
    HoldoutResult,
    MechanismResult,
)

STOP = Model(
    1.0, 0.4, 100.0, 0.3, x0=0.1, terms=(ModelTerm.named("end-stop:positive", gap=0.05, k_stop=60.0),), mass_known=False
)


def stopped(path: Path, model: Model = STOP, samples: int = 500, step: float = 0.008) -> Path:
    """x and a of a decay against a stop, with the noise of good sensors; times that no decimal writes exactly."""
    t = np.arange(samples, dtype=np.float64) * step + 1.0 / 3.0
    motion = simulate(model, t - t[0])
    noise = np.random.default_rng(2)
    x = motion.x + noise.normal(0.0, 1e-4, t.size)
    a = motion.a + noise.normal(0.0, 0.05, t.size)
    rows = [f"{row[0]!r},{row[1]:.9g},{row[2]:.9g}" for row in np.column_stack([t, x, a]).tolist()]
    path.write_text("t,x,a\n" + "\n".join(rows) + "\n")
    return path


def example(label: str, sha256: str = "0" * 64, **changed: object) -> DiagnosisResult:
    """A result with everything in it, as if it had been found."""
    number = P(value=10.0, stderr=0.01, unit="rad/s")
    fit = FitResult(parameters={"omega_n": number}, rmse={"x": 1e-3}, chi2_per_point=12.0)
    document = ModelDocument(base=BaseParameters(m=1.0, c=0.4, k=100.0, f_k=0.3))
    throughout = Where(time_s=[[0.0, 4.0]], regime="throughout", condition="always", share=1.0)
    result = DiagnosisResult(
        recording=RecordingInfo(
            file=label, sha256=sha256, samples=500, channels=["x"], rate_hz=125.0, duration_s=4.0, noise={"x": 1e-4}
        ),
        verdict="missing_physics",
        statement="The simulation misses a stop.",
        baseline=fit,
        where=[],
        mechanisms=[
            MechanismResult(
                name="end-stop",
                family="stiffness",
                statement="A stop acts.",
                parameters={"gap": P(value=0.05, stderr=1e-4, unit="m")},
                delta_bic=1000.0,
                where=throughout,
                alternatives=[AlternativeResult(name="cubic-stiffness", delta_bic=8.0)],
            )
        ],
        refined=fit,
        holdout=HoldoutResult(spans_s=[], baseline_rmse={}, refined_rmse={}),
        engines={"mujoco": EngineResult(settings={}, baseline_rmse={}, refined_rmse={}, error="not installed")},
        attribution=None,
        evidence=[],
        consistent_channels={},
        next_experiment="",
        residual_map=None,
        baseline_model=document,
        refined_model=document,
        model_left_out=[],
        warnings=[],
        settings={},
        machine=this_machine(),
        files={},
    )
    return result.model_copy(update=changed)
