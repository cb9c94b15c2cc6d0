"""Everything a proof says, computed from answers and verdicts alone, so that anybody can compute it again."""

import json
import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from harness.proof.beside import ABOUT, beside, shortfalls
from harness.proof.detection import curve
from harness.proof.machines.plan import GROUPS as MACHINE_GROUPS
from harness.proof.machines.score import right as right_of_machine
from harness.proof.machines.score import score as score_machines
from harness.proof.plan import CONTROL, DETECTION, OUTSIDE, PAIR, SINGLE
from harness.proof.plant.effects import FAMILY, KINDS
from harness.proof.score import Answer, Figure, Result, Truth, figures, forced, machine_figures, score

OURS = "harness"
GROUPS = (SINGLE, CONTROL, PAIR, OUTSIDE)
"""Groups that the scores are made of."""
PLAUSIBLE_R2 = 0.99
MUST_FAIL = {
    "answers at random": "a name of the catalogue or nothing, by the toss of a coin",
    "always says stribeck": "the most usual suspect",
    "lists everything": "all names of the catalogue at once",
    "looks at R\u00b2 alone": "nothing where viscous and Coulomb friction fit to 0.99, stribeck elsewhere",
}

Verdicts = Mapping[str, bytes]


def parsed(verdicts: Verdicts) -> dict[str, Result]:
    """Verdicts as data, without those that said nothing."""
    return {name: json.loads(said) for name, said in verdicts.items() if said}


def tally(answers: Mapping[str, Truth], verdicts: Mapping[str, Verdicts], seed: int) -> dict[str, Any]:
    """Figures, confusion, names, shortfalls, sources, diagnosers that must fail, and every case.

    answers : by name of the recording. verdicts : by diagnoser, ours among them, and by name. seed : the revealed one.
    """
    ours = parsed(verdicts.get(OURS, {}))
    scored = {name: truth for name, truth in answers.items() if truth["group"] in GROUPS}
    scores, controls = score(scored, ours), forced(scored, ours)
    others = {who: parsed(said) for who, said in sorted(verdicts.items()) if who != OURS}
    margins = beside(scored, ours, others)
    machines = {name: truth for name, truth in answers.items() if truth["group"] in MACHINE_GROUPS}
    rows = figures(scores) if scored else []
    rows += machine_figures(score_machines(machines, ours)) if machines else []
    short = [row.sentence for row in rows if row.met is False]
    short += [*(controls.shortfalls() if any_control(scored) else []), *shortfalls(margins)]
    return {
        "figures": shown(rows),
        "forced": controls.as_dict(),
        "confusion": {true: dict(sorted(said.items())) for true, said in sorted(scores.confusion.items())},
        "by_name": {name: rate.as_dict() for name, rate in scores.by_name.items()},
        "not_tested": list(scores.not_tested) if scored else [],
        "shortfalls": short,
        "by_source": _by_source(scored, ours),
        "must_fail": _must_fail(scored, seed) if scored else [],
        "baselines": [{**asdict(one), "about": ABOUT[one.name], "beaten": one.beaten} for one in margins],
        "detection": _detection(answers, ours),
        "cases": [_case(name, answers[name], ours.get(name)) for name in sorted(answers)],
    }


def _detection(answers: Mapping[str, Truth], ours: Mapping[str, Result]) -> dict[str, Any] | None:
    """The detection curve, where there are recordings for one."""
    steps = {name: truth for name, truth in answers.items() if truth["group"] == DETECTION}
    return curve(steps, ours).as_dict() if steps else None


def any_control(answers: Mapping[str, Truth]) -> bool:
    """Whether there is a recording in which nothing is hidden."""
    return any(truth["group"] == CONTROL for truth in answers.values())


def shown(rows: Sequence[Figure]) -> list[dict[str, Any]]:
    """Figures as results hold them."""
    return [
        {
            "key": figure.key,
            "label": figure.label,
            "asked": figure.asked,
            "met": figure.met,
            "share": figure.share,
            "hits": None,
            **figure.found.as_dict(),
        }
        for figure in rows
    ]


def _by_source(answers: Mapping[str, Truth], ours: Mapping[str, Result]) -> dict[str, list[dict[str, Any]]]:
    found = {}
    for source in sorted({str(truth["source"]) for truth in answers.values()}):
        found[source] = shown(figures(score({n: t for n, t in answers.items() if t["source"] == source}, ours)))
    return found


def _case(name: str, truth: Truth, result: Result | None) -> dict[str, Any]:
    """One recording in a line: what was hidden, what was said."""
    answer = Answer.of(result)
    hidden = sorted(truth["mechanisms"])
    if truth["group"] == OUTSIDE:
        families = {FAMILY.get(one, "") for one in answer.said}
        right = answer.label not in ("nothing", "no result") and families <= set(truth["families"])
    elif truth["group"] in MACHINE_GROUPS:
        right = right_of_machine(truth, result)
    elif hidden:
        right = sorted(answer.said) == hidden
    else:
        right = answer.label == "nothing"
    return {
        "name": name,
        "group": truth["group"],
        "source": truth["source"],
        "setting": truth["setting"],
        "channels": truth["channels"],
        "points": truth["points"],
        "hidden": hidden,
        "said": answer.label,
        "near": sorted(answer.near - set(answer.said)),
        "right": right,
        "loss": truth["base_chi2_excess"],
        "r2": min(truth["base_r2"]),
    }


def _must_fail(answers: Mapping[str, Truth], seed: int) -> list[dict[str, Any]]:
    """What diagnosers that look at nothing would have scored on the same recordings."""
    chance = random.Random(seed)
    answering: list[Callable[[Truth], list[str]]] = [
        lambda truth: chance.choice([[], [chance.choice(KINDS)]]),
        lambda truth: ["stribeck"],
        lambda truth: list(KINDS),
        lambda truth: [] if min(truth["base_r2"]) > PLAUSIBLE_R2 else ["stribeck"],
    ]
    found = []
    for (name, about), says in zip(MUST_FAIL.items(), answering, strict=True):
        results = {file: _bare(says(truth)) for file, truth in sorted(answers.items())}
        scores = score(answers, results)
        found.append(
            {
                "name": name,
                "about": about,
                **{key: asdict(getattr(scores, key)) for key in ("named", "false_alarms", "misled")},
            }
        )
    return found


def _bare(names: list[str]) -> dict[str, Any]:
    return {"verdict": "missing_physics" if names else "adequate", "mechanisms": [{"name": name} for name in names]}
