"""Work on several cores or in one thread gives the same; a terminal obeys nothing."""

import os
import subprocess
import sys
import threading
import time
from contextvars import ContextVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.cores import VARIABLE, each, one_thread, threads
from harness.core.errors import InputError, visible
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
        with pytest.raises(InputError, match="a whole number of at least 1"):
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


ASK = """
import sys
import harness.cli.main as m
sys.argv = ["harness", "--version"]
try:
    m.main()
except SystemExit:
    pass
"""


def _told(**asked: str) -> str:
    free = {k: v for k, v in os.environ.items() if not k.endswith("_NUM_THREADS")}
    code = f"{ASK}import numpy, os\nprint(os.environ['OPENBLAS_NUM_THREADS'])"
    said = subprocess.run(
        [sys.executable, "-c", code], env={**free, **asked}, capture_output=True, text=True, check=True, timeout=60
    )
    return said.stdout.split()[-1]


def test_a_command_computes_in_one_thread() -> None:
    assert _told() == "1"


def test_what_was_asked_stays() -> None:
    assert _told(OPENBLAS_NUM_THREADS="2") == "2"


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("x [µm], Weg 2", "x [µm], Weg 2"),
        ("\x1b]0;title\x07", r"\x1b]0;title\x07"),
        ("a\rb\x00\x7f\x9b", r"a\rb\x00\x7f\x9b"),
        ("\u202efdp.exe", r"\u202efdp.exe"),
        ("bad\udcff", r"bad\udcff"),
        ("two\nlines\tand a tab", "two\nlines\tand a tab"),
    ],
)
def test_what_would_be_obeyed_is_escaped(text: str, shown: str) -> None:
    assert visible(text) == shown


@given(st.text(), st.text(max_size=30))
def test_an_error_is_one_line_of_text(found: str, where: str) -> None:
    said = str(InputError(where, found, "this"))
    said.encode()
    assert "\n" not in said
    assert not any(ord(c) < 32 or 127 <= ord(c) < 160 for c in said)
    assert said.endswith("this")
    assert len(said) < 6000
