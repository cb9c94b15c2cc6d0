"""A free decay made ready: what is no motion cut away, noise, and how the slider is held."""

import math
from dataclasses import dataclass, replace

import numpy as np

from harness.core.errors import InputError
from harness.core.recording import MINIMUM_SAMPLES, Recording
from harness.diagnosis.baseline.base_fit import dominant_frequency
from harness.diagnosis.covariates.values import Acting, values_in
from harness.diagnosis.prepare.held import held
from harness.diagnosis.prepare.release import released, without_hand
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.request import Asked, AskedCovariate
from harness.estimate.believed import believed
from harness.estimate.noise import channel_noise
from harness.estimate.reversals import Grows, Kind, NoDecay, find_half_cycles
from harness.model.model import Restoring

_KINDS = {"x": Kind.DISPLACEMENT, "v": Kind.VELOCITY, "a": Kind.ACCELERATION}
_GROWS = (
    "the swing grows, which friction never makes it do: a second mass swings along, or something pushes, and its force,"
    " recorded as u, would tell"
)
_REST = 1.0
"""How long a rest is kept after the last half-cycle, in times of the decay: it says where the slider stays."""


def free_decay_problem(recording: Recording, asked: Asked) -> tuple[FreeDecay, tuple[str, ...]]:
    """A free decay as a problem, and what was done to it, one sentence each.

    Raises InputError for options that contradict the recording, and for what cannot be diagnosed.
    """
    if asked.restoring is Restoring.NONE:
        found = "none, but no force u is recorded" if "u" not in recording else "none, but the force u is 0 throughout"
        raise InputError("--restoring", f"{found} in {recording.file}", "a recorded force, or spring, is accepted")
    recording, beyond = believed(recording, ("x", "v"))
    moving = _in_motion(recording, asked.restoring or Restoring.SPRING)
    recording, notes = moving.recording, (*beyond, *moving.notes)
    channels = {c: recording[c] for c in ("x", "v", "a") if c in recording}
    omega = dominant_frequency(recording.t, next(iter(channels.values())))
    period = 2.0 * math.pi / omega if math.isfinite(omega) and omega > 0.0 else None
    noise = {c: channel_noise(recording.t, y, period) for c, y in channels.items()}
    problem = FreeDecay(
        recording.t,
        channels,
        noise,
        mass=asked.mass,
        angular=recording.angular,
        covariates=values_in(recording, asked.covariates),
    )
    problem, said = held(problem, asked)
    notes = (*notes, said) if said else notes
    if moving.released:
        problem, touched = without_hand(problem, moving.half)
        if touched > 0.0:
            why = "no free decay of this slider, as if a hand was not yet off"
            notes = (*notes, f"{touched:.4g} s after the release are left out: {why}")
    return replace(problem, acting=tuple(_acting(recording, one) for one in asked.covariates)), notes


def _acting(recording: Recording, one: AskedCovariate) -> Acting:
    values = recording.covariates[one.name]
    noise = channel_noise(recording.t, values).sigma
    about, unit = float(np.mean(values)), recording.units.get(one.name, "")
    return Acting(one.name, one.acts, about, unit, noise, one.acts is not None)


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
    except Grows:
        return _Moving(recording, (_GROWS,))
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
