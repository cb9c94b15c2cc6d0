"""Ours beside what a practitioner would do on the same recordings; a margin counts when its interval excludes none."""

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np

from harness.proof.plan import CONTROL, SINGLE
from harness.proof.score import Answer, Result, Truth
from harness.proof.statistics import resampled
from harness.results.prove import BaselineMargin

R2, SINDY, SYSID = "r2", "pysindy", "mujoco.sysid"
ABOUT = {
    R2: "the law whose addition to a regression of the force balance raises R\u00b2 most",
    SINDY: "sparse regression over the same laws",
    SYSID: "its fit of stiffness, damping and frictionloss; it names nothing",
}
BASELINES = tuple(ABOUT)
CHANNEL = "x"
"""The channel that mujoco.sysid fits and predicts."""


def beside(
    answers: Mapping[str, Truth], ours: Mapping[str, Result], others: Mapping[str, Mapping[str, Result]]
) -> list[BaselineMargin]:
    """Every margin there is, its value with a bootstrap interval; others : results by baseline and recording, with
    "applies". Ours and theirs are shares, or medians of the held-out rmse in units of ours.
    """
    found = []
    for who, said in others.items():
        able = {name: truth for name, truth in answers.items() if (said.get(name) or {}).get("applies")}
        if not able:
            # its most frequent reason
            reasons = Counter(str(one.get("error") or one.get("why") or "") for one in said.values())
            found.append(_margin(who, "", why=reasons.most_common(1)[0][0] if reasons else "it said nothing"))
            continue
        if who == SYSID:
            found.append(_held_out(who, able, ours, said))
            continue
        for group, what in ((SINGLE, "single effects named"), (CONTROL, "nothing said where nothing is hidden")):
            names = sorted(name for name, truth in able.items() if truth["group"] == group)
            right = [[_right(able[name], by.get(name)) for name in names] for by in (ours, said)]
            if not names:
                found.append(_margin(who, what))
                continue
            a, b = np.asarray(right, dtype=np.float64)
            mean, interval = float((a - b).mean()), resampled(a - b, lambda picks: np.mean(picks, axis=1))
            found.append(_margin(who, what, a.size, float(a.mean()), float(b.mean()), mean, interval))
    return found


def _margin(
    who: str,
    what: str,
    cases: int = 0,
    ours: float | None = None,
    theirs: float | None = None,
    value: float | None = None,
    interval: tuple[float, float] | None = None,
    none: float = 0.0,
    why: str = "no such recording",
) -> BaselineMargin:
    """none : where there is no margin, 0 of a share, 1 of a ratio; why : in place of one."""
    low, high = interval or (None, None)
    return BaselineMargin(
        name=who,
        about=ABOUT[who],
        what=what,
        cases=cases,
        ours=ours,
        theirs=theirs,
        value=value,
        low=low,
        high=high,
        none=none,
        share=none == 0.0,
        why="" if cases else why,
        beaten=low is not None and low > none,
    )


def _right(truth: Truth, result: Result | None) -> bool:
    answer = Answer.of(result)
    if not truth["mechanisms"]:
        return answer.label == "nothing"
    return sorted(answer.said) == sorted(truth["mechanisms"])


def _held_out(
    who: str, able: Mapping[str, Truth], ours: Mapping[str, Result], theirs: Mapping[str, Result]
) -> BaselineMargin:
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
        return _margin(who, what, none=1.0)
    interval = resampled(np.asarray(ratios, dtype=np.float64), lambda picks: np.median(picks, axis=1))
    middle = float(np.median(ratios))
    return _margin(who, what, len(ratios), 1.0, middle, middle, interval, 1.0)


def shortfalls(margins: Sequence[BaselineMargin]) -> list[str]:
    """Baselines that are not beaten, one sentence each."""
    return [
        f"{one.name}, {one.what}: {one.low:.3g} to {one.high:.3g}, above {one.none:g} is asked"
        for one in margins
        if one.cases and not one.beaten
    ]
