"""One effect of the proof's bench alone in a free decay, in turn, every eleventh none: names that come near others."""

import numpy as np

import harness
from benchmarks.draws.shared import Answer
from harness.core.errors import HarnessError
from harness.core.recording import Recording
from harness.proof.plant.cases import draw

CONTROL = "control"
KINDS = (
    *("quadratic-stiffness", "sensor-gain", "asymmetric-viscous", "cubic-stiffness", CONTROL, "sensor-lag"),
    *("sensor-drift", "end-stop", "sensor-bias", "stiffness-drift", "constant-force"),
)


def answer(seed: int, number: int) -> Answer:
    """Right where it alone is named, and of a control nothing."""
    kind = KINDS[number % len(KINDS)]
    case = draw(kind, np.random.default_rng([seed, number]))
    recording = Recording(case.recorded["t"], {c: case.recorded[c] for c in case.channels}, kind)
    told = f"{kind} in {case.channels}"
    try:
        found = harness.diagnose(recording, zero="spring", engines=())
    except HarnessError as error:
        return Answer(False, f"{told}: {error}")
    listed = [m for m in found.mechanisms if m.grade not in ("minor", "tabulated")]
    names, near = [m.name for m in listed], [[a.name for a in m.alternatives] for m in listed]
    quiet, alone = found.verdict == "adequate", found.verdict == "missing_physics" and names == [kind]
    return Answer(quiet if kind == CONTROL else alone, f"{told}: {found.verdict} {names} beside {near}")
