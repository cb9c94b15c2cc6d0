"""Steps of the search: what one more term may be, and where a descent in amplitude and phase ends."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.explain.mechanism import mechanism
from harness.diagnosis.fit.model_fit import Fit, chi2_of, fit
from harness.diagnosis.fit.swing_fit import Swing, swung
from harness.diagnosis.parameters import Free, base_of, free_of, values_of, with_values
from harness.diagnosis.problem import Observation
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.search.extend import extend, prune
from harness.diagnosis.search.look import Recorded, frequencies, within
from harness.diagnosis.search.search import Search
from harness.estimate.noise import Noise, channel_noise
from harness.kernels.solve import By, Effort, Scales, simulate, solve
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.registry import NAMED


class FollowedBelow(FreeDecay):
    """A decay whose partials cannot be followed beside a stiff spring."""

    __slots__ = ()

    def shows(self, model: Model, by: tuple[By, ...], scales: Scales | None, effort: Effort) -> Observation:
        shown = super().shows(model, by, scales, effort)
        (cubic,) = model.terms
        return shown if cubic.values[0] < 300.0 else replace(shown, dy={"x": np.nan * shown.dy["x"]})


def test_where_partials_cannot_be_followed_no_descent_goes() -> None:
    t = np.linspace(0.0, 8.0, 1200)
    true = Model(1.0, 0.3, 100.0, 0.4, x0=0.1, terms=(ModelTerm.named("cubic-stiffness", k3=900.0),))
    x = simulate(true, t).x + 1e-4 * np.random.default_rng(1).standard_normal(t.size)
    channels, noise = {"x": x}, {"x": channel_noise(t, x)}
    base, scales = baseline(FreeDecay(t, channels, noise))
    problem = FollowedBelow(t, channels, noise)
    free = free_of(true, base_of(base.free))

    def begun(k3: float) -> Fit:
        return fit(replace(base.model, terms=(ModelTerm.named("cubic-stiffness", k3=k3),)), problem, free, scales)

    found = begun(1.0)
    assert 1.0 < found.model.terms[0].values[0] < 300.0
    assert np.isfinite(found.covariance()).all()
    with pytest.raises(SimulationError, match="what the fitted numbers change"):
        begun(400.0)


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        (ModelTerm.named("harmonic-force", A=0.1, Omega=3.2, phase=0.0), True),
        (ModelTerm.named("harmonic-force", A=0.1, Omega=3.0, phase=0.0), False),
        (ModelTerm.named("normal-load-variation", depth=0.1, Omega=3.0, phase=0.0), False),
        (ModelTerm.named("force-ripple", amplitude=0.1, period=0.19, phase=0.0), True),
        (ModelTerm.named("force-ripple", amplitude=0.1, period=0.21, phase=0.0), False),
        (ModelTerm.named("quadratic-drag", c2=0.1), True),
    ],
    ids=lambda v: v.term.key if isinstance(v, ModelTerm) else str(v),
)
def test_less_than_a_period_is_no_repetition(entry: ModelTerm, said: bool) -> None:
    """Half a period in 1 s is pi rad/s; one over 0.2 m of travel is 0.2 m."""
    assert within(entry, 0.5, Recorded(0.2, 1.0), 0.5) is said


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        (ModelTerm.named("harmonic-force", A=1.0, Omega=31.0, phase=0.0), True),
        (ModelTerm.named("harmonic-force", A=1.0, Omega=32.0, phase=0.0), False),
        (ModelTerm.named("normal-load-variation", depth=0.1, Omega=68.0, phase=0.0), False),
        (ModelTerm.named("force-ripple", amplitude=1.0, period=0.0801, phase=0.0), True),
        (ModelTerm.named("force-ripple", amplitude=1.0, period=0.0799, phase=0.0), False),
        (ModelTerm.named("position-dependent-friction:periodic", depth=0.1, period=0.01, phase=0.0), False),
        (ModelTerm.named("position-dependent-friction", slope=1.0), True),
    ],
)
def test_what_repeats_within_two_samples_is_another_in_its_guise(entry: ModelTerm, said: bool) -> None:
    """Samples 0.1 s apart show 10 pi rad/s; of a driven way at 0.4 m/s but for its ends they show 0.08 m."""
    t = np.linspace(0.0, 10.0, 101)
    x = 0.4 * np.clip(t, 1.0, 9.0)
    assert within(entry, 0.5, Recorded.of(t, x, driven=True)) is said
    assert within(entry, 0.5, Recorded.of(t, x, driven=False)) is (said or entry.repeats("time") is None)


def test_no_force_is_tried_beyond_half_the_rate_of_the_samples() -> None:
    t = np.arange(0.0, 20.0, 0.09)
    x = simulate(Model(1.0, 0.2, 53.0, 0.15, x0=0.33), t).x + 1e-3 * np.random.default_rng(1).standard_normal(t.size)
    problem = FreeDecay(t, {"x": x}, {"x": channel_noise(t, x)})
    base, scales = baseline(problem)
    tried = frequencies(base, problem, scales.omega)
    assert 0.8 * np.pi / 0.09 < tried.max() < np.pi / 0.09 < 12.0 * scales.omega


def test_friction_that_never_slides_is_a_spring_whatever_its_level() -> None:
    """As f_k grows by ten, what is between the bristle and a spring of its stiffness falls by ten."""
    t, sigma0 = np.linspace(0.0, 6.0, 300), 30.0
    bristle = ModelTerm.named("presliding", sigma0=sigma0, sigma1=0.0)
    plain = simulate(Model(1.0, 0.3, 100.0 + sigma0, 0.0, v0=1.0), t).x

    def apart(f_k: float) -> float:
        return float(np.max(np.abs(simulate(Model(1.0, 0.3, 100.0, f_k, v0=1.0, terms=(bristle,)), t).x - plain)))

    assert apart(3e4) == pytest.approx(0.1 * apart(3e3), rel=0.05)
    assert apart(3e4) < 1e-4


def test_a_branch_that_relaxes_slowly_is_a_spring_and_a_constant_force() -> None:
    """k_m (x - x_0): of 20 % of the spring, as tau grows by ten what is between the two falls by ten."""
    t, x0, k_m = np.linspace(0.0, 8.0, 400), 0.1, 20.0
    push = ModelTerm.named("constant-force", force=k_m * x0)
    plain = simulate(Model(1.0, 0.3, 100.0 + k_m, 0.4, x0=x0, terms=(push,)), t).x

    def apart(tau: float) -> float:
        slow = ModelTerm.named("viscoelastic", k_m=k_m, tau=tau)
        return float(np.max(np.abs(simulate(Model(1.0, 0.3, 100.0, 0.4, x0=x0, terms=(slow,)), t).x - plain)))

    assert apart(1e4) == pytest.approx(0.1 * apart(1e3), rel=0.05)
    assert apart(1e4) < 1e-4 * x0


def test_a_law_whose_relaxation_is_not_seen_is_no_name() -> None:
    """A constant force beside a spring: such a branch would follow it as well."""
    t = np.linspace(0.0, 8.0, 1200)
    push = ModelTerm.named("constant-force", force=1.5)
    x = simulate(Model(1.0, 0.3, 100.0, 0.4, x0=0.1, terms=(push,)), t).x
    x = x + 1e-4 * np.random.default_rng(1).standard_normal(t.size)
    problem = FreeDecay(t, {"x": x}, {"x": channel_noise(t, x)})
    base, scales = baseline(problem)
    fits = extend(base, problem, scales, [one for one in NAMED if one.name in ("constant-force", "viscoelastic")]).fits
    assert fits[0].model.terms[-1].term.name == "constant-force"
    assert all(f.model.terms[-1].relaxation is None or f.model.terms[-1].relaxation <= 8.0 for f in fits)


def test_a_term_of_a_pair_is_worth_what_is_lost_when_it_is_taken_out_and_the_rest_fitted_again() -> None:
    cubic, drag = ModelTerm.named("cubic-stiffness", k3=60.0), ModelTerm.named("quadratic-drag", c2=0.05)
    truth = Model(1.0, 0.3, 100.0, 0.4, x0=0.1, terms=(cubic, drag))
    t = np.arange(0.0, 4.0, 0.01)
    x = solve(truth, t).x + 1e-5 * np.random.default_rng(2).standard_normal(t.size)
    problem, scales = FreeDecay(t, {"x": x}, {"x": Noise(1e-5, True)}), Scales(0.1, 1.0, 10.0)
    names = ("c", "k", "f_k", "x0")
    base, pair = (fit(m, problem, free_of(m, names), scales) for m in (truth.with_terms(), truth))
    kept, without = prune(pair, problem, scales)
    assert kept is pair
    found = Search(problem, base, pair, (), (), Left.NOISE, without)
    for i, other in enumerate((drag, cubic)):
        alone = truth.with_terms(other)
        expected = fit(alone, problem, free_of(alone, names), scales).bic - pair.bic
        assert mechanism(found, i, scales.omega).delta_bic == pytest.approx(expected, abs=0.1)


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
