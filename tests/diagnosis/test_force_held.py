"""How a measured force acts between its samples is told beside the law that is left out, not by the base alone."""

from dataclasses import replace

import numpy as np
import pytest

from harness import stages
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.grading.misfit import misfit
from harness.diagnosis.pipeline import diagnose
from harness.diagnosis.prepare.driven import ALL_FELT
from harness.diagnosis.prepare.intersample_hold import ACTS_HELD, held
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.search.search import under
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring


def _pushed(is_held: bool) -> Recording:
    """A free axis under four sines, given every 8 ms, and a constant force that nobody measured."""
    t: FloatArray = np.arange(1500.0) * 8e-3
    random = np.random.default_rng(2)
    phases = random.uniform(0.0, 6.0, 4)
    sines = zip((1.2, 0.8, 0.6, 0.5), (2.0, 4.3, 7.1, 11.0), phases, strict=True)
    u: FloatArray = np.sum([size * np.sin(rate * t + phase) for size, rate, phase in sines], axis=0)
    drive = held(t, u) if is_held else Drive(t, u)
    terms = (ModelTerm.named("constant-force", force=0.06),)
    model = Model(m=1.0, c=1.6, k=0.0, f_k=0.1, restoring=Restoring.NONE, terms=terms)
    x = solve(model, t, drive=drive).x + 4e-4 * random.standard_normal(t.size)
    return Recording(t=t, channels={"x": x, "u": u})


def test_a_held_force_moves_a_slider_as_constant_forces_do_one_after_another() -> None:
    m, f_k, h = 2.0, 0.7, 0.01
    # rests until a step exceeds its friction, slides, stops under a step that is smaller, and goes back
    u: FloatArray = np.repeat([0.6, 3.0, 0.5, -0.6, -2.0, -2.5], 25)
    t: FloatArray = np.arange(u.size + 1.0) * h
    x, v, seen = 0.0, 0.0, [0.0]
    for force in u:
        left = h
        while left > 0.0:
            if v == 0.0 and abs(force) <= f_k:
                break
            a = (force - f_k * np.sign(v or force)) / m
            stops = -v / a if v * a < 0.0 else np.inf
            step = min(left, stops)
            x, v = x + v * step + 0.5 * a * step**2, 0.0 if stops <= left else v + a * step
            left -= step
        seen.append(x)
    model = Model(m=m, c=0.0, k=0.0, f_k=f_k, restoring=Restoring.NONE)
    drive = Drive(t[:-1], u, held=True)
    found = solve(model, t, ("f_k", "m"), drive)
    assert found.x == pytest.approx(np.array(seen), abs=1e-12)
    assert np.max(np.abs(found.x - solve(model, t, drive=drive.straight).x)) > 1e-4
    d = 1e-6
    for q, (less, more, size) in enumerate((
        (replace(model, f_k=f_k * (1.0 - d)), replace(model, f_k=f_k * (1.0 + d)), f_k),
        (replace(model, m=m * (1.0 - d)), replace(model, m=m * (1.0 + d)), m),
    )):  # fmt: skip
        change = solve(more, t, drive=drive).x - solve(less, t, drive=drive).x
        assert found.dx[:, q] == pytest.approx(change / (2.0 * d * size), abs=1e-6)


@pytest.mark.parametrize("is_held", [False, True])
def test_a_force_that_is_left_out_does_not_decide_how_the_drive_acts(is_held: bool) -> None:
    problem = stages.prepare(_pushed(is_held), restoring="none").problem
    assert isinstance(problem, Driven)
    assert not problem.is_held, "the base model is misled: this is what the test is about"
    found = stages.search(stages.fit_base(problem))
    assert isinstance(found.search.problem, Driven)
    assert found.search.problem.is_held is is_held
    assert any(ACTS_HELD in note for note in found.notes) is is_held
    (law,) = found.search.chosen.model.terms
    assert found.search.explained
    assert law.term.name == "constant-force"
    assert law.values[0] == pytest.approx(0.06, abs=2e-3)


