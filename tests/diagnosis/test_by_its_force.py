"""What is fitted by its force: laws that no motion shows, a push, a spring that nobody spoke of."""

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import harness
from harness import stages
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.inverse_dynamics.prepare import with_unseen_mass
from harness.diagnosis.inverse_dynamics.search import by_the_force
from harness.diagnosis.kinds import driven
from harness.diagnosis.pipeline import diagnose, prepare
from harness.diagnosis.prepare.driven import forced_problem
from harness.diagnosis.prepare.held import spring_beside
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.request import Asked
from harness.diagnosis.rules import FOLLOWED
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring

NOTE = "followed, the base model misses far more than the noise and no law explains it: the force is fitted instead"
NAMED = ModelTerm.named


def _recorded(*terms: ModelTerm) -> Any:
    """A free axis under two sines of force."""
    t: FloatArray = np.arange(600.0) / 100.0
    u: FloatArray = 6.0 * np.sin(3.1 * t + 0.3) + 4.0 * np.sin(7.3 * t + 1.1)
    true = Model(2.0, 3.0, 0.0, 1.5, restoring=Restoring.NONE, terms=terms)
    x = solve(true, t, drive=Drive(t, u)).x + 1e-3 * np.random.default_rng(1).standard_normal(t.size)
    return stages.prepare(Recording(t=t, channels={"x": x, "u": u}), restoring="none").problem


def test_what_no_law_explains_is_fitted_by_its_force(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driven, "FOLLOWED", replace(FOLLOWED, value=100.0))
    # two that are not searched together: neither explains
    monkeypatch.setattr(Driven, "pairs_searched", False)
    problem = _recorded(NAMED("force-ripple", amplitude=2.0, period=0.15, phase=0.3), NAMED("quadratic-drag", c2=3.0))
    assert isinstance(problem, Driven)
    outcome = diagnose(problem)
    assert isinstance(outcome.problem, InverseDynamics)
    assert NOTE in outcome.warnings
    # what a force that was never measured leaves of it hides the weaker of the two
    assert outcome.verdict != "adequate"
    assert {m.name for m in outcome.mechanisms} <= {"force-ripple", "quadratic-drag"}


_PERIOD = 0.014


def _rippled() -> Recording:
    """A free axis that is drawn into the wells of a ripple as it turns: a model without it stops elsewhere."""
    t: FloatArray = np.arange(2500.0) * 5e-3
    random = np.random.default_rng(5)
    sines = zip((0.35, 0.3, 0.2), (1.7, 2.9, 4.7), random.uniform(0.0, 6.0, 3), strict=True)
    u: FloatArray = np.sum([size * np.sin(rate * t + phase) for size, rate, phase in sines], axis=0)
    terms = (ModelTerm.named("force-ripple", amplitude=0.03, period=_PERIOD, phase=1.0),)
    model = Model(m=1.0, c=0.8, k=0.0, f_k=0.12, restoring=Restoring.NONE, terms=terms)
    x = solve(model, t, drive=Drive(t, u)).x + 5e-5 * random.standard_normal(t.size)
    return Recording(t=t, channels={"x": x, "u": u})


def test_the_force_shows_a_ripple_wherever_the_model_has_gone() -> None:
    problem = stages.prepare(_rippled(), restoring="none").problem
    assert isinstance(problem, Driven)
    based = stages.fit_base(problem)
    assert based.fit.chi2 > 30.0 * based.fit.points
    laws = by_the_force(problem, based.fit.model)
    ripple = next(model.terms[0] for model in laws if model.terms[0].term.name == "force-ripple")
    assert ripple.value("period") == pytest.approx(_PERIOD, rel=0.02)
    assert {(model.x0 + model.offset, model.v0, model.t0) for model in laws} == {
        (based.fit.model.x0, based.fit.model.v0, based.fit.model.t0)
    }
    found = stages.search(based).search
    (law,) = found.chosen.model.terms
    assert found.explained
    assert law.term.name == "force-ripple"
    assert law.value("period") == pytest.approx(_PERIOD, rel=1e-3)
    assert abs(law.value("amplitude")) == pytest.approx(0.03, rel=1e-2)


