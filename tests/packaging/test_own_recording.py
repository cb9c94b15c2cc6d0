"""docs/own-recording.md shows what its commands print today, to the digits that may differ between machines."""

import re
import runpy
from pathlib import Path

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")
RULE = re.compile(r"[\u2500-\u257f]+| {2,}")
# creep of a slider at rest, and what an estimator reads at a smeared reversal, are small differences of large numbers
LOOSE = 1e-4


def words(text: str) -> list[str]:
    return RULE.sub(" ", NUMBER.sub("#", text)).split()


@pytest.mark.slow
def test_the_page_shows_what_its_commands_print() -> None:
    made = runpy.run_path(str(DOCS / "own_recording.py"))["text"]()
    shown = (DOCS / "own-recording.md").read_text(encoding="utf-8")
    assert words(made) == words(shown), "run python docs/own_recording.py"
    new, old = ([float(n) for n in NUMBER.findall(text)] for text in (made, shown))
    assert new == pytest.approx(old, rel=0.02, abs=LOOSE)


@pytest.mark.slow
def test_the_page_of_the_robot_shows_what_its_commands_print() -> None:
    pytest.importorskip("rosbags")
    pytest.importorskip("pybullet")
    made = runpy.run_path(str(DOCS / "robot_example.py"))["text"]()
    shown = (DOCS / "robot-example.md").read_text(encoding="utf-8")
    assert words(made) == words(shown), "run python docs/robot_example.py"
    new, old = ([float(n) for n in NUMBER.findall(text)] for text in (made, shown))
    assert new == pytest.approx(old, rel=0.02, abs=LOOSE)


def test_the_example_is_what_its_maker_writes() -> None:
    table = runpy.run_path(str(DOCS / "example" / "make.py"))["table"]()
    assert (DOCS / "example" / "rig.csv").read_text(encoding="utf-8") == table
