"""What does not hold in a published proof: chain, commitments, verdicts, names, recordings drawn again."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

from harness.core.errors import InputError, SimulationError
from harness.proof.drawing import Drawn, drawn, name_of, probes_of, sealed_answers
from harness.proof.machines.cases import Sealed as SealedMachine
from harness.proof.paths.files import numbers_in
from harness.proof.paths.forms import ARM, AXIS, JOINT, SERVO
from harness.proof.plan import MACHINE, PATH, Job, Sizes, plan
from harness.proof.real.made import Rig, rigs_of
from harness.proof.seal import PUBLISHED, RESUMED, STEPS, Ledger, Sealed, digest

ROUNDING = 1e-6
"""Relative difference that another processor may make in a number that is computed again."""
NOTHING = 1e-12
"""What is none, of a number in SI or of a share."""
MOTION_ROUNDING = 1e-4
"""The same in a recording, of a channel's size. Where bristles are stiff another processor's solver takes other steps:
by up to 4e-5 of an acceleration, of 992 recordings; the others are within 3e-6."""
FITTED = (
    *("base_chi2_excess", "base_r2", "part_chi2_excess"),
    *("share", "minor", "sums_up", "base_rel_rmse", "base_rmse", "weights"),
)
FIT_ROUNDING = 1e-2
"""The same for numbers that come out of a fit."""
OF_WORTH, WORTH_ROUNDING = ("loss", "numbers", "projects"), 5e-2
"""What is scaled until an effect is worth so much, and the same for that: of 206 recordings up to 4 %."""
TWICE_LOSS = "base_chi2_excess"
"""What it is on all ways, so that it needs no look."""
LOOPED = (AXIS, JOINT, SERVO, ARM)
"""Ways under a controller on an encoder. A count that flips there is another motion from then on, of which the times
alone are the same: all of 16 arms, and one of 48 others.
"""
_ROUNDINGS = dict.fromkeys(FITTED, FIT_ROUNDING) | dict.fromkeys(OF_WORTH, WORTH_ROUNDING)
MOST_ELSEWHERE, FEW = 0.05, 2
"""Share of recordings, and a number that is always few, whose fits may end elsewhere on another processor: 13 of 600
machines, 2 of 992 others."""


def is_unfinished(ledger: Ledger) -> bool:
    """Whether a transcript that nobody changed ends before the last step, as one does whose proof was stopped."""
    steps = [entry.get("step") for entry in ledger.entries if entry.get("step") != RESUMED]
    return ledger.broken_at() is None and len(steps) <= len(STEPS) and steps == list(STEPS[: len(steps)])


def check_transcript(ledger: Ledger) -> list[str]:
    """Chain, order, seed, answers and names; one sentence for each that does not hold."""
    broken = ledger.broken_at()
    if broken is not None:
        return [f"entry {broken + 1} of the transcript was changed"]
    steps = [entry.get("step") for entry in ledger.entries if entry.get("step") != RESUMED]
    if tuple(steps[:4]) != STEPS or steps[4:] not in ([], [PUBLISHED]):
        return ["the steps of the transcript are not in their order"]
    with _holding() as wrong:
        committed, sealed, said, opened = (ledger.content(step) for step in STEPS)
        if Sealed(**opened["seed"]).commitment != committed["commitment"]:
            wrong.append("the seed is not the one that was committed to")
        names = set(sealed["cases"])
        others = said.get("baselines", {})
        if any(names != set(cases) for cases in (said["cases"], opened["answers"], *others.values())):
            wrong.append("recordings, verdicts and answers are not of the same cases")
            return wrong
        for name in sorted(names):
            if Sealed(**opened["answers"][name]).commitment != sealed["cases"][name]["answer"]:
                wrong.append(f"{name}: the answer is not the one that was sealed")
    return wrong


@contextmanager
def _holding() -> Iterator[list[str]]:
    """What is found wrong inside; a transcript that has not what is looked at is wrong too."""
    wrong: list[str] = []
    try:
        yield wrong
    except (KeyError, TypeError, ValueError, AttributeError, InputError) as error:
        wrong[:] = [f"the transcript does not hold what one holds ({type(error).__name__}: {error})"]


def check_plan(ledger: Ledger) -> list[str]:
    """Whether cases, names and salts are those that follow from the seed; jobs that were given up may be missing."""
    with _holding() as wrong:
        opened = ledger.content(STEPS[3])
        seed, answers = int(opened["seed"]["value"]), opened["answers"]
        have = len(answers) + len(opened.get("given_up", []))
        sizes = Sizes.of(ledger.content(STEPS[0])["sizes"])
        if sizes.total > have:  # said before anything of that size is made
            return [f"{sizes.total - have} recordings of the plan are missing"]
        planned = {job.index: name_of(seed, job.index) for job in planned_jobs(ledger)}
        salts = sealed_answers(seed, {name: one["value"] for name, one in answers.items()})
        for name, one in sorted(answers.items()):
            if planned.get(one["value"]["index"]) != name:
                wrong.append(f"{name}: no recording of the plan has this name")
            elif salts[name].salt != one["salt"]:
                wrong.append(f"{name}: its salt does not follow from the seed")
        if len(planned) > have:
            wrong.append(f"{len(planned) - have} recordings of the plan are missing")
    return wrong


def planned_jobs(ledger: Ledger) -> list[Job]:
    sizes = Sizes.of(ledger.content(STEPS[0])["sizes"])
    return plan(sizes, int(ledger.content(STEPS[3])["seed"]["value"]), sealed_rigs(ledger))


def sealed_rigs(ledger: Ledger) -> list[Rig]:
    """Recordings of real machines that a proof was begun with."""
    return rigs_of(ledger.content(STEPS[0]).get("rigs", []))


def check_verdicts(ledger: Ledger, who: str | None, verdicts: Mapping[str, bytes]) -> list[str]:
    """Whether verdicts are those that were sealed; who : None for ours, else one of the other diagnosers."""
    said = ledger.content(STEPS[2])
    known = said["cases"] if who is None else said["baselines"][who]
    by = "" if who is None else f" of {who}"
    wrong = [f"{name}: the verdict{by} is missing" for name in sorted(set(known) - set(verdicts))]
    wrong += [f"{name}: a verdict{by} that was not sealed" for name in sorted(set(verdicts) - set(known))]
    changed = [name for name in sorted(set(known) & set(verdicts)) if digest(verdicts[name]) != known[name]]
    return wrong + [f"{name}: the verdict{by} was changed" for name in changed]


@dataclass(frozen=True, slots=True)
class Redrawn:
    """A recording drawn again: the same to the last bit, and what else is wrong with it ("" for nothing).

    elsewhere : it is the same but for what fits decide, which end elsewhere here.
    """

    name: str
    identical: bool
    wrong: str
    elsewhere: bool = False


def check_recording(ledger: Ledger, case: Drawn, job: Job) -> Redrawn:
    """Whether a recording drawn again is the one that was sealed, up to the rounding of another processor."""
    found = _checked(ledger, case)
    if not found.wrong:
        return found
    again = case
    if job.source == MACHINE:
        # drawn again with what fits decide as its answer has it
        opened = ledger.content(STEPS[3])
        try:
            sealed = SealedMachine.of(opened["answers"].get(case.name, {}).get("value", {}))
            again = drawn(int(opened["seed"]["value"]), job, sealed)
        except (SimulationError, InputError):
            return found
    but_for_fits = _checked(ledger, again, without=FITTED)
    return found if but_for_fits.wrong else replace(but_for_fits, identical=False, elsewhere=True)


def too_many_elsewhere(found: Sequence[Redrawn]) -> list[str]:
    """A sentence for each recording whose fits end elsewhere, where these are more than another processor makes."""
    elsewhere = [one.name for one in found if one.elsewhere]
    if len(elsewhere) <= max(FEW, MOST_ELSEWHERE * len(found)):
        return []
    return [f"{name}: what fits say of it is not what follows from the seed" for name in elsewhere]


def _checked(ledger: Ledger, case: Drawn, without: Sequence[str] = ()) -> Redrawn:
    sealed = ledger.content(STEPS[1])["cases"].get(case.name)
    opened = ledger.content(STEPS[3])["answers"].get(case.name)
    if sealed is None or opened is None:
        return Redrawn(case.name, False, f"{case.name}: not among the recordings of the transcript")
    answer = json.loads(json.dumps(dict(case.answer)))
    if digest(case.recording) == sealed["recording"] and answer == opened["value"]:
        return Redrawn(case.name, True, "")
    of_path = case.answer.get("source") == PATH
    looped = of_path and case.answer.get("setting") in LOOPED
    if not _lines_agree(sealed.get("lines", []), probes_of(case.recording), looped):
        return Redrawn(case.name, False, f"{case.name}: the recording is not the one that follows from the seed")
    left_out = (*without, TWICE_LOSS) if of_path else without
    known, again = ({k: one for k, one in said.items() if k not in left_out} for said in (opened["value"], answer))
    if not agrees(known, again):
        return Redrawn(case.name, False, f"{case.name}: the answer is not the one that follows from the seed")
    return Redrawn(case.name, False, "")


def _lines_agree(sealed: Sequence[str], again: Sequence[str], looped: bool) -> bool:
    if len(sealed) != len(again) or not sealed or sealed[0] != again[0]:
        return False
    old, new = ([numbers_in(line) for line in lines[1:]] for lines in (sealed, again))
    # what holds several files, or words above the numbers, has rows of several widths
    if [len(row) for row in old] != [len(row) for row in new]:
        return False
    if looped:
        old, new = ([row[:1] for row in rows] for rows in (old, new))
    old, new = ([[*row, *(0.0 for _ in range(max(map(len, old)) - len(row)))] for row in rows] for rows in (old, new))
    scale = [max(map(abs, column)) for column in zip(*old, strict=True)]
    return all(
        abs(a - b) <= MOTION_ROUNDING * size
        for one, other in zip(old, new, strict=True)
        for a, b, size in zip(one, other, scale, strict=True)
    )


def agrees(known: Any, again: Any, rounding: float = ROUNDING) -> bool:
    """Whether two answers, or two sets of scores, are the same but for rounding."""
    if isinstance(known, dict) and isinstance(again, dict):
        return known.keys() == again.keys() and all(
            agrees(known[key], again[key], _ROUNDINGS.get(key, rounding)) for key in known
        )
    if isinstance(known, list) and isinstance(again, list):
        return len(known) == len(again) and all(agrees(a, b, rounding) for a, b in zip(known, again, strict=True))
    if isinstance(known, float) and isinstance(again, int | float) and not isinstance(again, bool):
        return math.isclose(known, again, rel_tol=rounding, abs_tol=NOTHING)
    return bool(known == again)
