"""Several driven recordings of one machine: one regression of all their forces, and what differs between them."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from harness.app.shared.reading import ReadOptions, read
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.inverse_dynamics.prepare import forces_together
from harness.diagnosis.inverse_dynamics.strokes import force_words
from harness.diagnosis.parameters import Free, free_of
from harness.diagnosis.pipeline import prepare_together
from harness.diagnosis.pooling.forces import shared_forces
from harness.diagnosis.pooling.pooled import Pooled, differences
from harness.diagnosis.problems.forces_together import ForcesTogether
from harness.diagnosis.problems.measured import BLOCK, Measured
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.request import Asked
from harness.diagnosis.rules import POOLED
from harness.kernels.solve import Drive, Scales, solve
from harness.model.model import Model, ModelTerm, Restoring

AXIS = Model(2.0, 3.0, 0.0, 1.5, restoring=Restoring.NONE)
SPRUNG = Model(2.0, 3.0, 80.0, 1.5)
WAVES = (((6.0, 3.1, 0.3), (4.0, 7.3, 1.1), (3.0, 14.0, 2.0)), ((5.0, 2.3, 1.3), (5.0, 6.1, 0.1), (3.0, 11.0, 1.0)))
NOISE = 0.1
"""Of the force, N."""


def seen(model: Model, which: int, n: int = 2000, zero: float = 0.0, seed: int | None = None) -> Recording:
    """A model under one of two drives, read to 2 micrometres; on a spring from a zero (m)."""
    draw, t = np.random.default_rng(100 + which if seed is None else seed), np.arange(n) / 250.0
    u: FloatArray = np.sum([a * np.sin(w * t + p) for a, w, p in WAVES[which]], axis=0)
    x = solve(model, t, drive=Drive(t, u)).x + zero + 2e-6 * draw.standard_normal(n)
    return Recording(t, {"x": x, "u": u + NOISE * draw.standard_normal(n)}, f"drive-{which}.csv")


def pair(model: Model, other: Model | None = None) -> list[Recording]:
    zero = 0.0 if model.restoring is Restoring.NONE else 0.003
    return [seen(model, 0), seen(other or model, 1, 1504, zero)]


def together(recordings: Sequence[Recording], restoring: Restoring) -> ForcesTogether:
    problem, _ = prepare_together(recordings, Asked(restoring))
    assert isinstance(problem, ForcesTogether)
    return problem


@cache
def pooled(base: Model, **other: float) -> Pooled[ForcesTogether]:
    second = replace(base, **other)  # type: ignore[arg-type]
    return shared_forces(together(pair(base, second), base.restoring))


def ratio(found: Pooled[ForcesTogether]) -> tuple[float, float]:
    (one,) = differences(found.base, found.problem, found.scales.omega, True)[1]
    assert one.ratio.value is not None
    assert one.ratio.stderr is not None
    return one.ratio.value, one.ratio.stderr


@pytest.mark.parametrize("base", [AXIS, SPRUNG], ids=["axis", "spring"])
def test_one_machine_under_two_drives_is_pooled(base: Model) -> None:
    found = pooled(base)
    assert found.own == ()
    assert found.compared.chance > POOLED.value
    numbers = {f.name: (found.base.values[i], s) for i, (f, s) in enumerate(_errors(found))}
    for name in ("m", "c", "f_k", *(("k",) if base.k else ())):
        value, error = numbers[name]
        assert abs(value - getattr(base, name)) < 4.0 * error < 0.1 * getattr(base, name), name
    if base.k:
        for name, zero in (("offset", 0.0), ("offset#2", 0.003)):
            assert abs(numbers[name][0] - zero) < 4.0 * numbers[name][1]


def _errors(found: Pooled[ForcesTogether]) -> list[tuple[Free, float]]:
    errors = np.sqrt(np.diag(found.base.covariance())).tolist()
    return list(zip(found.base.free, errors, strict=True))


DIFFERENT = [(AXIS, "m", 1.1), (SPRUNG, "f_k", 0.8), (SPRUNG, "c", 1.2)]
"""A payload, a warmer machine, another damping."""


@pytest.mark.parametrize(("base", "name", "factor"), DIFFERENT)
def test_what_differs_is_named_and_sized(base: Model, name: str, factor: float) -> None:
    found = pooled(base, **{name: factor * getattr(base, name)})
    assert found.own == (name,)
    value, error = ratio(found)
    assert abs(value - factor) < 3.0 * error < abs(factor - 1.0)


def test_the_order_of_files_changes_nothing() -> None:
    each = pair(AXIS, replace(AXIS, m=2.2))
    there, back = (shared_forces(together(files, AXIS.restoring)) for files in (each, each[::-1]))
    assert there.own == back.own == ("m",)
    assert there.base.chi2 == pytest.approx(back.base.chi2)
    assert ratio(there)[0] * ratio(back)[0] == pytest.approx(1.0, rel=1e-6)
    assert there.compared.chance == pytest.approx(back.compared.chance, rel=1e-6)
    for name in ("c", "f_k"):
        assert getattr(there.base.model, name) == pytest.approx(getattr(back.base.model, name), rel=1e-6)


def test_errors_shrink_as_the_root_of_the_data() -> None:
    """Four recordings under the same drive, each with a noise of its own, know each number twice as well as one."""
    each = [seen(AXIS, 0, seed=i) for i in range(4)]
    one = shared_forces(together(each[:2], AXIS.restoring)).compared.alone[0].fit
    four = shared_forces(together(each, AXIS.restoring)).base
    alone, shared = (np.sqrt(np.diag(found.covariance())) for found in (one, four))
    assert np.median(alone / shared) == pytest.approx(2.0, rel=0.25)


def test_of_a_noisier_recording_less_counts() -> None:
    quiet, loud = seen(AXIS, 0), seen(AXIS, 1)
    loud = replace(loud, channels={**loud.channels, "u": loud["u"] + np.random.default_rng(7).standard_normal(2000)})
    found = shared_forces(together([quiet, loud], AXIS.restoring))
    low, high = found.problem.levels
    assert high / low == pytest.approx(math.hypot(1.0, NOISE) / NOISE, rel=0.25)
    only = shared_forces(together([quiet, seen(AXIS, 0, seed=3)], AXIS.restoring)).compared.alone[0].fit
    for name, value, error in zip(("m", "c", "f_k"), only.values, np.sqrt(np.diag(only.covariance())), strict=True):
        assert abs(getattr(found.base.model, name) - value) < error


def test_nothing_reaches_over_the_seam() -> None:
    """Each recording is smoothed by itself, on whole blocks, and no stroke goes from one to the next."""
    first, second = seen(AXIS, 0, 1507), seen(AXIS, 1, 1204)
    problem = together([first, second], AXIS.restoring)
    assert [at.stop - at.start for at in problem.places] == [1500, 1200]
    measured = Measured.of(problem)
    for own, alone in zip(measured.each, problem.each, strict=True):
        by_itself = Measured.of(alone)
        for name in ("t", "x", "v", "a", "u", "moving"):
            np.testing.assert_allclose(getattr(own, name), getattr(by_itself, name), atol=1e-12)
    for w in problem.starts.windows:
        assert any(at.start <= w.start < w.stop <= at.stop for at in problem.places)
    base = fit(problem.first, problem, free_of(problem.first, problem.base_names))
    (seam,) = base.seams or ()
    assert seam == np.count_nonzero(measured.moving[: 1500 // BLOCK])
    pieces = force_words(base.memory, measured).pieces
    assert pieces.of[seam] != pieces.of[seam - 1]


def test_a_law_of_time_begins_anew_with_each_recording() -> None:
    drifting = AXIS.with_terms(ModelTerm.named("friction-drift", rate=0.05))
    each = [seen(drifting, 0), seen(drifting, 1)]
    problem = together(each, AXIS.restoring)
    model = replace(drifting, elsewhere=problem.first.elsewhere)
    shown = observe(model, problem, (), Scales(0.1, 1.0, 3.0)).x
    for at, one in zip(problem.places, each, strict=True):
        assert float(np.std(shown[at] - one["x"])) < 0.01 * float(np.std(one["x"]))


def test_what_was_not_measured_moves_as_its_own_force_pushed_it() -> None:
    """The force of each recording acts in its own windows, not that of the first."""
    problem = together(pair(SPRUNG), SPRUNG.restoring)
    model = replace(SPRUNG, elsewhere=tuple(one.having(offset=0.003) for one in problem.first.elsewhere))
    shown = observe(model, problem, (), Scales(0.1, 1.0, 6.0)).y["x"]
    for at in problem.places:
        y = problem.channels["x"][at]
        assert float(np.std(shown[at] - y)) < 0.02 * float(np.std(y))


def resting() -> Recording:
    one = seen(AXIS, 0)
    return replace(one, channels={**one.channels, "x": 1e-6 * np.random.default_rng(1).standard_normal(one.t.size)})


def decay() -> Recording:
    one = seen(SPRUNG, 0)
    return replace(one, channels={"x": one["x"]}, file="decay.csv")


def speed() -> Recording:
    one = seen(AXIS, 1)
    return replace(one, channels={"v": np.gradient(one["x"], one.t), "u": one["u"]}, file="speed.csv")


def position() -> Recording:
    return replace(seen(AXIS, 0), file="position.csv")


REFUSED: list[tuple[list[Recording], str]] = [
    ([seen(AXIS, 0)], "drive-0.csv alone; expected two recordings of one machine or more"),
    ([seen(AXIS, 0), decay()], "drive-0.csv is driven and decay.csv a free decay; .*not both"),
    ([position(), speed()], "position.csv has x, speed.csv has v; expected recordings with a channel in common"),
    ([seen(AXIS, 0), replace(seen(AXIS, 1), angular=True)], "drive-1.csv turns, drive-0.csv slides"),
    ([seen(AXIS, 1), resting()], "a slider that does not move beyond its noise"),
]


@pytest.mark.parametrize(("recordings", "why"), REFUSED)
def test_what_cannot_be_together_is_refused(recordings: list[Recording], why: str) -> None:
    with pytest.raises(InputError, match=why):
        prepare_together(recordings, Asked(Restoring.NONE))


def test_channels_that_not_all_have_are_left_out_and_said() -> None:
    first, second = pair(AXIS)
    with_speed = replace(first, channels={**first.channels, "v": np.gradient(first["x"], first.t)})
    problem, notes = forces_together([with_speed, second], Asked(AXIS.restoring))
    assert list(problem.channels) == ["x"]
    assert any("v is not used" in note for note in notes)


@pytest.mark.full
def test_two_trajectories_of_a_real_axis_are_pooled(recordings: Path) -> None:
    """The drive-axis benchmark (Janot, Gautier, Brunot 2019), of whose one recording numbers are published."""
    columns = ReadOptions("t=t,x=qm,u=vir*gtau[N]")
    each = [read(recordings / "emps" / name, columns) for name in ("DATA_EMPS.mat", "DATA_EMPS_PULSES.mat")]
    found = shared_forces(together(each, Restoring.NONE))
    assert found.own == ()
    for name, published in (("m", 95.11), ("c", 203.5), ("f_k", 20.39)):
        assert getattr(found.base.model, name) == pytest.approx(published, rel=0.05)
