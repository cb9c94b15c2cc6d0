"""The estimators on a recording, and their estimates in the form of the results."""

import shlex
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.core.recording import Recording
from harness.estimate.every import estimate_all
from harness.estimate.result import Estimation
from harness.estimate.saturation import believed, without_limited
from harness.model.model import Model, Restoring
from harness.results.common import Swing
from harness.results.run import Estimates

NOTE = "Read as a pendulum: omega_n is that of small swings; reversals are those of a spring with the same parameters."


def as_spring(recording: Recording) -> Recording:
    """The recording of a pendulum as that of a spring with its parameters, from its release on.

    Raises InputError for what is no angle, and where no pendulum can be fitted.
    """
    if not recording.angular:
        found = f"pendulum, but {recording.file} holds no angle"
        raise InputError("--restoring", found, "a unit such as rad or deg, x[rad] in --columns")
    # imported when it is needed: a run's estimates do without the diagnosis and its compiler
    from harness.diagnosis.baseline.base_fit import baseline
    from harness.diagnosis.pipeline import prepare
    from harness.diagnosis.request import Asked

    try:
        problem, _ = prepare(recording, Asked(Restoring.PENDULUM))
        model = baseline(problem)[0].model
        moving = recording.cut(slice(int(np.searchsorted(recording.t, problem.t[0])), None))
        hanging, sprung = (_shown(one, moving) for one in (model, replace(model, restoring=Restoring.SPRING)))
    except SimulationError as error:
        raise InputError(recording.file, f"no pendulum fits: {error}", "a pendulum's free decay") from None
    channels = {c: y - hanging[c] + sprung[c] for c, y in moving.channels.items() if c in hanging}
    return replace(moving, channels=channels)


def _shown(model: Model, recording: Recording) -> dict[str, FloatArray]:
    """The motion channels of a model without noise, at the recording's times."""
    from harness.diagnosis.problems.free_decay import FreeDecay
    from harness.diagnosis.problems.simulated import observe

    names = [c for c in ("x", "v", "a") if c in recording]
    nothing: FloatArray = np.zeros(recording.t.size)
    return observe(model, FreeDecay(recording.t, dict.fromkeys(names, nothing), {})).y


def estimates_of(estimation: Estimation) -> dict[str, Estimates]:
    return {
        method: Estimates.taken_from(
            one, per_reversal=[each.as_dict() for each in one.per_reversal], guard_s=one.guard, lead_s=one.lead
        )
        for method, one in estimation.methods.items()
    }


WHOLE = {"acceleration": ("a", "v"), "displacement": ("x",)}
"""Methods that know both viscous and dry friction, with the channels they read; where they fail, nothing else holds."""


FREE = "a free decay of at least three half-cycles"


def estimate(recording: Recording, restoring: Swing = "spring") -> Estimation:
    """The estimates from a recording; a pendulum is read as the spring that it would be. See ``estimated``."""
    return estimated(recording, restoring)[0]


def estimated(recording: Recording, restoring: Swing = "spring") -> tuple[Estimation, Recording]:
    """The estimates from a recording, and what of it they were made from.

    Samples at which a sensor stood at the end of its range, or that stray, are left out, and a warning says so.

    Raises InputError with the reason when it is driven, or shows no free decay.
    """
    if "u" in recording and np.any(recording["u"] != 0.0):
        largest = float(np.max(np.abs(recording["u"])))
        found = f"a driven recording (a force of up to {largest:.3g} N acts), which is no free decay"
        raise InputError(f"{recording.file}: channel u", found, f"try: harness diagnose {shlex.quote(recording.file)}")
    recording, unused = without_limited(recording)
    recording, beyond = believed(recording, ("x", "v"))
    beyond, cleaned = (*unused, *beyond), recording
    if restoring == "pendulum":
        recording = as_spring(recording)
    x, v, a = (recording.channels.get(name) for name in ("x", "v", "a"))
    estimation = estimate_all(recording.t, x, v, a, unit="rad" if recording.angular else "m")
    wanted = [name for name, channels in WHOLE.items() if any(channel in recording for channel in channels)]
    tried = [estimation.methods[name] for name in wanted]
    if not any(one.zeta.value is not None and one.x_k.value is not None for one in tried):
        why = "; ".join(dict.fromkeys(one.x_k.why or "" for one in tried))
        raise InputError(recording.file, f"no estimate is possible: {why}", FREE)
    return replace(estimation, warnings=(*beyond, *estimation.warnings)), cleaned
