"""What no evidence of a recording tells: how often an effect is there that is not identified, or that is another.

Recordings of five ways of the proof on all ways, half with nothing hidden, three eighths with an effect of a published
form, an eighth with one of no family; its strength is as likely in each decade, from what cannot be seen to what is
obvious. Each is diagnosed as a user does it, and the likeliest explanation held against what was hidden.
"""

import json
import math
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import chdir
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.calibrate.calibration import Calibration, stands
from harness.app.prove.blind_worker import answered
from harness.diagnosis.rules import OTHER_FORM, UNSEEN
from harness.proof.paths.forms import CURVE, DECAY, DOWN, SLOW, SWING
from harness.proof.paths.made import CONTROL, FORM, UNKNOWN, forms_of, made, shapes_of
from harness.proof.paths.score import WRONG, found, is_hidden, outcome, paths
from harness.proof.tally import OURS

WAYS = (DECAY, CURVE, SWING, DOWN, SLOW)
_NOTHING, _FORMS = 0.5, 0.625
"""Shares below which nothing is hidden, and from which what is hidden has a form of a law."""
_ERRORS = 2.0
"""Standard errors that a share may be off."""


@dataclass(frozen=True, slots=True)
class Row:
    """What is hidden in a recording, and the verdict on it."""

    truth: dict[str, Any]
    verdict: dict[str, Any]


def measure(seed: int, index: int) -> Row:
    """A new recording, diagnosed. Raises SimulationError where none came out."""
    rng, path = np.random.default_rng([seed, index]), WAYS[index % len(WAYS)]
    share = rng.random()
    group = CONTROL if share < _NOTHING else UNKNOWN if share < _FORMS else FORM
    forms = {CONTROL: [""], UNKNOWN: shapes_of(path), FORM: forms_of(path)}[group]
    one = made(seed, index, path, group, str(rng.choice(forms)))
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        return Row(one.answer, json.loads(answered(OURS, one.answer["arguments"], one.recording)))


def said(rows: Sequence[Row]) -> Iterator[str]:
    """What probabilities were worth, and how often each rule's case came up."""
    truths = {str(i): row.truth for i, row in enumerate(rows)}
    verdicts = {str(i): row.verdict for i, row in enumerate(rows)}
    error = next(one.found for one in found(truths, verdicts) if one.key == "paths_calibration")
    yield "probability said of the likeliest explanation, and share that held"
    for one in paths(truths, verdicts).reliability:
        yield f"{one.said:.2f} {one.held.value or 0.0:.2f} of {one.held.cases}"
    yield f"expected calibration error {error.as_dict()['value'] or 0.0:.3f}"
    unnamed = [is_hidden(row.truth) for row in rows if row.verdict["verdict"] in ("adequate", "unexplained")]
    share = UNSEEN.value / (1.0 + UNSEEN.value)
    why = f"of {len(unnamed)} verdicts that name nothing {sum(unnamed)} are of a recording that hides what has a name"
    yield stands(UNSEEN, _near(share, sum(unnamed), len(unnamed)), why)
    named = [row for row in rows if row.verdict["verdict"] in ("missing_physics", "one_of")]
    others = [one["probability"] for row in named for one in row.verdict["posterior"] if not one["names"]]
    wrong = sum(outcome(row.truth, row.verdict) == WRONG for row in named)
    why = f"of {len(named)} verdicts that name or list laws {wrong} are wrong, {sum(others):.1f} were to be"
    yield stands(OTHER_FORM, abs(wrong - sum(others)) <= _ERRORS * math.sqrt(max(sum(others), 1.0)), why)


def _near(share: float, hits: int, of: int) -> bool:
    """Whether so many are no sign of another share."""
    return abs(hits - share * of) <= _ERRORS * math.sqrt(max(of * share * (1.0 - share), 1.0))


CALIBRATION = Calibration(
    measure, said, "how likely an effect is that no evidence tells: what that is worth, on recordings with and without"
)
