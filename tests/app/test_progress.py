"""What long work says of itself, and the time that it says is left."""

from pathlib import Path

import pytest
from diagnose_examples import stopped

from harness.app.diagnose.one import investigate
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.shared.progress import Pace, duration
from harness.app.shared.reading import ReadOptions, read
from harness.core.telling import listening, told
from harness.model.registry import NAMED


class Clock:
    """A clock that is set by hand."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def test_the_time_left_is_that_of_the_rest_at_the_same_pace() -> None:
    clock = Clock()
    pace = Pace(clock)
    assert pace.line() == ""
    for done in range(5):
        pace.tell("rows", done, 10)
        clock.now += 2.0
    clock.now -= 2.0
    assert pace.line() == "rows: 4 of 10 done, about 12 s left for these"
    clock.now += 5.0  # while the next one is in work
    assert pace.line() == "rows: 4 of 10 done, about 7 s left for these"
    clock.now += 60.0
    assert pace.line() == "rows: 4 of 10 done"


def test_what_was_done_before_and_what_is_other_work_say_nothing_of_the_pace() -> None:
    clock = Clock()
    pace = Pace(clock)
    for done in (90, 91, 92, 93):
        pace.tell("rows", done, 100)
        clock.now += 1.0
    clock.now -= 1.0
    assert pace.line() == "rows: 93 of 100 done, about 7 s left for these"
    pace.tell("trying end-stop", 5, 24)
    assert pace.line() == "trying end-stop: 5 of 24 done"
    pace.tell("report", 0, 0)
    assert pace.line() == "report"


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.2, "0 s"), (59.4, "59 s"), (200.0, "3 min 20 s"), (7500.0, "2 h 5 min")]
)
def test_a_duration_is_said_as_people_say_it(seconds: float, text: str) -> None:
    assert duration(seconds) == text


def test_work_is_heard_within_the_block_alone() -> None:
    heard: list[tuple[str, int, int]] = []
    with listening(lambda *said: heard.append(said)):
        assert list(told("ab", str.upper)) == ["a", "b"]
    assert list(told("cd", str.upper)) == ["c", "d"]
    assert heard == [("A", 0, 2), ("B", 1, 2)]


def test_a_diagnosis_names_what_it_tries_and_how_many_of_how_many(tmp_path: Path) -> None:
    recording = read(stopped(tmp_path / "decay.csv"), ReadOptions())
    heard: list[tuple[str, int, int]] = []
    investigate(recording, DiagnoseOptions(engines=()), lambda *said: heard.append(said))
    tried = {step.removeprefix("trying ") for step, _, _ in heard if step.startswith("trying ")}
    assert "end-stop" in tried
    assert tried & {term.name for term in NAMED} == {name for name in tried if " with " not in name}
    assert all(0 <= done < total for _, done, total in heard)
