"""A recording made ready: what is no motion cut away, noise, the drive, windows of a driven one."""

import math
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.checks import positive
from harness.core.errors import InputError
from harness.core.recording import MINIMUM_SAMPLES, Recording
from harness.diagnosis.baseline import dominant_frequency
from harness.diagnosis.driven.between import between_samples
from harness.diagnosis.driven.cut import windows_of
from harness.diagnosis.driven.disturbed import force_noise
from harness.diagnosis.driven.hold import acting
from harness.diagnosis.driven.inverse import inverse_start, state_of
from harness.diagnosis.driven.measured import GAP
from harness.diagnosis.driven.smooth import Smooth, smoothed
from harness.diagnosis.observe import COARSE, observe
from harness.diagnosis.problem import Problem, Restarts
from harness.diagnosis.release import released, without_hand
from harness.estimate.noise import channel_noise
from harness.estimate.reversals import Kind, NoDecay, find_half_cycles
from harness.model.model import Model, Restoring

HORIZON = 1.0
"""Default length of the windows of a driven recording, s."""
_KINDS = {"x": Kind.DISPLACEMENT, "v": Kind.VELOCITY, "a": Kind.ACCELERATION}
_FEWEST_IN_WINDOW = 20
_MOVES = 1.5
"""Times its noise by which some channel of a driven slider must scatter."""
_REST = 1.0
"""How long a rest is kept after the last half-cycle, in times of the decay: it says where the slider stays."""


@dataclass(frozen=True, slots=True)
class Asked:
    """What was asked of a diagnosis: see the options of the same names; horizon in s, mass in kg."""

    restoring: Restoring = Restoring.SPRING
    zero_free: bool = False
    mass: float | None = None
    horizon: float | None = None

    def __post_init__(self) -> None:
        if self.horizon is not None:
            positive("--horizon", self.horizon, "s")
        if self.mass is not None:
            positive("--mass", self.mass, "kg")


def is_driven(recording: Recording) -> bool:
    """Whether a measured force acts."""
    return "u" in recording and bool(np.any(recording["u"] != 0.0))


def prepare(recording: Recording, asked: Asked) -> tuple[Problem, tuple[str, ...]]:
    """A recording as a problem, and what was done to it, one sentence each.

    Raises InputError for options that contradict the recording, and for what cannot be diagnosed.
    """
    if is_driven(recording):
        return _driven(recording, asked)
    if asked.restoring is Restoring.NONE:
        found = "none, but no force u is recorded" if "u" not in recording else "none, but the force u is 0 throughout"
        raise InputError("--restoring", f"{found} in {recording.file}", "a recorded force, or spring, is accepted")
    return _decay(recording, asked)


def _decay(recording: Recording, asked: Asked) -> tuple[Problem, tuple[str, ...]]:
    moving = _in_motion(recording, asked.restoring)
    recording, notes = moving.recording, moving.notes
    channels = {c: recording[c] for c in ("x", "v", "a") if c in recording}
    omega = dominant_frequency(recording.t, next(iter(channels.values())))
    period = 2.0 * math.pi / omega if math.isfinite(omega) and omega > 0.0 else None
    noise = {c: channel_noise(recording.t, y, period) for c, y in channels.items()}
    problem = Problem(
        recording.t,
        channels,
        noise,
        mass=asked.mass,
        restoring=asked.restoring,
        zero_free=asked.zero_free,
        angular=recording.angular,
    )
    if moving.released:
        problem, touched = without_hand(problem, moving.half)
        if touched > 0.0:
            why = "no free decay of this slider, as if a hand was not yet off"
            notes = (*notes, f"{touched:.4g} s after the release are left out: {why}")
    return problem, notes


@dataclass(frozen=True, slots=True)
class _Moving:
    """A recording cut to its free decay; released : whether it shows the release. half : of a half-cycle, s."""

    recording: Recording
    notes: tuple[str, ...] = ()
    released: bool = False
    half: float = 0.0