def test_the_other_ways_and_back_are_the_same() -> None:
    problem = stages.prepare(_pushed(is_held=False), restoring="none").problem
    assert isinstance(problem, Driven)
    stepped, *_ = problem.other_ways
    assert stepped.is_held
    assert stepped.drive.straight.t[0] - problem.drive.t[0] == pytest.approx(4e-3)
    assert [way.drive for way in stepped.other_ways if way.drive is problem.drive]
    assert {id(way.drive) for way in problem.other_ways} == {id(way) for way in problem.otherwise}


def test_a_force_in_straight_lines_is_told_from_a_smooth_one_by_the_motion() -> None:
    # the samples of this force are those of a smooth one; whoever simulates with them joins them by lines
    t = np.arange(1500.0) / 125.0
    u = 6.0 * np.sin(3.1 * t + 0.3) + 4.0 * np.sin(7.3 * t + 1.1)
    x = solve(Model(2.0, 3.0, 80.0, 1.5), t, drive=Drive(t, u)).x
    x = x + 2e-5 * np.random.default_rng(1).standard_normal(t.size)
    outcome = diagnose(stages.prepare(Recording(t=t, channels={"x": x, "u": u})).problem)
    assert outcome.verdict == "adequate"
    for name, true in (("omega_n", 40.0**0.5), ("zeta", 3.0 / 2.0 / (2.0 * 40.0**0.5)), ("x_k", 1.5 / 80.0)):
        quantity = outcome.base_parameters[name]
        assert quantity.stderr is not None
        assert quantity.value == pytest.approx(true, abs=5.0 * quantity.stderr)


def _in_a_loop(noise: float) -> Recording:
    """A free axis that a loop on encoder counts moves to and fro; the force is recorded with so much noise, N."""
    m, c_loop, f_k, h, count = 2.0, 60.0, 3.0, 2e-3, 2e-6
    random = np.random.default_rng(4)
    t: FloatArray = np.arange(3000.0) * h
    goal = 0.05 * np.sin(2.1 * t) + 0.03 * np.sin(4.7 * t)
    x, v, before, seen, u = 0.0, 0.0, 0.0, np.zeros(t.size), np.zeros(t.size)
    for i in range(t.size):
        seen[i] = count * round(x / count)
        u[i] = m * c_loop**2 * (goal[i] - seen[i]) - 1.6 * m * c_loop * (seen[i] - before) / h
        before, left = seen[i], h
        while left > 0.0 and not (v == 0.0 and abs(u[i]) <= f_k):
            a = (u[i] - f_k * np.sign(v or u[i])) / m
            stops = -v / a if v * a < 0.0 else np.inf
            step = min(left, stops)
            x, v = x + v * step + 0.5 * a * step**2, 0.0 if stops <= left else v + a * step
            left -= step
    return Recording(t=t, channels={"x": seen, "u": u + noise * random.standard_normal(t.size)})


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_the_scatter_of_a_command_is_no_noise_and_what_is_measured_has_its_own(noise: float) -> None:
    prepared = stages.prepare(_in_a_loop(noise), restoring="none")
    based = stages.fit_base(prepared.problem)
    assert isinstance(based.problem, Driven)
    assert based.problem.is_held
    model, force = based.fit.model, based.problem.force_noise
    if noise == 0.0:
        assert force is None
        assert ALL_FELT in prepared.notes
        assert model.f_k == pytest.approx(3.0, rel=1e-4)
    else:
        assert force is not None
        assert force.noise.sigma == pytest.approx(noise, rel=0.45)  # levels are twofold apart
        assert model.f_k == pytest.approx(3.0, rel=1e-2)
        # a grade sees the recording under the same noise as the test
        graded = misfit(based.problem, based.fit, based.scales)
        again = under(graded.base, graded.sensed(graded.noise_left(graded.base)))
        assert again.chi2 == pytest.approx(based.fit.chi2, rel=1e-2)
