"""A minor part of a force is shown by its own law where the search kept one that keeps time with the motion."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.diagnosis.grading.grade import Finalist
from harness.diagnosis.inverse_dynamics import grade as room
from harness.diagnosis.outcome import Grade

KEPT, NAMED = "harmonic-force", "presliding"


def a_fit(*names: str) -> Any:
    """A fit of these laws that leaves 1 N^2 in ten samples."""
    terms = tuple(SimpleNamespace(term=SimpleNamespace(name=name)) for name in names)
    return SimpleNamespace(model=SimpleNamespace(terms=terms), squares=1.0, residual=np.zeros(10))


@pytest.mark.parametrize(
    ("kept", "clock", "grade", "shown"),
    [
        ((KEPT,), True, Grade.MINOR, NAMED),
        ((KEPT,), False, Grade.MINOR, KEPT),
        ((KEPT, "quadratic-drag"), True, Grade.MINOR, KEPT),
        ((), True, Grade.MINOR, NAMED),
        ((KEPT,), False, Grade.ONE_OF, NAMED),
        ((NAMED,), True, Grade.MINOR, NAMED),
    ],
)
def test_which_model_is_shown(
    monkeypatch: pytest.MonkeyPatch, kept: tuple[str, ...], clock: bool, grade: Grade, shown: str
) -> None:
    laws = {KEPT: a_fit(KEPT), NAMED: a_fit(NAMED)}
    finalists = [
        Finalist(laws[KEPT], 20.0, 0.61, 0.6, clock),
        Finalist(laws[NAMED], 18.0, 0.55, 0.5, False),
    ]
    monkeypatch.setattr(room, "force_words", lambda base, measured: SimpleNamespace(words=20.0, pieces=np.zeros(10)))
    monkeypatch.setattr(room, "blocks_of", lambda pieces: pieces)
    monkeypatch.setattr(room, "held_out", lambda one, measured, block: None)
    monkeypatch.setattr(room, "_ranked", lambda *_: [(f, f.fit) for f in finalists])
    monkeypatch.setattr(room, "decided", lambda found: replace(found, grade=grade, named=(found.finalists[1],)))
    chosen = a_fit(*kept)
    fitted: Any = SimpleNamespace(
        base=a_fit(), reference=chosen, measured=None, seen=lambda one: one, counted=lambda one: one
    )
    over: Any = SimpleNamespace(noise=0.0)
    found = room.graded(fitted, chosen, [], over, judged=False)
    assert found.refined.model.terms[0].term.name == shown
    assert [f.name for f in found.named] == [NAMED]
