"""Everything a proof says, computed from answers and verdicts alone, so that anybody can compute it again."""

import json
import random
from collections.abc import Callable, Mapping
from typing import Any

from harness.proof.beside import beside, shortfalls
from harness.proof.detection import curve
from harness.proof.machines import score as of_machines
from harness.proof.machines.kinds import GROUPS as MACHINE_GROUPS
from harness.proof.paths import score as of_paths
from harness.proof.paths.made import GROUPS as PATH_GROUPS
from harness.proof.plan import CONTROL, DETECTION, OUTSIDE, PAIR, SINGLE
from harness.proof.plant.effects import KINDS
from harness.proof.real import score as of_real
from harness.proof.real.made import GROUPS as REAL_GROUPS
from harness.proof.score import Answer, Result, Truth, forced, of_another_family, score
from harness.proof.statistics import figures

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
    steps = {name: truth for name, truth in answers.items() if truth["group"] == DETECTION}
    on_paths = {name: truth for name, truth in answers.items() if truth["group"] in PATH_GROUPS}
    rows = scores.figures if scored else []
    rows += of_paths.found(on_paths, ours) if on_paths else []
    of_rigs = {name: truth for name, truth in answers.items() if truth["group"] in REAL_GROUPS}
    rows += of_real.found(of_rigs, ours) if of_rigs else []
    if machines:
        rows += figures(of_machines.score(machines, ours), of_machines.ASKED, "machines_")
    short = [row.sentence for row in rows if row.met is False]
    any_control = any(truth["group"] == CONTROL for truth in scored.values())
    short += [*(controls.shortfalls() if any_control else []), *shortfalls(margins)]
    by_source: dict[str, list[dict[str, Any]]] = {}
    for source in sorted({str(truth["source"]) for truth in scored.values()}):
        own = score({name: truth for name, truth in scored.items() if truth["source"] == source}, ours)
        by_source[source] = [row.as_dict() for row in own.figures]
    return {
        "figures": [row.as_dict() for row in rows],
        "forced": controls.as_dict(),
        "confusion": {true: dict(sorted(said.items())) for true, said in sorted(scores.confusion.items())},
        "by_name": {name: rate.as_dict() for name, rate in scores.by_name.items()},
        "not_tested": list(scores.not_tested) if scored else [],
        "shortfalls": short,
        "by_source": by_source,
        "must_fail": _must_fail(scored, seed) if scored else [],
        "baselines": [one.model_dump() for one in margins],
        "detection": curve(steps, ours).model_dump() if steps else None,
        "paths": of_paths.paths(on_paths, ours).model_dump() if on_paths else None,
        "real": of_real.real(of_rigs, ours).model_dump() if of_rigs else None,
        "cases": [_case(name, answers, ours) for name in sorted(answers)],
    }


def _case(name: str, answers: Mapping[str, Truth], results: Mapping[str, Result]) -> dict[str, Any]:
    """One recording in a line: what was hidden, what was said."""
    truth, result = answers[name], results.get(name)
    answer = Answer.of(result)
    hidden = sorted(truth["mechanisms"])
    if truth["group"] == OUTSIDE:
        right = answer.label not in ("nothing", "no result") and not of_another_family(answer, truth)
    elif truth["group"] in MACHINE_GROUPS:
        right = of_machines.right(truth, result)
    elif truth["group"] in PATH_GROUPS:
        right = of_paths.right(truth, result)
    elif truth["group"] in REAL_GROUPS:
        right = of_real.right(name, answers, results)
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
        "said": of_real.said(result) if truth["group"] in REAL_GROUPS else answer.label,
        "near": sorted(answer.near - set(answer.said)),
        "right": right,
        "loss": truth["base_chi2_excess"],
        "r2": min(truth["base_r2"], default=None),
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
        said = {file: says(truth) for file, truth in sorted(answers.items())}
        scores = score(
            answers,
            {
                file: {
                    "verdict": "missing_physics" if names else "adequate",
                    "mechanisms": [{"name": one} for one in names],
                }
                for file, names in said.items()
            },
        )
        rates = {key: scores.found[key].as_dict() for key in ("named", "false_alarms", "misled")}
        found.append({"name": name, "about": about, **rates})
    return found
