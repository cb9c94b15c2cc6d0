"""A tenth of the corpus' own draws is answered as its file says; the whole is ``python -m benchmarks.corpus``."""

from pathlib import Path

import pytest

from benchmarks.corpus import own
from benchmarks.corpus.__main__ import asked, kept, moved
from benchmarks.corpus.case import Case, Truth, marked
from benchmarks.corpus.shared import cases as cases_of_others

OWN = list(own.cases())


@pytest.mark.parametrize("case", OWN[4::10], ids=lambda case: str(case.name))
def test_answers_are_as_kept(case: Case) -> None:
    before = kept()[case.name]
    assert not moved(before, asked(case))


def test_no_case_stands_for_two_and_every_own_draw_is_kept() -> None:
    names = [case.name for case in OWN]
    assert len(set(names)) == len(names)
    assert set(names) <= kept().keys()


def test_without_others_recordings_their_cases_are_left_out(tmp_path: Path) -> None:
    assert not list(cases_of_others(tmp_path))


@pytest.mark.parametrize(
    ("answer", "truth", "mark"),
    [
        ({"verdict": "adequate"}, Truth("", quiet=True), "right"),
        ({"verdict": "adequate"}, Truth("", ("drag",)), "silent"),
        ({"verdict": "error", "error": "x"}, Truth("", ("drag",)), "refused"),
        ({"verdict": "error", "error": "x"}, Truth("", verdict=("error",)), "right"),
        ({"verdict": "main_effect", "mechanisms": [{"name": "drag", "grade": "main"}]}, Truth("", ("drag",)), "right"),
        ({"verdict": "one_of", "mechanisms": [{"name": "drag", "grade": "one-of"}]}, Truth("", ("drag",)), "listed"),
        ({"verdict": "main_effect", "mechanisms": [{"name": "lag", "grade": "main"}]}, Truth("", ("drag",)), "wrong"),
        ({"verdict": "one_of", "mechanisms": [{"name": "a", "grade": "one-of"}]}, Truth("", quiet=True), "false alarm"),
        ({"verdict": "adequate", "m": {"value": 1.2}}, Truth("", numbers={"m": (1.0, 0.1)}), "missed"),
    ],
)  # fmt: skip
def test_an_answer_is_worth_what_the_truth_makes_of_it(answer: dict[str, object], truth: Truth, mark: str) -> None:
    assert marked(answer, truth) == mark
