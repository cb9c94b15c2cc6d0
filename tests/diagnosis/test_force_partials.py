"""The force that a model asks for, block by block, and its partials by every number that can be fitted."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.diagnosis.inverse_dynamics.grade import sayable
from harness.diagnosis.parameters import Free, free_of, values_of, with_values
from harness.diagnosis.problems.asked import given_force
from harness.diagnosis.problems.measured import BLOCK, Laid, Measured
from harness.model.covariate import Acts, Covariate
from harness.model.elsewhere import Elsewhere
from harness.model.model import Model, ModelTerm
from harness.model.registry import NAMED
from harness.model.term import Term

BASE = ("m", "c", "k", "f_k", "offset")
T = np.linspace(0.0, 9.0, 900)
MODEL = Model(1.3, 0.8, 30.0, 2.0, offset=0.02)
COUNTS = np.arange(T.size // BLOCK) % 7 != 3


def path(way: float = 0.5) -> Measured:
    """A swing beside a slower one, some of whose blocks do not count."""
    x = way * np.sin(3.0 * T) + 0.1 * np.cos(1.1 * T)
    v = 3.0 * way * np.cos(3.0 * T) - 0.11 * np.sin(1.1 * T)
    a = -9.0 * way * np.sin(3.0 * T) - 0.121 * np.cos(1.1 * T)
    return Measured(T, x, v, a, np.zeros(T.size), COUNTS, {"P": 3.0 + np.sin(0.7 * T), "T": 20.0 + T})


def by_differences(model: Model, measured: Measured, free: tuple[Free, ...]) -> FloatArray:
    """Partials (m, q), from both sides."""
    values, columns = values_of(model, free), []
    for i in range(len(free)):
        step = 1e-6 * max(abs(values[i]), 1e-3)
        more, less = (values + side * step * np.eye(len(free))[i] for side in (1.0, -1.0))
        ends = [measured.asked(with_values(model, free, at))[0] for at in (more, less)]
        columns.append((ends[0] - ends[1]) / (2.0 * step))
    return np.column_stack(columns)


def alike(model: Model, measured: Measured, free: tuple[Free, ...]) -> None:
    _, by = measured.asked(model, tuple(f.by for f in free))
    wanted = by_differences(model, measured, free)
    assert np.max(np.abs(by - wanted), axis=0) == pytest.approx(0.0, abs=1e-5 * (1.0 + float(np.max(np.abs(wanted)))))


@pytest.mark.parametrize("term", [t for t in NAMED if sayable(t)], ids=lambda t: t.key)
def test_partials_are_what_differences_come_to(term: Term) -> None:
    """Of every law whose force follows from a motion; its internal states hang on its numbers too."""
    model = replace(MODEL, terms=(ModelTerm(term, term.example),))
    alike(model, path(), free_of(model, BASE))


@pytest.mark.parametrize("acts", list(Acts))
@pytest.mark.parametrize(
    "law", [ModelTerm.named("stribeck", f_s=2.6, v_s=0.4), ModelTerm.named("presliding", sigma0=90.0, sigma1=0.4)]
)
def test_partials_with_covariates(acts: Acts, law: ModelTerm) -> None:
    """Of the gain and the level too, with a second covariate beside it, and terms of both kinds."""
    beside = (Covariate("P", acts, 0.2, 3.0, level=0.1), Covariate("T", Acts.DAMPING, 0.05, 22.0))
    model = replace(MODEL, terms=(ModelTerm.named("cubic-stiffness", k3=8.0), law), covariates=beside)
    alike(model, path(), free_of(model, BASE))


def test_a_gain_that_leaves_nothing_of_friction_moves_nothing() -> None:
    """Where the factor would be below none it is none, whatever the gain."""
    model = replace(MODEL, covariates=(Covariate("P", Acts.FRICTION, 3.0, 3.0),))
    measured = path()
    (gain,) = (f for f in free_of(model, ()) if f.name == "gain_P")
    _, by = measured.asked(model, (gain.by,))
    none = measured.blocks((measured.covariates["P"] < 2.6).astype(float)) == 1.0
    assert none.any()
    assert np.all(by[none] == 0.0)
    assert np.any(by != 0.0)


def test_partials_of_several_recordings() -> None:
    """What a recording has of its own moves it alone; what all share moves all but those with one of their own."""
    one, two = path(), path(0.3)
    t, x, v, a, moving = (
        np.concatenate((getattr(one, name), getattr(two, name))) for name in ("t", "x", "v", "a", "moving")
    )
    t[T.size :] += 10.0
    laid = (Laid(slice(0, T.size), 0.0), Laid(slice(T.size, 2 * T.size), 10.0))
    level = np.repeat([1.0, 2.0], COUNTS.size)
    measured = Measured(t, x, v, a, np.zeros(t.size), moving, laid=laid, level=level)
    model = replace(MODEL, elsewhere=(Elsewhere((("offset", -0.01), ("f_k", 2.5))),))
    free = free_of(model, (*BASE, "offset#2", "f_k#2"))
    alike(model, measured, free)
    _, by = measured.asked(model, tuple(f.by for f in free))
    first, names = int(COUNTS.sum()), [f.name for f in free]
    assert np.all(by[first:, names.index("offset")] == 0.0)
    assert np.all(by[:first, names.index("f_k#2")] == 0.0)
    assert np.all(by[:, names.index("c")] != 0.0)


def test_blocks_are_means_of_samples() -> None:
    """Block by block what is asked for sample by sample, covariates and all."""
    beside = (Covariate("P", Acts.FRICTION, 0.2, 3.0), Covariate("T", Acts.FORCE, 0.05, 22.0, level=0.3))
    model, measured = replace(MODEL, covariates=beside, terms=(ModelTerm.named("quadratic-drag", c2=0.5),)), path()
    force = given_force(model, measured.t, measured.x, measured.v, measured.a, measured.covariates)
    assert measured.asked(model)[0] == pytest.approx(measured.blocks(force), rel=1e-12, abs=1e-12)
