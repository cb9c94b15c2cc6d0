"""Steps of the search: what one more term may be."""

import numpy as np
import pytest

from harness.core.errors import SimulationError
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.fit.least_squares import Fit
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import AMONG_NAMES, DECISIVE
from harness.diagnosis.search import extend as select
from harness.diagnosis.search.extend import extend
from harness.diagnosis.search.repeats import repeats
from harness.estimate.noise import channel_noise
from harness.kernels.solve import simulate
from harness.model.model import Model, ModelTerm
from harness.model.registry import NAMED


def decay() -> Problem:
    t = np.linspace(0.0, 8.0, 1200)
    x = simulate(Model(1.0, 0.3, 100.0, 0.4, x0=0.1), t).x + 1e-4 * np.random.default_rng(1).standard_normal(t.size)
    return Problem(t, {"x": x}, {"x": channel_noise(t, x)})


def test_a_law_too_stiff_for_a_first_look_is_nothing_to_build_on(monkeypatch: pytest.MonkeyPatch) -> None:
    def too_stiff(*_: object) -> list[Fit]:
        raise SimulationError("the model could not be followed")

    problem = decay()
    base, scales = baseline(problem)
    monkeypatch.setattr(select, "screen", too_stiff)
    assert extend(base, problem, scales).fits == ()


def test_a_name_must_stand_out_among_all_that_were_tried() -> None:
    assert pytest.approx(DECISIVE.value + 2.0 * np.log(len({term.name for term in NAMED}))) == AMONG_NAMES.value


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
    assert repeats(entry, 0.2, 1.0, 0.5) is said
