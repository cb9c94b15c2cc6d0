"""Simulations that rules come from run, say the value of their rule, and give the same twice."""

import math

import numpy as np
import pytest

from benchmarks.calibrate.__main__ import CALIBRATIONS, main
from benchmarks.calibrate.few_cycles import by_words
from benchmarks.calibrate.posterior import Row, counted
from harness.diagnosis.rules import GAIN, RULES, SHARE_OF_EXCESS, Rule

QUICK = (
    *("second-term", "screen-share", "few-cycles", "tables", "together", "colours", "taken"),
    *("posterior", "force-posterior", "unseen"),
)
"""Those whose draw takes less than four seconds; the others take the same way."""
SEED = 3
"""Its first draw says something in every calibration."""


def _asked_by(rule: Rule) -> str:
    """The calibration that the origin of a rule asks for."""
    return rule.origin.partition("python -m benchmarks.calibrate ")[2].split(" ")[0].strip("();,.")


def test_every_calibration_that_a_rule_comes_from_is_there() -> None:
    assert {_asked_by(rule) for rule in RULES} - {""} <= set(CALIBRATIONS)


@pytest.mark.parametrize("name", [n if n in QUICK else pytest.param(n, marks=pytest.mark.full) for n in CALIBRATIONS])
def test_a_calibration_says_whether_its_rules_stand(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The rules that have it for their origin are among those it judges."""
    assert main([name, "--draws", "1", "--seed", str(SEED)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith(f"{name}: seed {SEED}, 1 draws, ")
    judged = {line.split(" = ")[0] for line in lines if "the rule stands" in line or "the rule falls short" in line}
    assert {rule.name for rule in RULES if _asked_by(rule) == name} <= judged


def test_the_bound_of_few_cycles_is_that_of_random_directions() -> None:
    rng = np.random.default_rng(1)
    cycles, laws = 6, 10
    words, left = 2 * cycles, 2 * cycles - 6
    directions = rng.standard_normal((4000, laws, left))
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    misfit = rng.standard_normal((4000, left, 1))
    share = np.max((directions @ misfit)[..., 0] ** 2, axis=-1) / np.sum(misfit[..., 0] ** 2, axis=-1)
    gain = -words * np.log1p(-share) - math.log(words)
    seen = np.mean((share >= SHARE_OF_EXCESS.value) & (gain >= GAIN.value))
    # one standard error of 4000 draws at a third is 0.0075
    assert by_words(cycles, laws) == pytest.approx(seen, abs=0.025)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["few-cycles", "--draws", "0"], "--draws: 0; expected a whole number of at least 1"),
        (["few-cycles", "--jobs", "-1"], "--jobs: -1; expected a whole number of at least 1"),
        (["few-cycles", "--plant", "."], "--plant: given with few-cycles; it goes with tables"),
    ],
)
def test_options_that_do_not_go_are_refused(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    assert capsys.readouterr().err.strip() == said


def test_counts_tell_named_listed_wrong_and_claimed() -> None:
    def row(group: str, main: str | None, *may: str) -> Row:
        return Row(("a", "b"), np.zeros((2, 1)), main, frozenset(may), group, ())

    sure, even, wrong, none = ([0.1, 0.85, 0.05], [0.1, 0.5, 0.4], [0.05, 0.05, 0.9], [0.95, 0.03, 0.02])
    mains = [(row("main", "a"), p) for p in (sure, even, wrong, none)]
    controls = [(row("machine-control", None, *may), p) for may, p in (((), sure), (("a",), sure), ((), even))]
    rows = [*mains, *controls, (row("unknown", None), sure)]
    found = counted([one for one, _ in rows], [np.array(p) for _, p in rows])
    assert found == {
        "named": 1,
        "listed": 1,
        "wrong": 1,
        "machine-control claimed": 1,
        "machine-control listed": 1,
        "unknown claimed": 1,
    }
