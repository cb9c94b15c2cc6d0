"""One way of the proof on all ways, unsealed: what is hidden, what is said, how far numbers are off.

How far is in standard errors, and in those that count what could hide, too.
"""

import json
import math
import tempfile
from contextlib import chdir
from typing import Any

from benchmarks.draws.shared import Answer
from harness.app.prove.blind_worker import answered
from harness.proof.paths.forms import PATHS
from harness.proof.paths.made import CONTROL, FORM, UNKNOWN, forms_of, made, shapes_of
from harness.proof.paths.score import changes, outcome, right
from harness.proof.tally import OURS

NAMES = {path.replace(" ", "-"): path for path in PATHS}


def answer(seed: int, number: int, *, path: str) -> Answer:
    """Every other one a control, of the others every fourth an effect of no name; right as the proof has it."""
    turn = number // 2
    group = CONTROL if number % 2 == 0 else UNKNOWN if turn % 4 == 3 else FORM
    names = {CONTROL: [""], UNKNOWN: shapes_of(path), FORM: forms_of(path)}[group]
    one = made(seed, number, path, group, names[turn % len(names)])
    told = one.answer["arguments"]
    of = "".join({name.partition(":")[0] for name in one.answer["right"] if ": " in name})
    about = f"{one.answer['form'] or 'nothing'}{of and ' in '}{of}"
    about += f", worth {one.answer['loss']:.3g}, {' '.join(told) or 'no options'}: "
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        said: dict[str, Any] = json.loads(answered(OURS, told, one.recording))
    if "error" in said:
        return Answer(False, about + said["error"])
    off = {
        name: "{:.1f} ({:.1f})".format(
            *(
                (p["value"] - one.answer["base"][name]) / math.hypot(p["stderr"], hides)
                for hides in (0.0, p.get("systematic") or 0.0)
            )
        )
        for name, p in said["refined"]["parameters"].items()
        if name in one.answer["base"] and p["value"] is not None and p["stderr"]
    }
    likely = [(" + ".join(h["names"]), round(h["probability"], 2)) for h in said["posterior"][:3]]
    names = [" of ".join(filter(None, (m["name"], m.get("joint")))) for m in said.get("found", said["mechanisms"])]
    changed = f", to change {sorted(changes(said))} of {one.answer['changes']}" if "changes" in one.answer else ""
    what = f"{outcome(one.answer, said)}, {said['verdict']} {names}, {likely}, errors {off}{changed}"
    return Answer(right(one.answer, said), about + what)
