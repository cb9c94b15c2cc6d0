"""Sentences begin with a capital; symbols and names keep their letters."""

import pytest

from harness.core.wording import capitalised


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("driven: the force is fitted", "Driven: the force is fitted"),
        ("the file a.csv is read", "The file a.csv is read"),
        ("adequate.", "Adequate."),
        ("x_k differs", "x_k differs"),
        ("zeta differs", "zeta differs"),
        ("elbow.position is counted from 1 rad", "elbow.position is counted from 1 rad"),
        ("q2 is at rest", "q2 is at rest"),
        ("arm/run.csv is left out", "arm/run.csv is left out"),
        ("", ""),
    ],
)
def test_a_sentence_begins_with_a_capital_and_a_name_as_it_is(text: str, shown: str) -> None:
    assert capitalised(text) == shown
