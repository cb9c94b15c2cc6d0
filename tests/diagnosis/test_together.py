"""Several recordings of one machine: one set of physics, a start, a zero, a clock and a noise for each."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.explain.next_experiment import releases
from harness.diagnosis.fit.standard_errors import base_parameters
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.parameters import free_of, values_of, with_values
from harness.diagnosis.pipeline import diagnose, fit_base, prepare, prepare_together
from harness.diagnosis.pooling.pooled import shared_by
from harness.diagnosis.prepare.free_decay import said_once
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.problems.together import Together
from harness.diagnosis.request import Asked
from harness.diagnosis.residual_tests.lack_of_fit import lack_of_fit
from harness.diagnosis.rules import AMPLITUDES_APART, POOLED
from harness.diagnosis.search.extend import extend
from harness.estimate.noise import Noise
from harness.kernels.solve import solve
from harness.model.elsewhere import Elsewhere, parted
from harness.model.model import Model, ModelTerm
from harness.model.registry import term

BASE = Model(1.0, 0.25, 100.0, 0.35)
"""omega_n 10 rad/s, zeta 0.0125, x_k 3.5 mm."""
TRUTH = {"omega_n": 10.0, "zeta": 0.0125, "x_k": 0.0035}
ASKED = Asked(zero_free=True)


def seen(model: Model, x0: float, zero: float, sigma: float, seed: int, until: float = 7.0) -> Recording:
    """A release from x0 (m), read with an offset and white noise (m)."""
    t = np.linspace(0.0, until, int(130 * until))
    noise = sigma * np.random.default_rng(seed).standard_normal(t.size)
    return Recording(t, {"x": solve(replace(model, x0=x0), t).x + zero + noise}, f"from-{1e3 * x0:.0f}-mm.csv")


def pair(model: Model, other: Model | None = None) -> list[Recording]:
    """From 100 mm and from 40 mm, each with a zero and a noise of its own."""
    return [seen(model, 0.1, 0.01, 2e-4, 1), seen(other or model, 0.04, -0.02, 1e-4, 2, until=4.0)]


def together(recordings: list[Recording]) -> Together:
    problem = prepare_together(recordings, ASKED)[0]
    assert isinstance(problem, Together)
    return problem


def names(outcome: Outcome) -> dict[str, list[str]]:
    """What is named, and what could stand in its place."""
    return {m.name: [a.name for a in m.alternatives] for m in outcome.mechanisms}


@pytest.fixture(scope="module")
def alike() -> Together:
    return together(pair(BASE))


def test_each_is_simulated_from_its_own_start_on_its_own_clock(alike: Together) -> None:
    """A stiffness that drifts with time begins anew with each recording."""
    drifting = BASE.with_terms(ModelTerm.named("stiffness-drift", rate=-0.01))
    elsewhere = (Elsewhere((("offset", -0.02), ("x0", 0.04), ("v0", 0.1), ("k", 90.0))),)
    model = replace(drifting, x0=0.1, offset=0.01, elsewhere=elsewhere)
    shown = observe(model, alike).y["x"]
    first, second = alike.alone
    one = solve(replace(drifting, x0=0.1), first.t).x + 0.01
    other = solve(replace(drifting, x0=0.04, v0=0.1, k=90.0), second.t).x - 0.02
    assert shown == pytest.approx(np.concatenate((one, other)), abs=1e-8)


def test_partials_are_those_of_differences(alike: Together) -> None:
    model = replace(BASE, x0=0.1, elsewhere=(Elsewhere((("offset", 0.0), ("x0", 0.04), ("v0", 0.0), ("m", 1.1))),))
    free = free_of(model, ("c", "k", "x0", "offset", "x0#2", "v0#2", "offset#2", "m#2"))
    shown = observe(model, alike, tuple(f.by for f in free)).dy["x"]
    for i, f in enumerate(free):
        step = 1e-6 * max(1.0, abs(values_of(model, (f,))[0]))
        ends = [
            observe(with_values(model, (f,), values_of(model, (f,)) + sign * step), alike).y["x"] for sign in (1, -1)
        ]
        # beside a reversal a difference straddles the jump of the acceleration
        assert np.median(np.abs(shown[:, i] - (ends[0] - ends[1]) / (2.0 * step))) < 1e-5
        if f.name in ("x0", "offset"):
            assert not np.any(shown[alike.places[1], i])
        if parted(f.name)[1] == 1:
            assert not np.any(shown[alike.places[0], i])


def test_no_sample_knows_of_another_recording(alike: Together) -> None:
    """Whitening takes each recording by itself, at its own level."""
    noise = {"x": Noise(1e-3, True, phi=0.6)}
    coloured = replace(alike, noise=noise)
    values = np.random.default_rng(0).standard_normal(alike.t.size)
    by_hand = [one.noise["x"].whitened(values[at]) for one, at in zip(coloured.alone, coloured.places, strict=True)]
    assert coloured.whitened({"x": values})["x"] == pytest.approx(np.concatenate(by_hand))


@pytest.mark.parametrize("size", [2, 5])
def test_in_means_each_still_begins_at_its_release(alike: Together, size: int) -> None:
    """The first mean lies some samples after the release, from where the motion is followed all the same."""
    model = replace(BASE, x0=0.1, elsewhere=(Elsewhere((("offset", 0.0), ("x0", 0.04), ("v0", 0.0))),))
    shown = observe(model, alike).y
    small, _ = replace(alike, channels=shown).condensed(shown, size)
    assert [s.t0 for s in small.starts.stretches] == [s.t0 for s in alike.starts.stretches]
    assert small.t.size == sum((s.stop - s.start) // size for s in alike.starts.stretches)
    # what the model leaves of its own motion is nothing, whatever the samples
    assert small.channels["x"] == pytest.approx(observe(model, small).y["x"], abs=1e-8)


def test_a_weak_law_is_not_asked_for_speeds_of_releases_at_rest() -> None:
    """Beside a base that begins at rest in every recording a law does too: its evidence is what it says alone."""
    dragged = BASE.with_terms(ModelTerm.named("quadratic-drag", c2=0.02))
    problem = together([seen(dragged, x0, 0.0, 1e-4, i) for i, x0 in enumerate((0.1, 0.08, 0.06, 0.05, 0.04))])
    based = fit_base(problem)
    (drag,) = extend(based.fit, based.problem, based.scales, (term("quadratic-drag"),)).fits
    speeds = [[f.name for f in one.free if parted(f.name)[0] == "v0"] for one in (based.fit, drag)]
    assert speeds == [[], []]
    # a twelfth of the damping at most, which one number tells
    assert len(drag.free) == len(based.fit.free) + 1
    assert drag.bic < based.fit.bic


def test_the_physics_is_that_of_both_and_the_rest_each_ones_own(alike: Together) -> None:
    based = fit_base(alike)
    found = base_parameters(based.fit, based.problem, based.scales.omega, explained=True)
    for name, true in TRUTH.items():
        value, error = found[name].value, found[name].stderr
        assert value is not None
        assert error is not None
        assert abs(value - true) < 4.0 * error
    first, second = based.fit.model.of_recording(0), based.fit.model.of_recording(1)
    assert (first.x0, second.x0) == pytest.approx((0.1, 0.04), abs=2e-4)
    assert (first.offset, second.offset) == pytest.approx((0.01, -0.02), abs=5e-5)


def test_evidence_adds_up() -> None:
    """Two releases alike know everything to 1/sqrt(2) of the error of one."""
    each = [seen(BASE, 0.1, 0.01 * i, 2e-4, i) for i in (1, 2)]
    both = fit_base(together(each))
    one = fit_base(prepare(each[0], ASKED)[0])
    read = [base_parameters(b.fit, b.problem, b.scales.omega, explained=True) for b in (one, both)]
    for name in TRUTH:
        alone, shared = (r[name].stderr for r in read)
        assert alone is not None
        assert shared is not None
        assert shared / alone == pytest.approx(1.0 / np.sqrt(2.0), rel=0.1)


def test_one_machine_is_pooled(alike: Together) -> None:
    outcome = diagnose(alike)
    assert outcome.verdict == "adequate"
    assert outcome.pooled is not None
    assert outcome.pooled.compared.chance > POOLED.value
    assert outcome.pooled.own == ()
    assert "pooled" in outcome.problem.choices[0]


def test_damping_that_differs_much_is_each_ones_own() -> None:
    """From where all are alike no fit of several gets there: each begins where it ends alone."""
    machines = [replace(BASE, c=c) for c in (0.09, 0.15, 0.29)]
    based = fit_base(together([seen(one, 0.1 - 0.01 * i, 0.0, 2e-4, i, until=8.0) for i, one in enumerate(machines)]))
    found = shared_by(based.problem, based.fit, based.scales)
    assert found.own[0] == "c"
    assert found.base.chi2 < 1.1 * found.base.points


@pytest.fixture(scope="module")
def drifting() -> list[Recording]:
    """The stiffness falls by 0.2 % a second, which one decay does not tell from a softening spring."""
    return pair(BASE.with_terms(ModelTerm.named("stiffness-drift", rate=-0.002)))


def test_a_second_amplitude_parts_what_one_decay_cannot(drifting: list[Recording]) -> None:
    alone = diagnose(prepare(drifting[0], ASKED)[0])
    # a law of the time and one of the amplitude are listed, before the force in step with the swing that follows any
    # other; one of them is left by a second amplitude
    assert alone.verdict == "one_of"
    assert next(iter(names(alone))) == "stiffness-drift"
    assert {"cubic-stiffness", "clock-drift"} <= set(names(alone))
    assert names(diagnose(together(drifting))) == {"stiffness-drift": []}
    # it was said, with the amplitude to release from
    assert "let it go from 0.2 m" in alone.next_experiment
    assert "--together" in alone.next_experiment


def test_a_model_is_nowhere_apart_from_itself(alike: Together) -> None:
    """Whatever it is let go from; from another stiffness the further release tells more."""
    based = fit_base(alike)
    own = releases(based.fit, based.fit, based.problem, based.scales)
    assert {one.factor for one in own} == {0.25, 0.35, 0.5, 0.7, 1.4, 2.0}
    # as near as coarse steps with and without partials come
    assert max(one.apart for one in own) < 1e-4
    bent = replace(based.fit, model=based.fit.model.with_terms(ModelTerm.named("cubic-stiffness", k3=300.0)))
    by_factor = {one.factor: one.apart for one in releases(bent, based.fit, based.problem, based.scales)}
    assert by_factor[2.0] > by_factor[1.4] > by_factor[0.5]


def test_from_one_amplitude_no_law_of_it_is_told_from_one_of_time() -> None:
    same = together([seen(BASE, 0.1, 0.0, 1e-4, i, until=4.0) for i in (1, 2)])
    other = together(pair(BASE))
    assert not same.parts_amplitude_from_time
    assert other.parts_amplitude_from_time
    assert not other.alone[0].parts_amplitude_from_time
    assert 1.0 < AMPLITUDES_APART.value < 2.5


def test_channels_that_not_all_have_are_left_out_and_said() -> None:
    first, second = pair(BASE)
    with_speed = replace(first, channels={**first.channels, "v": np.gradient(first["x"], first.t)})
    problem, notes = prepare_together([with_speed, second], ASKED)
    assert list(problem.channels) == ["x"]
    assert any("v is not used" in note for note in notes)


def driven() -> Recording:
    one = seen(BASE, 0.1, 0.0, 1e-4, 1)
    return replace(one, channels={**one.channels, "u": np.sin(one.t)}, file="driven.csv")


def speed_alone() -> Recording:
    one = seen(BASE, 0.1, 0.0, 1e-4, 1)
    return replace(one, channels={"v": np.gradient(one["x"], one.t)}, file="speed.csv")


def later() -> Recording:
    one = seen(BASE, 0.1, 0.0, 1e-4, 1)
    return replace(one, t=one.t + 7.0, file="later.csv")


REFUSED: list[tuple[list[Recording], str]] = [
    ([seen(BASE, 0.1, 0.0, 1e-4, 1)], "from-100-mm.csv alone; expected two recordings of one machine or more"),
    (
        [seen(BASE, 0.1, 0.0, 1e-4, 1), driven()],
        "driven.csv is driven and from-100-mm.csv a free decay; expected free decays",
    ),
    ([seen(BASE, 0.1, 0.0, 1e-4, 1), speed_alone()], "with a channel in common"),
    ([seen(BASE, 0.1, 0.0, 1e-4, 1), replace(seen(BASE, 0.1, 0.0, 1e-4, 2), angular=True)], "turns"),
    ([seen(BASE, 0.1, 0.0, 1e-4, 1), later()], "from-100-mm.csv and later.csv hold the same motion, sample for sample"),
]


@pytest.mark.parametrize("zeros", [(0.02, 0.0), (0.0, 0.02)])
def test_where_one_asks_for_a_zero_all_get_one(zeros: tuple[float, float]) -> None:
    """A repetition whose encoder happens to begin near nought says nothing of the zeros of the others."""
    recordings = [seen(BASE, 0.05, zero, 1e-4, seed, until=4.0) for seed, zero in enumerate(zeros)]
    problem, notes = prepare_together(recordings, Asked())
    assert problem.zero_free
    assert all(one.zero_free for one in problem.alone)
    assert any("zero" in note for note in notes)


@pytest.mark.parametrize(("recordings", "why"), REFUSED)
def test_what_cannot_be_together_is_refused(recordings: list[Recording], why: str) -> None:
    with pytest.raises(InputError, match=why):
        prepare_together(recordings, ASKED)


def test_a_residual_of_any_length_is_tested() -> None:
    """The least at which a line in the spectrum is looked for is one whole row of its surroundings."""
    for n in (127, 128, 129, 130):
        white: FloatArray = np.random.default_rng(n).standard_normal(n)
        assert 0.0 < lack_of_fit({"x": white}, np.linspace(0.0, 4.0, n), 10.0).p_value <= 1.0


def test_what_was_done_to_several_alike_is_said_once() -> None:
    first, rest = "the first 0.2 s, before the release, are skipped", "the last {} s, a long rest, are skipped"
    notes = [("a2.csv", first), ("a2.csv", rest.format("2.97")), ("b.csv", rest.format("12.4")), ("b.csv", first)]
    assert said_once([*notes, ("c.csv", rest.format("3")), ("c.csv", "x is not used")], 3) == (
        "in a2.csv and b.csv: the first 0.2 s, before the release, are skipped",
        "in each of the recordings: the last 2.97 to 12.4 s, a long rest, are skipped",
        "in c.csv: x is not used",
    )
