"""Ours beside what a practitioner would do on the same recordings; a margin counts when its interval excludes none."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from harness.proof.plan import CONTROL, SINGLE
from harness.proof.score import Answer, Result, Truth
from harness.proof.statistics import resampled

R2, SINDY, SYSID = "r2", "pysindy", "mujoco.sysid"
ABOUT = {
    R2: "the law whose addition to a regression of the force balance raises R\u00b2 most",
    SINDY: "sparse regression over the same laws",
    SYSID: "its fit of stiffness, damping and frictionloss; it names nothing",
}
BASELINES = tuple(ABOUT)
CHANNEL = "x"
"""The channel that mujoco.sysid fits and predicts."""


@dataclass(frozen=True, slots=True)
class Margin:
    """A paired difference with its bootstrap interval.

    what : of which figure. ours, theirs : shares, or medians of the held-out rmse in units of ours. cases : recordings
    on which the other has something to work on. value, low, high : by how much ours is better. none : where there is
    no margin. why : it has nothing to work on, or could not be run.
    """

    name: str
    what: str
    cases: int
    ours: float | None
    theirs: float | None
    value: float | None
    low: float | None
    high: float | None
    none: float
    share: bool
    why: str = ""

    @property
    def beaten(self) -> bool:
        """Whether the interval excludes that there is no margin."""
        return self.low is not None and self.low > self.none


def beside(
    answers: Mapping[str, Truth], ours: Mapping[str, Result], others: Mapping[str, Mapping[str, Result]]
) -> list[Margin]:
    """Every margin there is; others : results by baseline and recording, with "applies"."""
    found = []
    for who, said in others.items():
        able = {name: truth for name, truth in answers.items() if (said.get(name) or {}).get("applies")}
        if not able:
            # its most frequent reason
            reasons = Counter(str(one.get("error") or one.get("why") or "") for one in said.values())
            why = reasons.most_common(1)[0][0] if reasons else "it said nothing"
            found.append(Margin(who, "", 0, None, None, None, None, None, 0.0, True, why))
            continue
        if who == SYSID:
            found.append(_held_out(who, able, ours, said))
            continue
        for group, what in ((SINGLE, "single effects named"), (CONTROL, "nothing said where nothing is hidden")):
            names = sorted(name for name, truth in able.items() if truth["group"] == group)
            right = [[_right(able[name], by.get(name)) for name in names] for by in (ours, said)]
            if not names:
                found.append(Margin(who, what, 0, None, None, None, None, None, 0.0, True, "no such recording"))
                continue
            a, b = np.asarray(right, dtype=np.float64)
            mean, (low, high) = float((a - b).mean()), resampled(a - b, lambda picks: np.mean(picks, axis=1))
            found.append(Margin(who, what, a.size, float(a.mean()), float(b.mean()), mean, low, high, 0.0, True))
    return found


def _right(truth: Truth, result: Result | None) -> bool:
    answer = Answer.of(result)
    if not truth["mechanisms"]:
        return answer.label == "nothing"
    return sorted(answer.said) == sorted(truth["mechanisms"])


def _held_out(who: str, able: Mapping[str, Truth], ours: Mapping[str, Result], theirs: Mapping[str, Result]) -> Margin:
    """Held-out rmse of theirs over ours where an effect is hidden; what we withheld counts as no better."""
    ratios = []
    for name, truth in sorted(able.items()):
        other = (theirs[name].get("rmse") or {}).get(CHANNEL)
        if not truth["mechanisms"] or not other:
            continue
        mine = ((ours.get(name) or {}).get("holdout") or {}).get("refined_rmse", {}).get(CHANNEL)
        ratios.append(other / mine if mine else 1.0)
    what = "held-out rmse where an effect is hidden, theirs over ours, median"
    if not ratios:
        return Margin(who, what, 0, None, None, None, None, None, 1.0, False, "no such recording")
    low, high = resampled(np.asarray(ratios, dtype=np.float64), lambda picks: np.median(picks, axis=1))
    middle = float(np.median(ratios))
    return Margin(who, what, len(ratios), 1.0, middle, middle, low, high, 1.0, False)


def shortfalls(margins: Sequence[Margin]) -> list[str]:
    """Baselines that are not beaten, one sentence each."""
    return [
        f"{one.name}, {one.what}: {one.low:.3g} to {one.high:.3g}, above {one.none:g} is asked"
        for one in margins
        if one.cases and not one.beaten
    ]
