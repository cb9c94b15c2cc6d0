"""What a fitted force says of a robot's joint whose reversals are left out, by how much is left out beside them."""

from collections.abc import Iterator, Sequence

import numpy as np

from harness.app.calibrate.calibration import Calibration, head, quantiles, stands
from harness.app.diagnose.joint import options_of
from harness.app.diagnose.problem import asked_of
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.inverse_dynamics.force_fit import fit_force
from harness.diagnosis.inverse_dynamics.measured import Measured
from harness.diagnosis.pipeline import prepare
from harness.diagnosis.problems.driven import Forced
from harness.diagnosis.rules import GUARD
from harness.engines.models import folder
from harness.robot.arm import load_arm
from harness.robot.coupling import coupling
from harness.robot.example import Friction, excited
from harness.robot.recording import one_joint

_WIDTHS = (0.0, 0.01, 0.02, 0.04, 0.08)
"""s: what is tried; 0 leaves out what has no sure speed alone."""
_DURATION = 12.0
"""s."""
_SMALL = 0.01
"""Share of f_k and of c by which they may be off."""


def measure(seed: int, index: int) -> dict[float, tuple[float, float]] | None:
    """By width, the errors of f_k and c as shares, of a joint of the arm with friction that is drawn."""
    random = np.random.default_rng([seed, 7, index])
    arm = load_arm(folder() / "arm" / "arm.xml")
    joint = arm.joints[index % len(arm.joints)]
    own = Friction(float(random.uniform(0.3, 1.2)), float(random.uniform(0.1, 0.5)))
    log = excited(arm, {joint: own}, (joint,), _DURATION, seed=int(random.integers(1 << 30)))
    one = one_joint(log, coupling(arm, log, joint).reduced)
    problem, _ = prepare(one.recording, asked_of(options_of(one)))
    if not isinstance(problem, Forced):
        return None
    names = tuple(name for name in problem.base_names if name not in problem.starts.names)
    found = {}
    for width in _WIDTHS:
        measured = Measured.of(problem, width)
        model = fit_force(problem.first, measured, free_of(problem.first, names)).model
        found[width] = (abs(model.f_k / own.f_k - 1.0), abs(model.c / own.c - 1.0))
    return found


def said(rows: Sequence[dict[float, tuple[float, float]]]) -> Iterator[str]:
    """Quantiles of both errors by width."""
    yield head("error of f_k and c, shares")
    for width in _WIDTHS:
        for i, name in enumerate(("f_k", "c")):
            yield quantiles(f"{name}, {1e3 * width:.0f} ms", [row[width][i] for row in rows])
    least = min(_WIDTHS, key=lambda width: abs(width - GUARD.value))
    middle = [float(np.median([row[least][i] for row in rows])) for i in range(2)]
    yield stands(GUARD, max(middle) < _SMALL, f"half of the draws are within {middle[0]:.2g} and {middle[1]:.2g}")


CALIBRATION = Calibration(measure, said, "what is left out beside the reversals of a robot's joint")
