"""A run-down, or several, told from a swing before anything is fitted, and made ready: cut to its motion.

Its speed, read in windows, keeps one sign and falls. A slider on a spring turns round, or creeps back without: the
latter looks like a wheel with viscous friction alone, and is read as one unless a spring is asked for.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.moves.classify import classify
from harness.diagnosis.moves.falling import falls
from harness.diagnosis.moves.kinds import MotionKind
from harness.diagnosis.prepare.free_decay import in_common, said_once
from harness.diagnosis.problems.run_down import RunDown
from harness.diagnosis.problems.together import RunDownsTogether
from harness.diagnosis.request import Asked
from harness.diagnosis.smoothed_state.local_cubics import longest_interval, smoothed
from harness.diagnosis.starts import AtSpeed, OneStart
from harness.estimate.noise import Uneven, channel_noise
from harness.estimate.readings import words
from harness.estimate.saturation import believed
from harness.model.model import Restoring

_FINE, _WIDTHS, _CUBIC = 256, (12, 40), 3
"""Windows whose noise is looked at, samples of one, and what is taken off it."""
ONE_WAY = (
    "a run-down in one direction: f_k holds whatever pushes steadily against it besides, a grade, a tilt or an offset"
    " (a second one in the other direction parts them with --together)"
)
ONE_WAY_ALL = (
    "all run-downs go in one direction: f_k holds whatever pushes steadily against them, a grade, a tilt or an offset"
    " (--flip FILE turns the signs of one that went the other way and does not say so)"
)
RATIOS = "without --mass, or --inertia, only ratios to it are identifiable: c/m and f_k/m"


def run_down_problem(recording: Recording, asked: Asked) -> tuple[RunDown, tuple[str, ...]]:
    """A run-down as a problem, and what was done to it, one sentence each.

    Raises InputError for options that contradict the recording and where nothing runs down.
    """
    span = falls(recording)
    if span is None:
        found = "none, but no force u is recorded" if "u" not in recording else "none, but the force u is 0 throughout"
        accepted = "a recorded force, a run-down (whose speed falls from first to last), or spring"
        raise InputError("--restoring", f"{found} in {recording.file}", accepted)
    if asked.covariates:
        raise InputError("--covariates", f"given with a run-down, {recording.file}", "a swing or a force")
    begin, end = span
    t, notes = recording.t, []
    if begin > 0:
        notes.append(f"the first {t[begin] - t[0]:.4g} s, before it runs down, are skipped")
    if end < t.size:
        notes.append(f"the last {t[-1] - t[end - 1]:.4g} s, a long rest, are skipped")
    cut, beyond = believed(recording.cut(slice(begin, end)), ("x", "v"))
    channels = {c: cut[c] for c in ("x", "v") if c in cut}
    noise = {c: channel_noise(cut.t, y) for c, y in channels.items()}
    width = int(np.clip(cut.t.size // _FINE, *_WIDTHS))
    longest = longest_interval(cut.t)
    smooth = {c: smoothed(cut.t, y, longest, noise[c].sigma) for c, y in channels.items()}
    # where it is slow and samples are few, a slope is not nought because a cubic says so
    slope = {c: np.hypot(one.slope, one.slope_sd) for c, one in smooth.items()}
    uneven = {
        c: Uneven.of(c, cut.t, y, smooth[c].value, slope[c], noise[c], width, _CUBIC) for c, y in channels.items()
    }
    problem = RunDown(
        cut.t,
        channels,
        noise,
        weight={c: words(y) for c, y in channels.items()},
        mass=asked.mass,
        angular=cut.angular,
        starts=OneStart() if "x" in channels else AtSpeed(),
        level={c: one.level for c, one in uneven.items()},
        share=max(one.share for one in uneven.values()),
    )
    return problem, (*beyond, *notes, ONE_WAY, *(() if asked.mass else (RATIOS,)))


def run_downs_together(recordings: Sequence[Recording], asked: Asked) -> tuple[RunDownsTogether, tuple[str, ...]]:
    """Run-downs as one problem, each on a clock that begins where it is let go, and what was done to each.

    Raises InputError for fewer than two, for what is none among them, and for those that have no channel in common.
    """
    swings = [one.file for one in recordings if not runs_down(one, asked.restoring)]
    if swings:
        found = f"{swings[0]} does not run down, as another recording does"
        raise InputError("--together", found, "run-downs, or swings, or driven recordings, not both")
    common = in_common(recordings)
    each, notes = [], list[tuple[str, str]]()
    for one in recordings:
        shared = replace(one, channels={c: one[c] for c in common})
        problem, done = run_down_problem(shared, asked)
        each.append(replace(problem, t=problem.t - problem.t[0]))
        notes += [(one.file, note) for note in done if note not in (ONE_WAY, RATIOS)]
    laid = RunDownsTogether.laid(each)
    said = (*(() if laid.both_ways else (ONE_WAY_ALL,)), *(() if asked.mass else (RATIOS,)))
    return laid, (*said_once(notes, len(recordings)), *said)


def runs_down(recording: Recording, restoring: Restoring | None) -> bool:
    """Whether a recording without a force is read as a run-down."""
    return restoring is Restoring.NONE or classify(recording, restoring).kind is MotionKind.RUN_DOWN