def _in_motion(recording: Recording, restoring: Restoring) -> _Moving:
    """A free decay without a hold before its release and without most of a long rest at its end."""
    channel = next(c for c in ("x", "v", "a") if c in recording)
    t, y = recording.t, recording[channel]
    noise = channel_noise(t, y)
    try:
        found = find_half_cycles(t, y, _KINDS[channel], noise)
    except NoDecay:
        return _Moving(recording)
    begin, end, notes = 0, t.size, []
    if found.held:
        begin = released(t, y, noise, found, channel == "x", restoring is Restoring.PENDULUM)
    late = float(found.edges[-1]) + _REST * float(found.edges[-1] - found.edges[0])
    if late < t[-1]:
        end = int(np.searchsorted(t, late))
    if end - begin < MINIMUM_SAMPLES:
        return _Moving(recording)
    if begin > 0:
        notes.append(f"the first {t[begin] - t[0]:.4g} s, before the release, are left out")
    if end < t.size:
        notes.append(f"the last {t[-1] - t[end - 1]:.4g} s, a long rest, are left out")
    cut = recording.cut(slice(begin, end)) if notes else recording
    return _Moving(cut, tuple(notes), begin > 0, found.half_time)


def _driven(recording: Recording, asked: Asked) -> tuple[Problem, tuple[str, ...]]:
    where = f"{recording.file}: channels {', '.join(recording.channels)}"
    if "x" not in recording and ("v" not in recording or asked.restoring is not Restoring.NONE):
        need = "x, or v with --restoring none," if "v" in recording else "x (or v with --restoring none)"
        raise InputError(where, "a driven recording whose state cannot be seen", f"{need} beside u is accepted")
    t, u = recording.t, recording["u"]
    if float(np.ptp(u)) == 0.0:
        raise InputError(f"{recording.file}: channel u", f"the constant {u[0]:g}", "a force that changes is accepted")
    interval = recording.interval
    if asked.horizon is not None and asked.horizon < _FEWEST_IN_WINDOW * interval:
        found = f"{asked.horizon:g} s, {asked.horizon / interval:.1f} samples of {recording.file}"
        raise InputError("--horizon", found, f"at least {_FEWEST_IN_WINDOW * interval:g} s is accepted")
    channels: dict[str, FloatArray] = {c: recording[c] for c in ("x", "v", "a") if c in recording}
    noise = {c: channel_noise(t, y) for c, y in channels.items()}
    if all(float(np.std(y)) < _MOVES * noise[c].sigma for c, y in channels.items()):
        seen = ", ".join(f"{c} to {noise[c].sigma:.3g}" for c in channels)
        raise InputError(where, f"a slider that does not move beyond its noise ({seen})", "a driven motion is accepted")
    longest = GAP * interval
    smooth: dict[str, Smooth] = {
        c: smoothed(t, channels[c], longest, noise[c].sigma) for c in ("x", "v") if c in channels
    }
    state = state_of(t, smooth)
    first = inverse_start(state, u, asked.restoring, asked.mass, asked.zero_free)
    first = replace(first, x0=float(state[0][0]) - first.offset, v0=float(state[1][0]), t0=float(t[0]))
    problem = Problem(
        t,
        channels,
        noise,
        drive=between_samples(t, u),
        mass=asked.mass,
        restoring=asked.restoring,
        zero_free=asked.zero_free and asked.restoring is not Restoring.NONE,
        angular=recording.angular,
        first=first,
    )
    force = acting(problem, u)
    problem = replace(problem, drive=force.drive)
    notes = ["the force acts as a sampled controller's, held from each sample to the next"] if force.held else []
    gaps = float(np.max(np.diff(t))) > longest
    if asked.horizon is None and not gaps and force.follows:
        problem, said = _with_force_noise(problem, force.model, u)
        return problem, ("driven: the whole recording is followed from one start", *notes, *said)
    horizon = HORIZON if asked.horizon is None else asked.horizon
    windows = windows_of(t, state, smooth, horizon, longest)
    note = (
        f"driven: the force is fitted, and simulations run over {len(windows)} windows of at most {horizon:g} s, each "
        "restarted from the smoothed recorded state"
    )
    return replace(problem, restarts=Restarts(windows, t, state[1])), (note, *notes)


def _with_force_noise(problem: Problem, model: Model, u: FloatArray) -> tuple[Problem, tuple[str, ...]]:
    """The problem, allowing for the noise of its force u (n,) if that shows in a model's motion; what is said of it."""
    noise = channel_noise(problem.t, u)
    shown = observe(model, problem, (), None, COARSE)
    force = force_noise(model, shown, problem.t, noise, problem.noise)
    if force is None:
        return problem, ()
    share = 100.0 * noise.sigma / math.sqrt(float(np.mean(u**2)))
    said = (
        f"the force's own noise, {noise.sigma:.3g} N ({share:.2g} % of its rms), shows in the motion and is allowed for"
    )
    return replace(problem, force_noise=force), (said,)
