"""One way of the proof on all ways, unsealed: what is hidden, what is said, how far numbers are off.

How far is in errors that count what could hide, where that is said.
"""

import math
import tempfile
from pathlib import Path
from typing import Any

import harness
from benchmarks.draws.shared import Answer
from harness.core.errors import HarnessError
from harness.proof.paths.files import unpacked
from harness.proof.paths.forms import PATHS
from harness.proof.paths.made import CONTROL, FORM, UNKNOWN, forms_of, made, shapes_of
from harness.proof.paths.score import outcome, right

NAMES = {path.replace(" ", "-"): path for path in PATHS}


def answer(seed: int, number: int, *, path: str) -> Answer:
    """Every other one a control, of the others every fourth an effect of no name; right as the proof has it."""
    turn = number // 2
    group = CONTROL if number % 2 == 0 else UNKNOWN if turn % 4 == 3 else FORM
    names = {CONTROL: [""], UNKNOWN: shapes_of(path), FORM: forms_of(path)}[group]
    one = made(seed, number, path, group, names[turn % len(names)])
    files, told = unpacked(one.recording) or {}, one.answer["arguments"]
    about = f"{one.answer['form'] or 'nothing'}, worth {one.answer['loss']:.3g}, {' '.join(told) or 'no options'}: "
    with tempfile.TemporaryDirectory() as folder:
        places = [Path(folder) / name for name in files]
        for place, text in zip(places, files.values(), strict=True):
            place.write_text(text, encoding="utf-8")
        options = dict(zip((name.removeprefix("--") for name in told[::2]), told[1::2], strict=True))
        try:
            found = harness.diagnose(places if len(places) > 1 else places[0], engines=(), **options)
        except HarnessError as error:
            return Answer(False, about + str(error))
    said: dict[str, Any] = found.model_dump(mode="json")
    off = {
        name: round((p.value - one.answer["base"][name]) / math.hypot(p.stderr, p.systematic or 0.0), 1)
        for name, p in found.refined.parameters.items()
        if name in one.answer["base"] and p.value is not None and p.stderr
    }
    likely = [(" + ".join(h.names), round(h.probability, 2)) for h in found.posterior[:3]]
    what = f"{outcome(one.answer, said)}, {found.verdict} {[m.name for m in found.mechanisms]}, {likely}, errors {off}"
    return Answer(right(one.answer, said), about + what)
