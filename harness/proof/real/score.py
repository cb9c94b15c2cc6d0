"""How well verdicts on real machines match what was constructed or switched.

Nobody knows what a real machine does besides: what is scored is the difference of two verdicts, of the recording as it
was measured and of the one with the effect, or of two conditions of a machine.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.proof.machines.score import Claim
from harness.proof.real.made import CONSTRUCTED, REPEATED, SWITCHED, UNTOUCHED
from harness.proof.statistics import Asked, Figure, Rate, figures
from harness.results.prove import RealMachine, RealResult

Truth = Mapping[str, Any]
Result = Mapping[str, Any]
RIGHT, LISTED, SILENT, WRONG = "right", "listed", "silent", "wrong"
MOVED, STAYED = 3.0, 2.0
"""Standard errors beyond which a number has moved, and within which it has stayed."""
LONGEST = 3
"""Names of a list that still says something."""
BASE = ("omega_n", "zeta", "x_k", "mass", "c", "f_k")
ASKED = {
    "switched": Asked("switched: the cause first, its number alone moves", "at least 80 %", least=0.8),
    "switched_wrong": Asked("switched: another cause", "at most 5 %", most=0.05),
    "repeats": Asked("same condition called different", "at most 5 %", most=0.05),
    "told": Asked("constructed laws: named or listed"),
    "moved": Asked("constructed gain, clock, damping: its number alone moves"),
    "wrong": Asked("constructed: another law, or another number"),
    "alarms": Asked("constructed delay: called different"),
}


@dataclass(frozen=True, slots=True)
class Difference:
    """claimed : names that the second has and the first has not, or numbers said to have changed. listed : names of a
    list that is not the first's. errors : of each number, by how many standard errors it moved."""

    claimed: frozenset[str]
    listed: frozenset[str]
    errors: Mapping[str, float]

    @classmethod
    def of_conditions(cls, result: Result) -> "Difference":
        """Read a harness.change/1 object."""
        return cls(frozenset(result["changed"]), frozenset(), {one["name"]: _moved(one) for one in result["numbers"]})

    @classmethod
    def of_two(cls, before: Result, after: Result) -> "Difference":
        """Read two harness.diagnosis/2 objects. A law that both have counts by its numbers, as NAME.NUMBER."""
        was, now = Claim.of(before), Claim.of(after)
        had, has = _mains(before), _mains(after)
        shown = now.near if not has and len(now.near) <= LONGEST else frozenset[str]()
        first, last = _numbers(before), _numbers(after)
        errors = {}
        for name in first.keys() & last.keys():
            (a, da), (b, db) = first[name], last[name]
            errors[name] = (b - a) / math.hypot(da, db)
        return cls(has - had, frozenset() if shown <= was.near else shown, errors)


def _moved(number: Mapping[str, Any]) -> float:
    ratio = number["ratio"]
    if ratio.get("value") is not None and ratio.get("stderr"):
        return float(ratio["value"] - 1.0) / float(ratio["stderr"])
    if not number["changed"] or not number.get("before") or not number.get("after"):
        return 0.0
    # there was none of it before
    return math.copysign(math.inf, abs(number["after"]["value"]) - abs(number["before"]["value"]))


def _mains(result: Result) -> frozenset[str]:
    """What is said to be there: a part beside an unexplained rest too, as the rest is the machine's own."""
    return frozenset(m["name"] for m in result.get("mechanisms", []) if m.get("grade") in ("main", "explains", "part"))


def _numbers(result: Result) -> dict[str, tuple[float, float]]:
    """Value and standard error of the base's numbers, and of each law that is claimed."""
    base = (result.get("refined") or {}).get("parameters") or {}
    every = {name: p for name, p in base.items() if name in BASE}
    for m in result.get("mechanisms", []):
        if m["name"] in _mains(result):
            every |= {f"{m['name']}.{name}": p for name, p in m.get("parameters", {}).items()}
    told = {name: (p.get("value"), p.get("stderr")) for name, p in every.items()}
    return {name: (float(value), float(error)) for name, (value, error) in told.items() if value is not None and error}


def difference(
    truth: Truth, truths: Mapping[str, Truth], results: Mapping[str, Result], name: str
) -> Difference | None:
    """What a verdict says beside the one that it is compared with; None where one of the two failed."""
    after = results.get(name)
    if after is None or after.get("verdict") == "error":
        return None
    if truth["group"] != CONSTRUCTED:
        return Difference.of_conditions(after) if "changed" in after else None
    same = (n for n, one in truths.items() if one["group"] == UNTOUCHED and one["files"] == truth["files"])
    before = results.get(next(same, ""))
    return None if before is None or before["verdict"] == "error" else Difference.of_two(before, after)


