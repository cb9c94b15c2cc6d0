"""A recording made ready to be diagnosed, or refused with the reason."""

import math

import numpy as np

from harness.app.diagnose_checks import compare_channels, refuse
from harness.app.diagnose_options import DiagnoseOptions
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.baseline import dominant_frequency
from harness.diagnosis.problem import Problem
from harness.estimate.noise import channel_noise
from harness.model.model import Restoring

_UNBUILT = "a free decay on a spring, with x measured from where it is unstretched, is accepted by this version"


def problem_of(recording: Recording, options: DiagnoseOptions) -> tuple[Problem, tuple[str, ...]]:
    """Channels with their noise, what was asked, and warnings.

    Raises InputError for a recording that cannot be diagnosed, and for options that do not go with it.
    """
    driven = "u" in recording and bool(np.any(recording["u"] != 0.0))
    if options.restoring is Restoring.NONE and not driven:
        found = "none, but no force u is recorded" if "u" not in recording else "none, but the force u is 0 throughout"
        raise InputError("--restoring", f"{found} in {recording.file}", "a recorded force, or spring, is accepted")
    if driven:
        raise InputError(f"{recording.file}: channel u", "a driven recording", _UNBUILT)
    if options.zero_free:
        raise InputError("--zero", "free", _UNBUILT)
    channels = {name: recording[name] for name in ("x", "v", "a") if name in recording}
    omega = dominant_frequency(recording.t, next(iter(channels.values())))
    known = math.isfinite(omega) and omega > 0.0
    noise = {
        name: channel_noise(recording.t, y, 2.0 * math.pi / omega if known else None) for name, y in channels.items()
    }
    refuse(recording, {name: found.sigma for name, found in noise.items()})
    doubt = compare_channels(recording, omega) if known else None
    problem = Problem(
        t=recording.t,
        channels=channels,
        noise=noise,
        mass=options.mass,
        restoring=options.restoring,
        zero_free=options.zero_free,
        angular=recording.angular,
    )
    return problem, () if doubt is None else (doubt,)
