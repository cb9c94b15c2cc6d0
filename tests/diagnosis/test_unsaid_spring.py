"""A spring in a driven recording that is said to have none is told of, with its stiffness; where none is, none."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.recording import Recording
from harness.diagnosis.pipeline import prepare
from harness.diagnosis.prepare.held import Beside
from harness.diagnosis.request import Asked
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, Restoring

T = np.linspace(0.0, 4.0, 2001)
U = 3.0 * np.sin(2.0 * np.pi * 1.1 * T) + 1.5 * np.sin(2.0 * np.pi * 0.37 * T + 1.0)


@given(st.floats(10.0, 300.0), st.floats(0.0, 1.0), st.booleans())
def test_a_spring_is_found_with_its_stiffness(k: float, f_k: float, mass_known: bool) -> None:
    run = solve(Model(m=1.0, c=1.2, k=k, f_k=f_k), T, drive=Drive(T, U))
    beside = Beside.of((run.x, run.v, run.a), U, 1.0 if mass_known else None)
    assert beside.k == pytest.approx(k, rel=1e-6)
    assert beside.share == pytest.approx(1.0, abs=1e-6)
    assert beside.is_unsaid


@given(st.floats(0.0, 1.0), st.floats(0.1, 5.0))
def test_where_none_is_none_is_found(f_k: float, c: float) -> None:
    run = solve(Model(m=1.0, c=c, k=0.0, f_k=f_k, restoring=Restoring.NONE), T, drive=Drive(T, U))
    assert abs(Beside.of((run.x, run.v, run.a), U, 1.0).k) < 1e-6


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


def test_an_axis_is_told_of_none() -> None:
    assert said(0.0) == []
