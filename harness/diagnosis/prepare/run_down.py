"""A run-down told from a swing before anything is fitted, and made ready: cut to where it is let go and where it stops.

Its speed, read in windows, keeps one sign and falls. A slider on a spring turns round, or creeps back without: the
latter looks like a wheel with viscous friction alone, and is read as one unless a spring is asked for.
"""

from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import MINIMUM_SAMPLES, Recording
from harness.diagnosis.problems.run_down import WINDOWS, Course, RunDown
from harness.diagnosis.request import Asked
from harness.diagnosis.smoothed_state.local_cubics import longest_interval, smoothed
from harness.diagnosis.starts import AtSpeed, OneStart
from harness.estimate.noise import Stamps, channel_noise
from harness.estimate.saturation import believed
from harness.model.model import Restoring

_CLEAR = 5.0
"""Standard errors of a window's speed from which it moves, at its fastest and by what it loses."""
_LOST = 0.15
"""Of the first speed, that a run-down loses at least."""
_BACK = 0.1
"""Of the speed lost, that may be won back: a ripple or a knock does so."""
_STOPPED = 0.01
"""Of the fastest speed: slower is rest."""
_LEVEL, _HELD = 0.98, 0.3
"""Of the fastest speed, until which it was held; there it loses less than this share of what it loses afterwards."""
_REST = 0.1
"""How long a rest is kept after the stop, in times of the run-down: it says where and when it stopped."""
_FINE = 256
"""Windows in which the beginning and the stop are looked for."""
_WIDTHS, _CUBIC = (12, 40), 3
"""Samples of a window whose noise is looked at, and what is taken off it."""
ONE_WAY = (
    "a run-down in one direction: f_k holds whatever pushes steadily against it besides, a grade, a tilt or an offset"
    " (a second one in the other direction would part them)"
)
RATIOS = "without --mass, or --inertia, only ratios to it are told: c/m and f_k/m"


def runs_down(recording: Recording, restoring: Restoring | None) -> bool:
    """Whether a recording without a force is a run-down."""
    return restoring in (None, Restoring.NONE) and _spans(recording) is not None


def run_down_problem(recording: Recording, asked: Asked) -> tuple[RunDown, tuple[str, ...]]:
    """A run-down as a problem, and what was done to it, one sentence each.

    Raises InputError for options that contradict the recording and where nothing runs down.
    """
    span = _spans(recording)
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
        sure=asked.restoring is Restoring.NONE,
    )
    return problem, (*beyond, *notes, ONE_WAY, *(() if asked.mass else (RATIOS,)))


@dataclass(frozen=True, slots=True)
class _Falling:
    """Speeds (m,) of one sign, as amounts, and their standard errors."""

    t: FloatArray
    speed: FloatArray
    sd: FloatArray

    @classmethod
    def of(cls, recording: Recording, part: slice, windows: int) -> "_Falling":
        channels = {c: recording[c][part] for c in ("x", "v") if c in recording}
        course = Course.of(recording.t[part], channels, windows)
        return cls(course.t, course.v * np.sign(course.v[np.argmax(np.abs(course.v))]), course.v_sd)


def _spans(recording: Recording) -> tuple[int, int] | None:
    """First sample of a run-down and the one after its last; None where it is none."""
    if not any(c in recording for c in ("x", "v")) or recording.t.size < MINIMUM_SAMPLES:
        return None
    whole = _Falling.of(recording, slice(None), min(_FINE, max(recording.t.size // 8, WINDOWS)))
    begin, end = _ends(whole, recording.t)
    if end - begin < MINIMUM_SAMPLES:
        return None
    seen = _Falling.of(recording, slice(begin, end), WINDOWS)
    change = np.diff(seen.speed)
    lost = float(seen.speed[0] - seen.speed[-1])
    noise = float(np.median(seen.sd))
    fell = lost > max(_CLEAR * noise, _LOST * float(seen.speed[0]))
    one_way = bool(np.all(seen.speed > -_CLEAR * np.maximum(seen.sd, noise) - _STOPPED * seen.speed[0]))
    back = float(np.sum(np.maximum(change - _CLEAR * noise, 0.0)))
    return (begin, end) if fell and one_way and back <= _BACK * lost else None


def _ends(seen: _Falling, t: FloatArray) -> tuple[int, int]:
    """The first sample after it was held or brought to speed, and one past the last before a rest; 0, 0 at rest."""
    most, n = float(np.max(seen.speed)), seen.speed.size
    moving = np.flatnonzero(seen.speed > np.maximum(_STOPPED * most, _CLEAR * seen.sd))
    if not moving.size:
        return 0, 0
    fastest = int(np.argmax(seen.speed))
    last = int(np.flatnonzero(seen.speed >= _LEVEL * most)[-1])
    begin = int(np.searchsorted(t, seen.t[fastest])) if fastest > 1 else 0
    later = min(last + max(n // 8, 1), n - 1)
    if last > 1 and later > last:
        before = (float(seen.speed[0]) - float(seen.speed[last])) / (seen.t[last] - seen.t[0])
        after = (float(seen.speed[last]) - float(seen.speed[later])) / (seen.t[later] - seen.t[last])
        if before < _HELD * after:
            begin = int(np.searchsorted(t, seen.t[last]))
    stop = float(seen.t[min(int(moving[-1]) + 1, n - 1)])
    return begin, int(np.searchsorted(t, stop + _REST * (stop - float(t[begin])), side="right"))
