"""A descent in amplitude and phase ends where that of the samples does, from where the samples lead nowhere."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.diagnosis.fit.model_fit import chi2_of, fit
from harness.diagnosis.fit.observe import observe
from harness.diagnosis.fit.parameters import Free, free_of, values_of, with_values
from harness.diagnosis.fit.swing_fit import Swing, swung
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.estimate.noise import Noise
from harness.kernels.solve import Scales, simulate
from harness.model.model import Model, ModelTerm, Restoring

BASE = ("c", "k", "f_k", "offset", "x0", "v0")
OMEGA = 7.0
TRUE = Model(1.0, 2.0 * 0.004 * OMEGA, OMEGA**2, 0.03, x0=0.3, v0=0.2, offset=0.01)
T: FloatArray = np.arange(0.0, 60.0, 0.02)
NOISE = 1e-3


def problem(model: Model = TRUE, t: FloatArray = T, noise: float = NOISE, seed: int = 1) -> FreeDecay:
    x = simulate(model, t).x + model.offset + noise * np.random.default_rng(seed).standard_normal(t.size)
    return FreeDecay(t, {"x": x}, {"x": Noise(noise, True)}, zero_free=True, restoring=model.restoring)


def swing_of(whole: FreeDecay) -> Swing:
    swing = Swing.of(whole, OMEGA)
    assert swing is not None
    return swing


def led(start: Model, whole: FreeDecay, free: tuple[Free, ...], scales: Scales) -> tuple[Model, float]:
    """Where the swing leads, and by how much the phase is off there at most, rad."""
    swing = swing_of(whole)
    near = swung(start, swing, free, scales)
    return near, float(np.max(np.abs(swing.phase_missed(observe(near, swing.problem, (), scales)))))


# the last one is off by six cycles at the end of 67
FAR = {
    "damping": {"c": 0.2},
    "friction": {"f_k": 0.1},
    "half a cycle": {"k": 1.02 * OMEGA**2},
    "six": {"k": 1.2 * OMEGA**2},
}


@pytest.mark.parametrize("moved", list(FAR.values()), ids=list(FAR))
def test_it_ends_where_the_samples_are_met(moved: dict[str, float]) -> None:
    whole = problem()
    start = replace(TRUE, **moved)  # type: ignore[arg-type]
    free, scales = free_of(start, BASE), Scales.of(TRUE)
    assert chi2_of(start, whole, scales) > 50.0 * T.size
    near, slip = led(start, whole, free, scales)
    assert slip < 1.0
    best = fit(near, whole, free, scales)
    assert best.chi2 == pytest.approx(T.size, rel=3.0 * math.sqrt(2.0 / T.size))
    assert best.model.k == pytest.approx(TRUE.k, rel=1e-4)


def test_of_a_pendulum_and_of_a_law_besides() -> None:
    drag = ModelTerm.named("quadratic-drag", c2=0.3)
    true = replace(TRUE, restoring=Restoring.PENDULUM, x0=1.2, terms=(drag,))
    whole = problem(true)
    start = replace(true, k=1.1 * true.k, terms=(ModelTerm.named("quadratic-drag", c2=0.05),))
    free, scales = free_of(start, BASE), Scales.of(true)
    near, slip = led(start, whole, free, scales)
    assert slip < 0.2
    assert near.terms[0].values[0] == pytest.approx(0.3, rel=0.1)


def test_partials_are_those_of_the_swing() -> None:
    """Central differences, through reversals."""
    swing = swing_of(problem(t=T[:400], noise=1e-5))
    model = replace(TRUE, c=0.07, f_k=0.04, x0=0.28)
    free, scales = free_of(model, BASE), Scales.of(TRUE)
    by = tuple(f.by for f in free)
    values = values_of(model, free)
    _, partials = swing.missed(observe(model, swing.problem, by, scales))
    for i in range(len(free)):
        h = np.zeros(len(free))
        h[i] = 1e-5 * max(abs(values[i]), 0.01)
        up, down = (
            swing.missed(observe(with_values(model, free, values + s * h), swing.problem, (), scales))[0]
            for s in (1.0, -1.0)
        )
        difference = (down - up) / (2.0 * h[i])
        # the weight of a phase is the recording's amplitude, of its partial too
        assert partials[:, i] == pytest.approx(difference, abs=3e-3 * float(np.max(np.abs(difference))))


def test_uneven_samples_and_noise_of_a_tenth_are_followed() -> None:
    t = np.sort(np.random.default_rng(3).uniform(0.0, 60.0, 3000))
    whole = problem(t=t, noise=0.03)
    start = replace(TRUE, k=1.1 * TRUE.k)
    free, scales = free_of(start, BASE), Scales.of(TRUE)
    near, slip = led(start, whole, free, scales)
    assert slip < 1.0
    best = fit(near, whole, free, scales)
    assert best.chi2 == pytest.approx(t.size, rel=3.0 * math.sqrt(2.0 / t.size))
