"""A run-down told from a swing before anything is fitted, and made ready: cut to where it is let go and where it stops.

Its speed, read in windows, keeps one sign and falls. A slider on a spring turns round, or creeps back without: the
latter looks like a wheel with viscous friction alone, and is read as one unless a spring is asked for.
"""

import numpy as np

from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.moves.falling import falls
from harness.diagnosis.problems.run_down import RunDown
from harness.diagnosis.request import Asked
from harness.diagnosis.smoothed_state.local_cubics import longest_interval, smoothed
from harness.diagnosis.starts import AtSpeed, OneStart
from harness.estimate.noise import Stamps, channel_noise
from harness.estimate.saturation import believed

_FINE, _WIDTHS, _CUBIC = 256, (12, 40), 3
"""Windows whose noise is looked at, samples of one, and what is taken off it."""
ONE_WAY = (
    "a run-down in one direction: f_k holds whatever pushes steadily against it besides, a grade, a tilt or an offset"
    " (a second one in the other direction would part them)"
)
RATIOS = "without --mass, or --inertia, only ratios to it are identifiable: c/m and f_k/m"


def run_down_problem(recording: Recording, asked: Asked) -> tuple[RunDown, tuple[str, ...]]:
    """A run-down as a problem, and what was done to it, one sentence each.

    Raises InputError for options that contradict the recording and where nothing runs down.
    """
    span = falls(recording)
    if span is None:
        found = "none, but no force u is recorded" if "u" not in recording else "none, but the force u is 0 throughout"
        accepted = "a recorded force, a run-down (whose speed falls from first to last), or spring is accepted"
        raise InputError("--restoring", f"{found} in {recording.file}", accepted)
    if asked.covariates:
        raise InputError("--covariates", f"given with a run-down, {recording.file}", "a swing or a force is accepted")
    begin, end = span
    t, notes = recording.t, []
    if begin > 0:
        notes.append(f"the first {t[begin] - t[0]:.4g} s, before it runs down, are left out")
    if end < t.size:
        notes.append(f"the last {t[-1] - t[end - 1]:.4g} s, a long rest, are left out")
    cut, beyond = believed(recording.cut(slice(begin, end)), ("x", "v"))
    channels = {c: cut[c] for c in ("x", "v") if c in cut}
    noise = {c: channel_noise(cut.t, y) for c, y in channels.items()}
    width = int(np.clip(cut.t.size // _FINE, *_WIDTHS))
    longest = longest_interval(cut.t)
    slope = {c: smoothed(cut.t, y, longest, noise[c].sigma).slope for c, y in channels.items()}
    problem = RunDown(
        cut.t,
        channels,
        noise,
        mass=asked.mass,
        angular=cut.angular,
        starts=OneStart() if "x" in channels else AtSpeed(),
        level={c: Stamps.of(cut.t, y, slope[c], noise[c], width, _CUBIC).level for c, y in channels.items()},
    )
    return problem, (*beyond, *notes, ONE_WAY, *(() if asked.mass else (RATIOS,)))