def outcome(truth: Truth, found: Difference | None) -> str:
    """Right, listed, silent or wrong. Of what nothing is to be told of, silent is right."""
    if found is None:
        return SILENT
    right, moves = set(truth["right"]), truth["moves"]
    if right:
        if found.claimed:
            return RIGHT if found.claimed <= right else WRONG
        if found.listed:
            return LISTED if found.listed & right else WRONG
        laws = [z for name, z in found.errors.items() if name.partition(".")[0] in right]
        return RIGHT if any(abs(z) > MOVED for z in laws) else SILENT

    own = {name: z * sign for name, z in found.errors.items() for one, sign in moves.items() if _is_of(name, one)}
    beside = {name: abs(z) for name, z in found.errors.items() if name not in own}
    # of two conditions a number has changed where that is claimed
    compared = truth["group"] != CONSTRUCTED
    changed = found.claimed if compared else {name for name, z in beside.items() if z > MOVED} | found.claimed
    moved = max(own.values(), default=0.0)
    if changed - own.keys() or (changed and moved <= 0.0):
        return WRONG
    told = moved > MOVED and (bool(changed) or not compared)
    return RIGHT if told and max(beside.values(), default=0.0) <= STAYED else SILENT


def _is_of(name: str, switched: str) -> bool:
    return name == switched or name.startswith(f"{switched}.")


def outcomes(truths: Mapping[str, Truth], results: Mapping[str, Result]) -> dict[str, str]:
    """By recording, without those that nothing was done to."""
    return {
        name: outcome(truth, difference(truth, truths, results, name))
        for name, truth in sorted(truths.items())
        if truth["group"] != UNTOUCHED
    }


def found(truths: Mapping[str, Truth], results: Mapping[str, Result]) -> list[Figure]:
    """Figures that have cases, with intervals over machines; see ``not_run`` for the others."""
    kept = _kept(truths, outcomes(truths, results))
    with_cases = {key: asked for key, asked in ASKED.items() if kept[key]}
    return figures({key: Rate.over(kept[key]) for key in with_cases}, with_cases, "real_")


def _kept(truths: Mapping[str, Truth], said: Mapping[str, str]) -> dict[str, dict[str, list[bool]]]:
    """Figure, machine, whether it counts."""
    kept: dict[str, dict[str, list[bool]]] = {key: {} for key in ASKED}
    for name, what in said.items():
        truth = truths[name]
        for key, counts in _counted(truth, what).items():
            kept[key].setdefault(truth["machine"], []).append(counts)
    return kept


def _counted(truth: Truth, what: str) -> dict[str, bool]:
    if truth["group"] == SWITCHED:
        return {"switched": what == RIGHT, "switched_wrong": what == WRONG}
    if truth["group"] == REPEATED:
        return {"repeats": what == WRONG}
    if not truth["right"] and not truth["moves"]:
        return {"alarms": what == WRONG}
    return {"told" if truth["right"] else "moved": what in (RIGHT, LISTED), "wrong": what == WRONG}


def not_run(truths: Mapping[str, Truth]) -> list[str]:
    """What the files could not be asked, a sentence each."""
    groups = {truth["group"] for truth in truths.values()}
    need = {
        CONSTRUCTED: "constructed effects: not run, no free decay and no driven axis with a position",
        SWITCHED: "switched causes: not run, no machine in two conditions whose number that moves is told",
        REPEATED: "repeats: not run, no machine recorded twice in one condition",
    }
    return [sentence for group, sentence in need.items() if group not in groups]


def real(truths: Mapping[str, Truth], results: Mapping[str, Result]) -> RealResult:
    """Machine by machine."""
    every = outcomes(truths, results)
    machines = []
    for machine in sorted({truth["machine"] for truth in truths.values()}):
        own = {name: truth for name, truth in truths.items() if truth["machine"] == machine}
        kept = _kept(own, {name: every[name] for name in own if name in every})
        rates = {key: Rate.of(kept[key].get(machine, [])).as_dict() for key in ASKED}
        files = sum(truth["group"] == UNTOUCHED for truth in own.values())
        machines.append(RealMachine.model_validate({"machine": machine, "files": files} | rates))
    return RealResult(machines=machines, not_run=not_run(truths))


def right(name: str, truths: Mapping[str, Truth], results: Mapping[str, Result]) -> bool:
    """Whether a recording was answered as it should be; of an untouched one nobody knows."""
    truth = truths[name]
    if truth["group"] == UNTOUCHED:
        return True
    what = outcome(truth, difference(truth, truths, results, name))
    return what in (RIGHT, LISTED) if truth["right"] or truth["moves"] else what == SILENT


def said(result: Result | None) -> str:
    """What a verdict says, in a few words."""
    if result is None or result.get("verdict") == "error":
        return "no result"
    changed = result.get("changed")
    names = list(dict.fromkeys(m["name"] for m in result.get("mechanisms", [])) if changed is None else changed)
    return " + ".join(names) or "nothing"