PUSH, MASS = 150.0, 0.1


def recorded(push: float = PUSH) -> Recording:
    """Strokes of 36 mm in about 4 s each, of which no two are alike; the force that they take beside what pushes."""
    t: FloatArray = np.arange(4000.0) / 100.0
    phase = 0.77 * t + 0.25 * np.sin(0.23 * t) + 0.1 * np.sin(0.41 * t + 1.0)
    x = 0.018 * np.tanh(1.6 * np.sin(phase)) / np.tanh(1.6) + 0.017
    v, random = np.gradient(x, t), np.random.default_rng(5)
    a = np.gradient(v, t)
    own = np.zeros(t.size)
    for i in range(1, t.size):
        # what a seal does that nobody models, correlated over a tenth of a second
        own[i] = 0.9 * own[i - 1] + 0.1 * random.standard_normal()
    u = MASS * a + 300.0 * v + 4.0 * np.tanh(v / 1e-3) + push + own
    return Recording(t=t, channels={"x": x + 2e-5 * random.standard_normal(t.size), "u": u})


def test_a_push_is_named() -> None:
    outcome = diagnose(stages.prepare(recorded()).problem)
    (push,) = (m for m in outcome.mechanisms if m.name == "constant-force")
    assert push.grade is not None
    assert push.grade.value in ("main", "one-of", "explains")
    (force,) = push.parameters.values()
    assert force.value is not None
    # as the equation of motion has it: on the side of what drives
    assert force.value == pytest.approx(-PUSH, rel=0.01)
    assert [m.name for m in outcome.mechanisms].count("harmonic-force") <= 1


def test_its_mass_is_not_seen() -> None:
    problem = stages.prepare(recorded(), restoring="none").problem
    assert isinstance(problem, InverseDynamics)
    known = with_unseen_mass(problem)
    # a tenth of what the best law leaves, by far not of what the base does
    assert known.mass is not None
    assert MASS < known.mass < 10.0
    assert any("does not show the mass" in said for said in known.choices)


T = np.linspace(0.0, 4.0, 2001)
U = 3.0 * np.sin(2.0 * np.pi * 1.1 * T) + 1.5 * np.sin(2.0 * np.pi * 0.37 * T + 1.0)


@given(st.floats(10.0, 300.0), st.floats(0.0, 1.0), st.booleans())
def test_a_spring_is_found_with_its_stiffness(k: float, f_k: float, mass_known: bool) -> None:
    run = solve(Model(m=1.0, c=1.2, k=k, f_k=f_k), T, drive=Drive(T, U))
    found, share, there = spring_beside((run.x, run.v, run.a), U, 1.0 if mass_known else None)
    assert found == pytest.approx(k, rel=1e-6)
    assert share == pytest.approx(1.0, abs=1e-6)
    assert there


@given(st.floats(0.0, 1.0), st.floats(0.1, 5.0))
def test_where_none_is_none_is_found(f_k: float, c: float) -> None:
    run = solve(Model(m=1.0, c=c, k=0.0, f_k=f_k, restoring=Restoring.NONE), T, drive=Drive(T, U))
    assert abs(spring_beside((run.x, run.v, run.a), U, 1.0)[0]) < 1e-6


def said(k: float, angular: bool = False) -> list[str]:
    model = Model(m=1.0, c=1.2, k=k, f_k=0.5, restoring=Restoring.SPRING if k > 0.0 else Restoring.NONE)
    x = solve(model, T, drive=Drive(T, U)).x
    noisy = x + 2e-6 * np.random.default_rng(3).standard_normal(T.size)
    _, notes = prepare(Recording(T, {"x": noisy, "u": U}, "spring", angular=angular), Asked(Restoring.NONE))
    return [note for note in notes if "spring" in note]


