"""The estimators on a pendulum: they know a spring, so they are shown the spring that the pendulum would be.

A pendulum swings slower the farther it swings, and its energy is k (1 - cos x). Its base model is fitted to the
recording with exact events; what it leaves is laid over the motion of a spring with the same parameters, and that is
what the methods read: a linearisation of the recording about its fit, after which period, energy and jumps are those
that the methods know.
"""

from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.core.recording import Recording
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.fit.observe import observe
from harness.diagnosis.pipeline import prepare
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.request import Asked
from harness.model.model import Model, Restoring

NOTE = "Read as a pendulum: omega_n is that of small swings; reversals are those of a spring with the same parameters."


def as_spring(recording: Recording) -> Recording:
    """The recording of a pendulum as that of a spring with its parameters, from its release on.

    Raises InputError for what is no angle, and where no pendulum can be fitted.
    """
    if not recording.angular:
        found = f"pendulum, but {recording.file} holds no angle"
        raise InputError("--restoring", found, "a unit such as rad or deg, x[rad] in --columns, is accepted with it")
    try:
        problem, _ = prepare(recording, Asked(Restoring.PENDULUM))
        model = baseline(problem)[0].model
        moving = recording.cut(slice(int(np.searchsorted(recording.t, problem.t[0])), None))
        hanging, sprung = (_shown(one, moving) for one in (model, replace(model, restoring=Restoring.SPRING)))
    except SimulationError as error:
        raise InputError(recording.file, f"no pendulum fits: {error}", "a pendulum's free decay is accepted") from None
    channels = {c: y - hanging[c] + sprung[c] for c, y in moving.channels.items() if c in hanging}
    return replace(moving, channels=channels)


def _shown(model: Model, recording: Recording) -> dict[str, FloatArray]:
    """The motion channels of a model without noise, at the recording's times."""
    names = [c for c in ("x", "v", "a") if c in recording]
    nothing: FloatArray = np.zeros(recording.t.size)
    return observe(model, FreeDecay(recording.t, dict.fromkeys(names, nothing), {})).y
