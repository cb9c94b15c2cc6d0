"""The chance that a name which stands apart is the main effect of a fitted force: weights from driven machines."""

from functools import partial

from benchmarks.calibrate.calibration import Calibration
from benchmarks.calibrate.chance import Row, said
from benchmarks.calibrate.machine_draws import asked_of, drawn
from benchmarks.recordings.driven import DRIVEN
from harness.app.diagnose.problem import prepared
from harness.diagnosis.grading.chance import OF_FORCES
from harness.diagnosis.inverse_dynamics.search import search_driven
from harness.diagnosis.problems.driven import InverseDynamics
from harness.proof.machines.kinds import CONTROL, MAIN


def measure(seed: int, index: int) -> Row | None:
    """A new recording of a driven machine; None for one whose motion can be followed. Raises HarnessError."""
    control = index % 2 == 0
    recording, truth = drawn(seed, index, CONTROL if control else MAIN, DRIVEN)
    problem = prepared(recording, asked_of(truth)).problem
    if not isinstance(problem, InverseDynamics):
        return None
    return Row.of(search_driven(problem).graded, truth, control)


ABOUT = "how likely a name that stands apart is the main effect of a fitted force: the weights of what it hangs on"
CALIBRATION = Calibration(measure, partial(said, OF_FORCES), ABOUT)
