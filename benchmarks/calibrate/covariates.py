"""Free decays beside which a column was measured that pushes, rubs, damps or does nothing: is that what is found?"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.calibrate.calibration import Calibration, head, quantiles, stands
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.pipeline import diagnose, prepare
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.request import Asked, AskedCovariate
from harness.diagnosis.rules import DECISIVE
from harness.estimate.noise import Noise
from harness.model.covariate import Acts, Covariate
from harness.model.model import Model, Restoring

_SAMPLES, _X = 800, 0.3
_NOISE, _COLUMN_NOISE = 1e-4, 2e-3
"""Of the motion over its first swing, of the column over its range."""
_CHANNELS = (("x",), ("x", "a"), ("v",), ("a",))
_WAYS = (*Acts, None)


@dataclass(frozen=True, slots=True)
class Row:
    """What acted and what was found to; errors : how far the gain is off, in standard errors, nan without one.

    said_idle : whether it is said that nothing shows that it acts.
    """

    acts: Acts | None
    found: Acts
    verdict: str
    errors: float
    said_idle: bool


def measure(seed: int, index: int) -> Row:
    """One decay: of a spring or a pendulum, the zero known or not, seen in one or two channels."""
    rng = np.random.default_rng([seed, 11, index])
    acts = _WAYS[index % len(_WAYS)]
    restoring = (Restoring.SPRING, Restoring.PENDULUM)[index // len(_WAYS) % 2]
    channels = _CHANNELS[int(rng.integers(len(_CHANNELS)))]
    zero_free = "x" in channels and bool(rng.integers(2))
    omega = float(rng.uniform(4.0, 12.0))
    t = np.linspace(0.0, float(rng.uniform(10.0, 18.0)) * 2.0 * math.pi / omega, _SAMPLES)
    column = _column(t, rng)
    gain = _gain(acts, omega, rng)
    mean = float(np.mean(column))
    model = Model(
        1.0, 2.0 * float(rng.uniform(0.004, 0.015)) * omega, omega**2, float(rng.uniform(0.002, 0.008)) * _X * omega**2,
        restoring=restoring, x0=_X,
        covariates=(Covariate("P", acts, gain, mean, levelled=False),) if acts else (),
    )  # fmt: skip
    blank = {c: np.zeros(t.size) for c in channels}
    problem = FreeDecay(t, blank, {c: Noise(1.0, True) for c in channels}, covariates={"P": column})
    shown = observe(model, problem).y
    size = {"x": _X, "v": _X * omega, "a": _X * omega**2}
    seen = {c: y + _NOISE * size[c] * rng.standard_normal(t.size) for c, y in shown.items()}
    if zero_free:
        seen["x"] = seen["x"] + 0.02
    read = column + _COLUMN_NOISE * float(np.ptp(column)) * rng.standard_normal(t.size)
    recording = Recording(t, seen, "decay", covariates={"P": read}, angular=restoring is Restoring.PENDULUM)
    asked = Asked(restoring, zero_free, covariates=(AskedCovariate("P"),))
    found = diagnose(prepare(recording, asked)[0])
    (one,) = found.base.model.covariates
    quantity = found.base_parameters["gain_P"]
    errors = math.nan
    if acts is one.acts and quantity.value is not None and quantity.stderr:
        errors = abs(quantity.value - gain) / quantity.stderr
    return Row(acts, one.acts, found.verdict, errors, "nothing shows" in found.problem.choices[0])


def _column(t: FloatArray, rng: np.random.Generator) -> FloatArray:
    """A column that goes up and down some times, about 3."""
    turns = rng.uniform((0.5, 1.5), (1.5, 6.0))
    phases = rng.uniform(0.0, 2.0 * math.pi, 2)
    waves = (np.sin(2.0 * math.pi * n * t / t[-1] + p) for n, p in zip(turns, phases, strict=True))
    return np.asarray(3.0 + sum(size * wave for size, wave in zip((0.8, 0.5), waves, strict=True)), dtype=np.float64)


def _gain(acts: Acts | None, omega: float, rng: np.random.Generator) -> float:
    """About as large as a machine has it: a fiftieth of the spring's force, a third of friction or damping."""
    size = float(rng.uniform(0.5, 1.5))
    return size * (0.02 * omega**2 * _X if acts is Acts.FORCE else 0.3)


def said(rows: Sequence[Row]) -> Iterator[str]:
    """Shares of what was found, the gain's error, and whether an idle column is told."""
    for acts in _WAYS:
        some = [row for row in rows if row.acts is acts]
        if not some:
            continue
        quiet = sum(row.verdict == "adequate" for row in some)
        if acts is None:
            idle = sum(row.said_idle for row in some)
            yield f"idle: said so {idle} of {len(some)}, adequate {quiet}"
        else:
            right = sum(row.found is acts for row in some)
            yield f"{acts.value}: entered so {right} of {len(some)}, adequate {quiet}"
    errors = [row.errors for row in rows if math.isfinite(row.errors)]
    yield head("gain off, standard errors")
    yield quantiles("entered as it acts", errors)
    yield f"within two standard errors: {sum(e <= 2.0 for e in errors)} of {len(errors)}"
    idle_rows = [row for row in rows if row.acts is None]
    missed = sum(not row.said_idle for row in idle_rows) + sum(row.found is not row.acts for row in rows if row.acts)
    yield stands(DECISIVE, missed <= 0.05 * len(rows), f"{missed} of {len(rows)} entered otherwise than they act")


CALIBRATION = Calibration(measure, said, "how a column beside a free decay is found to act")