@pytest.mark.parametrize(("angular", "unit"), [(False, "N/m"), (True, "N m/rad")])
def test_the_user_is_told_what_has_it(angular: bool, unit: str) -> None:
    (sentence,) = said(60.0, angular)
    words = rf"a spring of (\S+) {unit} takes (\S+) % off what is left of the force: --restoring spring has it"
    found = re.fullmatch(words, sentence)
    assert found is not None, sentence
    # the state is smoothed from x alone
    assert [float(n) for n in found.groups()] == pytest.approx([60.0, 100.0], rel=0.01)


@pytest.mark.parametrize("f_s", [None, 3.6])
def test_what_holds_a_slider_at_rest_is_seen_beside_the_force_of_its_sliding(f_s: float | None, tmp_path: Path) -> None:
    """A slider without a spring that stands at each end: 3.6 N hold it where 1.5 N brake it."""
    t: FloatArray = 0.004 * np.arange(3000.0)
    u: FloatArray = 4.0 * np.sin(1.1 * t + 0.3) + 2.0 * np.sin(2.3 * t + 1.1)
    model = Model(2.0, 3.0, 0.0, 1.5, f_s, restoring=Restoring.NONE, mass_known=True)
    x = solve(model, t, drive=Drive(t, u)).x + 1e-5 * np.random.default_rng(3).standard_normal(t.size)
    problem, _ = forced_problem(Recording(t, {"x": x, "u": u}, "slider"), Asked(Restoring.NONE))
    level = problem.levelled(np.full(10, 0.01), 10.0)
    held = level.holds(model if f_s is None else replace(model, f_s=None))
    if f_s is None:
        assert held is None
        return
    # two blocks before it breaks away, while the force grows
    assert held is not None
    assert f_s - 2.0 * 0.04 * float(np.max(np.gradient(u, t))) < held <= f_s
    path = tmp_path / "slider.csv"
    np.savetxt(path, np.column_stack([t, x, u]), delimiter=",", header="t [s],x [m],u [N]", comments="")
    found = harness.diagnose(path, restoring="none", engines=())
    (named,) = found.mechanisms
    assert named.name == "static-friction"
    told = named.parameters["f_s"]
    assert told.value is not None
    assert told.stderr is not None
    # how the force bends between two samples is not recorded
    bent = float(np.max(np.abs(np.gradient(np.gradient(u, t), t)))) * 0.004**2 / 8.0
    assert abs(told.value - f_s) < bent + 2.0 * told.stderr


def _held_axis(seed: int) -> Recording:
    """A free axis led by a loop that holds its force between samples, and whose force is logged with noise."""
    random, dt = np.random.default_rng(seed), 0.002
    t = dt * np.arange(3000.0)
    way: FloatArray = np.zeros(t.size)
    begin = 0.1
    for far, lasts in ((0.05, 0.35), (-0.09, 0.5), (0.07, 0.3), (-0.06, 0.9), (0.08, 0.4), (-0.07, 0.5), (0.09, 0.6)):
        s: FloatArray = np.clip((t - begin) / lasts, 0.0, 1.0)
        way += far * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        begin += lasts + 0.2
    ahead = np.gradient(way, t)
    x, u, place, speed = np.zeros(t.size), np.zeros(t.size), 0.0, 0.0
    for i in range(t.size):
        x[i], u[i] = place, 33.0 * (3600.0 * (way[i] - place) + 96.0 * (ahead[i] - speed))
        side = math.copysign(1.0, speed if speed != 0.0 else u[i])
        if speed == 0.0 and abs(u[i]) <= 36.0:
            continue
        # the exact step of m v' = u - c v - f_k side over a sample, cut where it turns
        end = (u[i] - 36.0 * side) / 36.0
        fade = math.exp(-36.0 / 33.0 * dt)
        new = end + (speed - end) * fade
        lasts = dt
        if new * side < 0.0:
            lasts, new = math.log((speed - end) / -end) * 33.0 / 36.0, 0.0
            fade = math.exp(-36.0 / 33.0 * lasts)
        place += end * lasts + (speed - end) * 33.0 / 36.0 * (1.0 - fade)
        speed = new
    noise = random.standard_normal((2, t.size))
    return Recording(t=t, channels={"x": x + 1e-7 * noise[0], "u": u + noise[1]})


