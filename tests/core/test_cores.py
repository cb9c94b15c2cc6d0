"""Work on several cores gives what one after another gives: order, errors, what is told, and a search's numbers."""

import threading
import time
from contextvars import ContextVar

import numpy as np
import pytest

from harness.core.cores import VARIABLE, each, one_thread, threads
from harness.core.errors import InputError
from harness.core.telling import listening
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.search.extend import extend
from harness.estimate.noise import Noise
from harness.kernels.solve import simulate
from harness.model.model import Model, ModelTerm

COUNTS = ("1", "4")


@pytest.mark.parametrize("count", COUNTS)
def test_results_come_in_order(count: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, count)

    def late(i: int) -> int:
        time.sleep(0.002 * (8 - i))
        return i * i

    assert each(late, range(8)) == [i * i for i in range(8)]
    assert each(late, ()) == []


@pytest.mark.parametrize("count", COUNTS)
def test_the_first_error_in_order_is_raised(count: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, count)

    def failing(i: int) -> int:
        if i in (2, 5):
            time.sleep(0.01 * (5 - i))
            raise ValueError(str(i))
        return i

    with pytest.raises(ValueError, match="2"):
        each(failing, range(8))


def test_what_had_not_begun_is_left_undone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "2")
    begun = []

    def failing(i: int) -> None:
        begun.append(i)
        time.sleep(0.02)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        each(failing, range(50))
    assert len(begun) < 10


def test_pieces_within_a_piece_are_done_one_after_another(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "3")

    def inner(_: int) -> str:
        return threading.current_thread().name

    def outer(_: int) -> set[str]:
        return {threading.current_thread().name, *each(inner, range(4))}

    assert all(len(names) == 1 for names in each(outer, range(6)))


@pytest.mark.parametrize("count", COUNTS)
def test_listeners_hear_of_every_item_and_contexts_are_kept(count: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, count)
    heard: list[tuple[str, int, int]] = []
    here: ContextVar[str] = ContextVar("here")
    here.set("of the caller")
    with listening(lambda name, done, of: heard.append((name, done, of))), np.errstate(divide="raise"):
        said = each(lambda _: (here.get(), np.geterr()["divide"]), "abc", lambda letter: f"trying {letter}")
    assert said == [("of the caller", "raise")] * 3
    assert heard == [("trying a", 0, 3), ("trying b", 1, 3), ("trying c", 2, 3)]


def test_how_many(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    assert threads() >= 1
    for bad in ("0", "many", "-1", "1.5", ""):
        monkeypatch.setenv(VARIABLE, bad)
        with pytest.raises(InputError, match="a whole number of at least 1 is accepted"):
            threads()
    monkeypatch.setenv(VARIABLE, "7")
    one_thread()
    assert threads() == 7
    one_thread(whatever_was_asked=True)
    assert threads() == 1


def test_a_search_finds_the_same_to_the_last_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    truth = Model(m=1.0, c=0.15, k=88.4, f_k=0.3, x0=1.0, terms=(ModelTerm.named("quadratic-drag", c2=0.25),))
    t = np.linspace(0.0, 6.0, 500)
    x = simulate(truth, t).x + 2e-4 * np.random.default_rng(5).standard_normal(t.size)
    problem = FreeDecay(t, {"x": x}, {"x": Noise(2e-4, True)})
    base, scales = baseline(problem)
    found = []
    for count in COUNTS:
        monkeypatch.setenv(VARIABLE, count)
        found.append(
            [(f.model.terms[0].term.key, f.values.tolist(), f.chi2) for f in extend(base, problem, scales).fits]
        )
    assert found[0] == found[1]
    assert found[0][0][0] == "quadratic-drag"
