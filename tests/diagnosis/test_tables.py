"""Forces without a name: tables find a law that no catalogue has, and nothing where there is none."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.explain.sentences import sentence_of
from harness.diagnosis.grading.misfit import Misfit, misfit
from harness.diagnosis.grading.prediction import blocks_of, held_out, ratio
from harness.diagnosis.outcome import Grade, Table
from harness.diagnosis.parameters import base_of, free_of
from harness.diagnosis.pipeline import explain, judge
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.problems.simulated import COARSE
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.search.search import Search
from harness.diagnosis.stages import Found
from harness.diagnosis.tables.basis import RUNGS, Basis, basis_of, partials
from harness.diagnosis.tables.beside import MotionLeft
from harness.diagnosis.tables.describe import described, gauge_of
from harness.diagnosis.tables.drawn import table_of, ungauged
from harness.diagnosis.tables.fitted import Blocks, TableFit, minimised
from harness.estimate.noise import Noise
from harness.kernels.solve import simulate
from harness.model.model import Model, ModelTerm
from harness.model.registry import TERMS
from harness.model.spline import KNOTS
from harness.model.term import Slot

BASE = Model(1.0, 0.25, 40.0, 0.05, x0=1.0)
T = np.linspace(0.0, 14.0, 1200)
SIGMA = 2e-4
BY_PLACE = next(t for t in TERMS if t.known is not None and t.known.of == "x" and t.slot is Slot.SMOOTH)


def well(x: FloatArray) -> FloatArray:
    """A magnet about x = 0.3."""
    return np.asarray(1.2 * (x - 0.3) / 0.25 * np.exp(0.5 - 0.5 * ((x - 0.3) / 0.25) ** 2))


def problem_of(model: Model, more: FloatArray | float = 0.0) -> FreeDecay:
    noise = SIGMA * np.random.default_rng(4).standard_normal(T.size)
    return FreeDecay(T, {"x": simulate(model, T).x + noise + more}, {"x": Noise(SIGMA, True)}, zero_free=True)


def misfit_of(problem: FreeDecay) -> Misfit:
    base, scales = baseline(problem)
    return misfit(problem, base, scales)


@cache
def magnet() -> Misfit:
    knots = np.linspace(-1.1, 1.1, KNOTS)
    return misfit_of(problem_of(BASE.with_terms(ModelTerm(BY_PLACE, (*well(knots).tolist(), -1.1, 1.1)))))


@cache
def fitted_magnet() -> TableFit:
    one, model = basis(), basis().model
    look = left_of(magnet()).seeing(one)(model, free(), None, COARSE)
    return minimised(one, model, np.zeros(one.free.shape[1]), free(), look, 1e-3)


def left_of(seen: Misfit) -> MotionLeft:
    return MotionLeft(seen, seen.base.model, base_of(seen.base.free))


def free() -> tuple:  # type: ignore[type-arg]
    return free_of(magnet().base.model, base_of(magnet().base.free))


@cache
def basis(said: str = "f(x)") -> Basis:
    seen = magnet()
    rung = next(r for r in RUNGS if r.said == said)
    shown = seen.base.shown
    return basis_of(rung, seen.base.model, base_of(seen.base.free), shown.x, shown.v, seen.scales)


def test_a_law_of_no_catalogue_is_found_with_its_place() -> None:
    seen = magnet()
    before = held_out(seen.base, seen.problem, seen.scales, seen.strokes)
    assert before is not None
    kept = left_of(seen).tabulated(before)
    assert kept[0].rung.said == "f(x)"
    assert ratio(kept[0].held, before) < 0.2
    found = left_of(seen).finished(kept[0]).fit
    table = table_of(found, seen.strokes, seen.scales, (0,), "f(x)", ratio(kept[0].held, before))
    # what the spring and the zero say is not the table's
    true = ungauged(table, np.interp(table.swept + found.model.offset, T_TRUE, well_as_tabled()))
    shown = np.interp(table.swept, table.at, table.force)
    # a spline through other knots than those it was simulated with
    assert np.sqrt(np.mean((shown - true) ** 2)) < 0.05 * np.sqrt(np.mean(true**2))
    assert np.all(table.stderr > 0.0)
    assert "x = 0.3" in described(table, found.model, False) or "x = 0.2" in described(table, found.model, False)


T_TRUE = np.linspace(-1.1, 1.1, 400)


def well_as_tabled() -> FloatArray:
    """The well through the knots it was simulated with."""
    model = BASE.with_terms(ModelTerm(BY_PLACE, (*well(np.linspace(-1.1, 1.1, KNOTS)).tolist(), -1.1, 1.1)))
    rows = partials(model, 0, T_TRUE, np.ones(T_TRUE.size), magnet().scales)
    return np.asarray(rows @ np.array(model.terms[0].values[:KNOTS]))


def test_a_random_misfit_gets_no_table() -> None:
    draws = np.random.default_rng(1).standard_normal(T.size)
    left = np.zeros(T.size)
    for i in range(1, T.size):
        left[i] = 0.95 * left[i - 1] + 0.31 * draws[i]
    seen = misfit_of(problem_of(BASE, 0.01 * left))
    before = held_out(seen.base, seen.problem, seen.scales, seen.strokes)
    assert before is not None
    assert left_of(seen).tabulated(before) == ()


@pytest.mark.parametrize("said", [r.said for r in RUNGS])
def test_tables_hold_nothing_of_what_is_the_bases(said: str) -> None:
    one, seen = basis(said), magnet()
    x, v = seen.base.shown.x, seen.base.shown.v
    moving = np.flatnonzero(v != 0.0)
    at = moving[:: max(1, moving.size // 600)]
    numbers = sorted({i for i, _ in one.places})
    shown = np.hstack([partials(one.model, i, x[at], v[at], seen.scales) for i in numbers]) @ one.free
    by_place = one.model.terms[0].term.known is not None and one.model.terms[0].term.known.of == "x"
    if said == "g(x) sgn v":
        functions = [np.ones(at.size)]
    elif by_place:
        functions = [x[at], np.ones(at.size)] if said == "f(x)" else []
    else:
        functions = [v[at]]
    for f in functions:
        assert np.abs(f @ shown).max() < 1e-8 * np.linalg.norm(f) * np.linalg.norm(shown, axis=0).max()


def test_blocks_predict_as_a_fit_without_them_would() -> None:
    found, block = fitted_magnet(), blocks_of(magnet().strokes)
    blocks, b = Blocks.of(found, block), len(found.free)
    penalty = np.zeros((found.jacobian.shape[1],) * 2)
    penalty[b:, b:] = found.penalty.T @ found.penalty
    out = block == 1
    y = found.residual + found.jacobian @ np.concatenate((np.zeros(b), found.at))
    j = found.jacobian[~out]
    p = np.linalg.solve(j.T @ j + penalty, j.T @ y[~out])
    numbers = np.arange(blocks.size.size)
    missed = blocks.missed(numbers != 2, numbers == 2, penalty)
    assert missed == pytest.approx(float(np.sum((y[out] - found.jacobian[out] @ p) ** 2)), rel=1e-6)


AT = np.linspace(-1.0, 1.0, 121)
SPEED = np.linspace(0.0, 1.0, 121)


def table(form: str, of: str, at: FloatArray, force: FloatArray, *gauge: str) -> Table:
    return Table(form, of, at, force, np.full(at.size, 1e-3), at, gauge)  # type: ignore[arg-type]


SHAPES = [
    (table("f(x)", "x", AT, np.tanh(AT / 0.15), "line"), "odd, stiffer about x ="),
    (table("f(x)", "x", AT, AT**3 - 0.6 * AT, "constant", "line"), "odd, it hardens towards the ends"),
    (table("f(x)", "x", AT, -(AT**3) + 0.6 * AT, "constant", "line"), "odd, it softens towards the ends"),
    (table("f(x)", "x", AT, np.abs(AT) - 0.5, "constant", "line"), "even"),
    (table("f(x)", "x", AT, np.maximum(AT - 0.3, 0.0) ** 2, "constant", "line"), "one-sided: it bends on the positive"),
    (table("g(x) sgn v", "x", AT, np.exp(-(((AT - 0.3) / 0.2) ** 2)), "constant"), "it rubs most about x = 0.3 m"),
    (table("g(x) sgn v", "x", AT, AT**4, "constant"), "it rubs most at both ends of the way"),
    (table("g(x) sgn v", "x", AT, np.tanh(8.0 * AT), "constant"), "it rubs more on the positive side"),
    (table("g(x) sgn v", "x", AT, 0.0 * AT, "constant"), "no place stands out of its error"),
    (table("f(|v|) sgn v", "|v|", SPEED, np.exp(-SPEED / 0.1) - 1.0, "line"), "it falls with speed up to"),
    (table("f(|v|) sgn v", "|v|", SPEED, np.tanh(SPEED / 0.2), "line"), "it saturates with speed"),
    (table("f(|v|) sgn v", "|v|", SPEED, SPEED**3, "line"), "it grows faster than in proportion to speed"),
    (table("f(v)", "v", AT, np.maximum(AT, 0.0) ** 2, "line"), "it acts forwards more than backwards"),
]


@pytest.mark.parametrize(("one", "words"), SHAPES)
def test_a_shape_is_said_in_words(one: Table, words: str) -> None:
    assert words in described(one, replace(BASE, c=0.01), False)
    assert gauge_of(one)


def test_what_has_no_name_is_modelled_beside_the_verdict() -> None:
    """A force with a shape that no entry has: knots at random, so that every name leaves much of it."""
    knots = np.random.default_rng(1).uniform(-2.0, 2.0, KNOTS)
    truth = BASE.with_terms(ModelTerm(BY_PLACE, (*knots.tolist(), -1.1, 1.1)))
    problem = problem_of(truth)
    base, scales = baseline(problem)
    # as if the search had found nothing that explains it: what is judged is what the base leaves
    nothing = Search(problem, base, base, (), (), Left.STRUCTURE)
    outcome = explain(judge(Found(nothing, scales, nothing)))
    (table,) = outcome.tables
    said = next(m for m in outcome.mechanisms if m.grade is Grade.TABULATED)
    assert outcome.verdict in ("main_effect", "one_of", "unexplained")
    assert outcome.refined.chi2 < 0.5 * outcome.base.chi2
    assert table.form == "f(x)"
    assert said.share is not None
    assert 0.0 < said.share <= 1.0
    assert said.held_out is not None
    assert outcome.holdout is not None
    assert outcome.holdout.refined_rmse["x"] < outcome.holdout.baseline_rmse["x"]
    assert "one decay cannot tell" in said.statement
    assert outcome.remainder is not None
    assert 1.0 < outcome.remainder.over_noise < np.sqrt(base.chi2 / base.points)
    assert {name for name, _ in table.nearest} <= {t.name for t in TERMS}
    assert [share for _, share in table.nearest] == sorted((share for _, share in table.nearest), reverse=True)
    assert len(sentence_of(outcome).split()) <= 40
