"""Tables of a driven recording: forces of no catalogue are found, what is the base's is not, drifts get no plane."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from benchmarks.calibrate.force_tables import Moved, left_of, moved
from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.grading.prediction import ratio
from harness.diagnosis.parameters import base_of
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.problems.together import Together
from harness.diagnosis.tables.basis import RUNGS, Rung, basis_of, over_plane, partials
from harness.diagnosis.tables.beside import ForceLeft, comes_back, returns
from harness.diagnosis.tables.describe import plane_described
from harness.diagnosis.tables.drawn import surface_of, table_of
from harness.diagnosis.tables.fitted import TableFit
from harness.estimate.noise import Noise
from harness.model.covariate import Acts, Covariate
from harness.model.model import beyond
from harness.model.spline import SIDE

SEED, MAGNET, DAMPING = 2, 4, 2
"""Draws with a magnet along the way, and with damping that depends on the place."""
(PLANE,) = over_plane(())
BY_PLACE = next(r for r in RUNGS if r.said == "f(x)")


@cache
def seen(index: int) -> tuple[Moved, ForceLeft]:
    machine = moved(SEED, index)
    return machine, left_of(machine)[0]


@cache
def fitted(index: int, rung: Rung) -> TableFit:
    found = seen(index)[1].fitted(rung)
    assert found is not None
    return found


def test_a_force_of_no_catalogue_is_found_along_the_way() -> None:
    machine, left = seen(MAGNET)
    found, before = fitted(MAGNET, BY_PLACE), left.predicted()
    after = left.held_out(found)
    assert before is not None
    assert ratio(after, before) < 0.1
    assert found.effective <= left.words.words / 3.0
    assert found.model.m == pytest.approx(machine.model.m, rel=0.01)
    assert found.model.f_k == pytest.approx(machine.model.f_k, rel=0.05)
    table = table_of(found, left.words.pieces, left.scales, (0,), "f(x)", ratio(after, before))
    assert machine.law is not None
    true = machine.law(table.at, np.zeros(table.at.size))
    # on a free axis nothing else says a force of the place
    assert table.gauge == ()
    assert np.mean(np.abs(true - table.force) <= 2.0 * table.stderr) > 0.9
    x, v = left.motion
    assert table.at[0] <= x.min() < x.max() <= table.at[-1]
    assert np.ptp(table.at) < 1.03 * np.ptp(x)
    assert v.size == x.size


def test_what_is_held_out_lies_within_what_was_seen() -> None:
    left = seen(MAGNET)[1]
    for y in (
        left.problem.measured.blocks(left.problem.measured.x),
        left.problem.measured.blocks(left.problem.measured.v),
    ):
        out = left.block >= 0
        assert y[~out].min() <= y[out].min()
        assert y[~out].max() >= y[out].max()
    # whole pieces of strokes, numbered without a gap
    assert set(np.unique(left.block).tolist()) == set(range(-1, int(left.block.max()) + 1))
    for piece in range(left.words.pieces.count):
        assert np.unique(left.block[left.words.pieces.of == piece]).size == 1


def test_the_plane_holds_nothing_that_a_sum_says() -> None:
    left = seen(DAMPING)[1]
    x, v = left.motion
    basis = basis_of(PLANE, left.start.model, base_of(left.start.free), x, v, left.scales)
    moving = np.flatnonzero(v != 0.0)
    at = moving[:: max(1, moving.size // 600)]
    columns = partials(basis.model, 0, x[at], v[at], left.scales)
    held = columns @ basis.free
    square = columns.reshape(-1, SIDE, SIDE)
    for f in (*square.sum(axis=1).T, *square.sum(axis=2).T, np.sign(v[at])):
        assert np.abs(f @ held).max() < 1e-8 * np.linalg.norm(f) * np.linalg.norm(held, axis=0).max()
    assert basis.free.shape[1] == SIDE * SIDE - (2 * SIDE - 1) - 1


def test_the_level_of_a_given_force_is_not_the_tables() -> None:
    left = seen(MAGNET)[1]
    x, v = left.motion
    base, given = base_of(left.start.free), Covariate("P", Acts.FORCE, 1.0, 0.0, "bar")
    for covariates, own in (((), 0), ((given,), 1), ((replace(given, levelled=False),), 0)):
        model = replace(left.start.model, covariates=covariates)
        basis = basis_of(BY_PLACE, model, base, x, v, left.scales)
        moving = np.flatnonzero(v != 0.0)
        at = moving[:: max(1, moving.size // 600)]
        held = partials(basis.model, 0, x[at], v[at], left.scales) @ basis.free
        constant = np.abs(held.mean(axis=0)).max() / np.abs(held).max()
        assert held.shape[1] == basis.free.shape[0] - own
        assert (constant < 1e-9) == bool(own)


def test_damping_by_place_is_taken_by_the_plane_and_by_no_sum() -> None:
    left = seen(DAMPING)[1]
    before = left.predicted()
    assert before is not None
    total = next(r for r in RUNGS if r.said == "f(x) + f(v)")
    # as it takes nothing off, what it would predict is not even looked at
    assert left.held_out(fitted(DAMPING, total)) is None
    found = fitted(DAMPING, PLANE)
    after = left.held_out(found)
    assert ratio(after, before) < 0.2
    surface = surface_of(found, left.words.pieces, left.scales, 0, ratio(after, before), False)
    machine = seen(DAMPING)[0]
    assert machine.law is not None
    x, v = np.meshgrid(surface.x, surface.v)
    true = machine.law(x.ravel(), v.ravel()).reshape(x.shape)
    # beside what sums say, by the motion's own weights: here by what both have in common
    left_of_sum = twice_centred(true, surface.known) - twice_centred(surface.force, surface.known)
    size = np.std(twice_centred(true, surface.known)[surface.known])
    assert np.std(left_of_sum[surface.known]) < 0.35 * size
    assert 0.3 < np.mean(surface.known) < 1.0
    assert "resistance" in surface.described


def twice_centred(force: FloatArray, known: BoolArray) -> FloatArray:
    """A force over a grid less the best sum of one of its rows and one of its columns."""
    k, m = force.shape
    rows, columns = np.nonzero(known)
    a = np.zeros((rows.size, k + m))
    a[np.arange(rows.size), rows] = 1.0
    a[np.arange(rows.size), k + columns] = 1.0
    part = np.linalg.lstsq(a, force[known], rcond=None)[0]
    return np.asarray(force - part[:k, None] - part[None, k:])


def test_a_run_that_leaves_the_oval_says_so() -> None:
    left = seen(DAMPING)[1]
    model = fitted(DAMPING, PLANE).model
    x, v = left.motion
    assert beyond(model, x, v) == []
    (words,) = beyond(model, 1.3 * x, v)
    assert "tabulated-force is known over an oval of x and v" in words


def decay(left: float, cycles: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    phase = np.linspace(0.0, 2.0 * np.pi * cycles, 4000)
    x = np.exp(np.log(left) * phase / phase[-1]) * np.cos(phase)
    return phase, x, np.gradient(x, phase)


@pytest.mark.parametrize("left", [0.6, 0.3, 0.1])
@pytest.mark.parametrize("cycles", [8.0, 30.0])
def test_a_motion_that_fades_does_not_come_back(left: float, cycles: float) -> None:
    assert not comes_back(*decay(left, cycles))


def test_waves_come_back_and_what_stands_does_not() -> None:
    t = np.linspace(0.0, 60.0, 6000)
    x = np.sin(2.0 * t) + 0.6 * np.sin(3.7 * t + 1.0) + 0.4 * np.sin(7.9 * t)
    assert comes_back(t, x, np.gradient(x, t))
    grown = t * x
    assert not comes_back(t, grown, np.gradient(grown, t))
    assert not comes_back(t, np.zeros(t.size), np.zeros(t.size))


def free_decay(amplitude: float) -> FreeDecay:
    t = np.linspace(0.0, 20.0, 2000)
    return FreeDecay(t, {"x": amplitude * np.exp(-0.02 * t) * np.cos(3.0 * t)}, {"x": Noise(1e-4, True)})


def test_a_free_decay_never_gets_a_plane_and_two_amplitudes_do() -> None:
    one, other = free_decay(1.0), free_decay(0.4)
    x, v = one.channels["x"], np.gradient(one.channels["x"], one.t)
    # slow as it is, and back in every cell
    assert not returns(one, x, v)
    alike, apart = Together.laid([one, free_decay(0.9)]), Together.laid([one, other])
    for both, again in ((alike, False), (apart, True)):
        x = both.channels["x"]
        assert returns(both, x, np.gradient(x, both.t)) is again


@pytest.mark.parametrize(
    ("force", "words"),
    [
        (lambda x, v: x * v, "a resistance that depends on the place too, more than elsewhere about x = 1 m"),
        (lambda x, v: x * v**2, "the same in both directions"),
        (lambda x, v: x * v + 0.7 * x * v**2, "a force that no sum"),
        (lambda x, v: 0.0 * x, "nothing stands out"),
    ],
)
def test_a_plane_is_said_in_words(force: object, words: str) -> None:
    assert callable(force)
    side = np.linspace(-1.0, 1.0, 21)
    x, v = np.meshgrid(side, side)
    assert words in plane_described(side, side, force(x, v), np.ones(x.shape, dtype=np.bool_), "m")