def test_a_force_that_is_fitted_acts_as_it_was_held() -> None:
    """Half a sample late it would be a sixth of the damping: m omega^2 dt/2 at 20 rad/s is 13 N s/m."""
    for seed in (0, 1):
        problem = stages.prepare(_held_axis(seed), restoring="none").problem
        assert isinstance(problem, InverseDynamics)
        assert problem.drive.held
        model = stages.fit_base(problem).fit.model
        assert (model.m, model.c, model.f_k) == pytest.approx((33.0, 36.0, 36.0), rel=0.03)


def _joint(late: float = 0.0, jump: float = 0.0, *terms: ModelTerm) -> Recording:
    """A joint of 0.4 kg m^2, 0.6 N m s/rad and 2 N m under a gravity of 25 N m, swung by a torque that is held over
    4 ms, jumps by so much, N m, and has stamps that are so many samples late; an encoder of 2^16 counts.
    """
    dt, count, random = 0.004, 2.0 * math.pi / 2**16, np.random.default_rng(0)
    t = dt * np.arange(5000.0)

    def asked(at: FloatArray) -> FloatArray:
        return np.asarray(9.0 * np.sin(2.7 * at) + 6.0 * np.sin(6.1 * at + 1.0) + 4.0 * np.sin(11.3 * at + 2.0))

    jumps = jump * random.standard_normal(t.size)
    u = asked(t) + jumps
    truth = Model(0.4, 0.6, 25.0, 2.0, restoring=Restoring.PENDULUM, terms=terms)
    x = solve(truth, t, drive=Drive(t, u, held=True)).x
    # at the time at which it is logged, and not a line between two samples, which is a little less than it
    torque = asked(t - late * dt) + jumps + 0.02 * random.standard_normal(t.size)
    return Recording(t=t, channels={"x": count * np.round(x / count), "u": torque})


@pytest.mark.parametrize(("late", "jump"), [(0.0, 0.0), (0.4, 0.0), (-0.3, 0.0), (0.0, 3.0)])
def test_a_joint_has_its_friction_within_its_errors_however_its_torque_acts(late: float, jump: float) -> None:
    """Half a sample and 0.4 more of gravity's 25 N m/rad are 0.09 N m s/rad, a seventh of the damping; of a torque that
    jumps at every sample two central differences of a position would see a tenth less than its mean does.
    """
    problem, _ = prepare(_joint(late, jump), Asked(Restoring.PENDULUM, guarded=True))
    found = stages.fit_base(problem).fit
    errors = np.sqrt(np.diag(found.covariance()))
    truth = {"m": 0.4, "c": 0.6, "k": 25.0, "f_k": 2.0}
    for number, value, error in zip(found.free, found.values, errors, strict=True):
        true = truth[number.name]
        assert abs(value - true) < 3.0 * error
        assert error < 0.01 * true


def test_one_law_of_a_joint_in_another_form_is_one_name() -> None:
    """Friction that falls as exp(-(v/v_s)^0.6), and not with its square, is no drag besides."""
    falling = NAMED("stribeck:free", f_s=3.0, v_s=2.0, exponent=0.6)
    problem, _ = prepare(_joint(0.0, 0.0, falling), Asked(Restoring.PENDULUM, guarded=True))
    assert [m.name for m in diagnose(problem).mechanisms] == ["stribeck"]
