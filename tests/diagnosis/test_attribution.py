"""Whose a mismatch is: shares of a game, from a trace alone, against the same game with the true values."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from harness.core.recording import Recording
from harness.diagnosis.attribution.attribute import (
    Attribution,
    NoSharesError,
    attribute_model,
    attribute_trace,
    errors_of,
    nearby_of,
    saved,
)
from harness.diagnosis.attribution.reading import aligned, in_masses_of
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.parameters import free_of, values_of
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.estimate.noise import Noise
from harness.kernels.solve import Scales, simulate, solve
from harness.model.model import Model, ModelTerm

KINDS = ("parameters", "term", "both", "compensated", "waiting")


@dataclass(frozen=True, slots=True)
class SimCase:
    """kind : of KINDS. true : the recording's model. user : the simulation's. recorded, trace : of 5 to 9 cycles."""

    kind: str
    true: Model
    user: Model
    recorded: Problem
    trace: Recording
    scales: Scales


def sim_case(seed: int) -> SimCase:
    """One case, drawn by its number; a recording of x with noise of a thousandth, a trace that is exact."""
    random = np.random.default_rng([2026, seed])
    kind = KINDS[seed % len(KINDS)]
    omega, x0 = float(random.uniform(4.0, 30.0)), float(random.uniform(0.05, 2.0))
    loss = x0 * omega
    zeta, dry = random.uniform(0.004, 0.02), random.uniform(0.002, 0.012)
    c, f_k = 2.0 * zeta * omega, dry * omega**2 * x0
    drag = ModelTerm.named("quadratic-drag", c2=float(random.uniform(0.02, 0.08) / x0))
    cubic = ModelTerm.named("cubic-stiffness", k3=float(random.uniform(0.03, 0.15) * (omega / x0) ** 2))
    term = drag if kind == "compensated" or random.random() < 0.5 else cubic
    true = Model(1.0, float(c), omega**2, float(f_k), x0=x0, terms=(term,), mass_known=False)
    wrong = replace(
        true, c=float(c * random.uniform(0.4, 2.0)), f_k=float(f_k * random.uniform(0.5, 1.8)),
        k=float(omega**2 * random.uniform(0.97, 1.03)),
    )  # fmt: skip
    users = {
        "parameters": wrong,
        "term": true.with_terms(),
        "both": wrong.with_terms(),
        "waiting": wrong.with_terms(),
        # what the drag takes in a cycle at a share of the amplitude is put into the damper
        "compensated": replace(true, c=float(c + random.uniform(0.2, 0.8) * drag.values[0] * 0.85 * loss), terms=()),
    }
    user = users[kind]
    period = 2.0 * np.pi / omega
    span = float(random.uniform(5.0, 9.0)) * period
    t = np.arange(0.0, span, period / 120.0)
    sigma = 1e-3 * x0
    x = solve(true, t).x + sigma * random.standard_normal(t.size)
    recorded = FreeDecay(t, {"x": x}, {"x": Noise(sigma, True)})
    wait = float(random.uniform(0.3, 0.9)) * period if kind == "waiting" else 0.0
    ticks = np.arange(0.0, span + wait, period / 400.0)
    trace = Recording(ticks + float(random.uniform(-5.0, 5.0)), {"x": simulate(replace(user, t0=wait), ticks).x}, "sim")
    return SimCase(kind, true, user, recorded, trace, Scales(x0, loss, omega))


WITHIN = 0.05
SC = Scales(1.0, 10.0, 10.0)
DRAG = Model(
    1.0, 0.4, 100.0, 1.0, x0=1.0, terms=(ModelTerm.named("quadratic-drag", c2=0.3),), mass_known=False
)  # fmt: skip


def test_two_errors_along_one_line_share_by_the_formula() -> None:
    """One hides the share s of the other: squares left are (1 - s)^2, 1, s^2 and 0."""
    s = 0.3
    left = {
        frozenset(): (1.0 - s) ** 2, frozenset({"hides"}): 1.0, frozenset({"hidden"}): s**2,
        frozenset({"hides", "hidden"}): 0.0,
    }  # fmt: skip
    found = saved(("hides", "hidden"), left.__getitem__)
    assert found["hides"] == pytest.approx(-s * (1.0 - s))
    assert found["hidden"] == pytest.approx(1.0 - s)


def recording(model: Model = DRAG) -> Problem:
    t = np.arange(0.0, 5.0, 5e-3)
    random = np.random.default_rng(1)
    return FreeDecay(t, {"x": solve(model, t).x + 1e-3 * random.standard_normal(t.size)}, {"x": Noise(1e-3, True)})


def trace(model: Model, wait: float = 0.3) -> Recording:
    t = np.arange(0.0, 5.0 + wait, 1e-3)
    return Recording(t + 1.3, {"x": simulate(replace(model, t0=wait), t).x}, "sim.csv")


def test_right_parameters_without_the_drag_read_as_missing_physics() -> None:
    found = attribute_trace(trace(DRAG.with_terms()), None, DRAG, recording(), SC)
    assert found.joined
    assert found.engine == 0.0
    assert abs(found.parameters) < 1e-3
    assert found.missing_physics > 0.99


def test_an_exact_simulation_of_wrong_parameters_has_them_for_its_share() -> None:
    found = attribute_trace(trace(replace(DRAG, c=0.7)), None, DRAG, recording(), SC)
    assert found.parameters > 0.95
    assert abs(found.missing_physics) < 1e-3
    assert found.reading is not None
    assert found.reading.model.c == pytest.approx(0.7, abs=1e-4)
    assert found.reading.model.terms[0].values[0] == pytest.approx(0.3, abs=1e-4)


def test_a_damper_tuned_to_hide_drag_has_a_negative_share() -> None:
    found = attribute_trace(trace(replace(DRAG, c=0.8, terms=())), None, DRAG, recording(), SC)
    assert found.parameters < -0.1
    assert found.missing_physics > 1.0
    assert found.hides


def test_a_model_beside_the_trace_parts_engine_and_parameters() -> None:
    """The file says c = .4, the trace reads .7: the engine did it."""
    shown = trace(replace(DRAG, c=0.7))
    alone = attribute_trace(shown, None, DRAG, recording(), SC)
    parted = attribute_trace(shown, DRAG, DRAG, recording(), SC)
    assert parted.engine == pytest.approx(alone.parameters, abs=5e-3)
    assert abs(parted.parameters) < 1e-3
    both = attribute_trace(shown, replace(DRAG, c=0.7), DRAG, recording(), SC)
    assert abs(both.engine) < 1e-3
    assert both.parameters == pytest.approx(alone.parameters, abs=5e-3)


def test_a_trace_is_laid_release_on_release_where_the_fit_begins_after_it() -> None:
    """A recording that waits 0.5 s and is fitted from 0.6 s on: a trace that decays faster slips no period (0.63 s)."""
    t = np.arange(0.0, 5.5, 5e-3)
    x = simulate(replace(DRAG, t0=0.5), t).x + 1e-3 * np.random.default_rng(2).standard_normal(t.size)
    whole = FreeDecay(t, {"x": x}, {"x": Noise(1e-3, True)})
    begun = whole.part(slice(int(np.searchsorted(t, 0.6)), None))
    on = aligned(trace(replace(DRAG, c=1.5, terms=()), 0.0), begun, SC, whole)
    assert on.clock.shift == pytest.approx(0.5 - 1.3, abs=0.02)


def test_a_simulation_out_of_step_is_not_divided() -> None:
    with pytest.raises(NoSharesError, match="out of step"):
        attribute_model(replace(DRAG, k=900.0), DRAG, recording(), SC)


def test_forces_are_compared_per_mass_where_a_mass_is_not_known() -> None:
    heavy = Model(2.0, 0.8, 200.0, 2.0, x0=1.0, terms=(ModelTerm.named("quadratic-drag", c2=0.6),))
    light = in_masses_of(heavy, DRAG)
    assert (light.m, light.c, light.k, light.f_k, light.terms[0].values[0]) == (1.0, 0.4, 100.0, 1.0, 0.3)
    same = attribute_model(heavy, DRAG, recording(), SC)
    assert abs(same.parameters) < 1e-9
    assert abs(same.missing_physics) < 1e-9


def apart(found: Attribution, true: Attribution) -> float:
    """The largest difference of two shares."""
    names = ("parameters", "missing_physics", "unexplained")
    return max(abs(float(getattr(found, n)) - float(getattr(true, n))) for n in names)


def played(case: SimCase, refined: Model, problem: Problem) -> tuple[Attribution, Attribution]:
    """The game from the trace and a fitted model, and the same game with the true values."""
    true = attribute_model(case.user, case.true, case.recorded, case.scales)
    return attribute_trace(case.trace, None, refined, problem, case.scales), true


@pytest.mark.parametrize("seed", range(6))
def test_shares_are_those_of_the_game_with_the_true_values(seed: int) -> None:
    case = sim_case(seed)
    refined = fit(case.true, case.recorded, free_of(case.true, ("c", "k", "f_k", "x0", "v0")), case.scales).model
    found, true = played(case, refined, case.recorded)
    assert apart(found, true) < WITHIN, (case.kind, found, true)


def test_errors_of_shares_are_those_of_first_order() -> None:
    """Of a share that is linear in the fitted numbers the variance is g C g, whatever their units."""
    found = fit(DRAG, recording(), free_of(DRAG, ("c", "k", "f_k", "x0", "v0")), SC)
    scale = np.sqrt(np.diag(covariance := found.covariance()))
    slopes = np.array([1.0, -2.0, 0.5, 3.0, 1.5, -0.7])[: scale.size] / scale

    def shares(model: Model) -> dict[str, float]:
        return {"": float(slopes @ (values_of(model, found.free) - found.values))}

    errors = errors_of(shares, {"": 0.0}, nearby_of(found, (covariance,)))
    assert errors is not None
    assert errors[""] == pytest.approx(np.sqrt(slopes @ covariance @ slopes), rel=1e-6)
    assert errors_of(shares, {"": 0.0}, ()) is None
