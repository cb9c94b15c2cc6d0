"""The worked example of docs/api.md says what it prints."""

import re
from pathlib import Path

import pytest

TEXT = (Path(__file__).resolve().parents[2] / "docs" / "api.md").read_text(encoding="utf-8")


def test_the_worked_example_prints_what_the_page_says(capsys: pytest.CaptureFixture[str]) -> None:
    code, said = (re.search(rf"```{kind}\n(.*?)```", TEXT, re.DOTALL) for kind in ("python", "text"))
    assert code is not None
    assert said is not None
    exec(compile(code[1], "docs/api.md", "exec"), {})
    printed, wanted = capsys.readouterr().out.splitlines(), said[1].splitlines()
    assert len(printed) == len(wanted)
    number = r"-?\d+\.?\d*(?:e-?\d+)?"
    for found, line in zip(printed, wanted, strict=True):
        # the words to the letter, the numbers as far as another machine repeats them
        assert re.sub(number, "#", found) == re.sub(number, "#", line)
        values = [[float(value) for value in re.findall(number, one)] for one in (found, line)]
        assert values[0] == pytest.approx(values[1], rel=0.1)
