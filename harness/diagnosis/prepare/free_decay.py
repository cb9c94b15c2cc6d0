"""A free decay made ready: what is no motion cut away, noise, and how the slider is held.

Several recordings of one machine made ready as one problem: held alike, measured in the channels that all have.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from harness.core.errors import InputError
from harness.core.recording import MINIMUM_SAMPLES, Recording
from harness.diagnosis.baseline.base_fit import dominant_frequency
from harness.diagnosis.covariates.values import Acting, values_in
from harness.diagnosis.prepare.driven import is_driven
from harness.diagnosis.prepare.held import held
from harness.diagnosis.prepare.release import released, without_hand
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.problems.together import Together
from harness.diagnosis.request import Asked
from harness.estimate.noise import channel_noise
from harness.estimate.readings import words
from harness.estimate.reversals import Kind, NoDecay, find_half_cycles
from harness.estimate.saturation import believed
from harness.model.model import Restoring

_KINDS = {"x": Kind.DISPLACEMENT, "v": Kind.VELOCITY, "a": Kind.ACCELERATION}
_REST = 1.0
"""How long a rest is kept after the last half-cycle, in times of the decay: it says where the slider stays."""


def free_decay_problem(recording: Recording, asked: Asked) -> tuple[FreeDecay, tuple[str, ...]]:
    """A free decay as a problem, and what was done to it, one sentence each.

    Raises InputError for options that contradict the recording, and for what cannot be diagnosed.
    """
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
        weight={c: words(y) for c, y in channels.items()},
        mass=asked.mass,
        angular=recording.angular,
        covariates=values_in(asked.covariates, recording),
    )
    problem, said = held(problem, asked)
    notes = (*notes, said) if said else notes
    if moving.released:
        problem, touched = without_hand(problem, moving.half)
        if touched > 0.0:
            notes = (*notes, f"skipped the first {touched:.2g} s after the release (hand still in contact?)")
    return replace(problem, acting=tuple(Acting.of(one, recording) for one in asked.covariates)), notes


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
        notes.append(f"the first {t[begin] - t[0]:.4g} s, before the release, are skipped")
    if end < t.size:
        notes.append(f"the last {t[-1] - t[end - 1]:.4g} s, a long rest, are skipped")
    cut = recording.cut(slice(begin, end)) if notes else recording
    return _Moving(cut, tuple(notes), begin > 0, found.half_time)


_NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.]\w)")
"""In a note, and in none of its names."""
_FEWEST = 2
"""Recordings that there is something to pool of."""


def together(recordings: Sequence[Recording], asked: Asked) -> tuple[Together, tuple[str, ...]]:
    """Free decays as one problem, and what was done to each, one sentence each.

    How the slider is held is chosen at the one that swings furthest, where nobody says. Where any of them asks for a
    zero of its own, all get one: one that happens to lie near nought says nothing of the others.
    Raises InputError for fewer than two, for driven ones among them, and for those that have no channel in common.
    """
    common = in_common(recordings)
    asked_alone = [_alone(one, asked, common) for one in recordings]
    widest = max(asked_alone, key=lambda one: float(np.ptp(one[0].channels[common[0]])))[0]
    zero_free = any(problem.zero_free for problem, _ in asked_alone)
    alike = replace(asked, restoring=widest.restoring, zero_free=zero_free)
    notes: list[tuple[str, str]] = []
    each: list[FreeDecay] = []
    for one, prepared in zip(recordings, asked_alone, strict=True):
        held_so = (prepared[0].restoring, prepared[0].zero_free) == (widest.restoring, zero_free)
        problem, done = prepared if held_so else _alone(one, alike, common)
        notes += [(one.file, note) for note in done]
        left_out = [c for c in ("x", "v", "a") if c in one and c not in common]
        notes += [(one.file, f"{c} is not used: not every recording has it") for c in left_out]
        # its clock begins where it is let go
        each.append(replace(problem, t=problem.t - problem.t[0], zero_chosen=widest.zero_chosen))
    return Together.laid(each), said_once(notes, len(recordings))


def said_once(notes: Sequence[tuple[str, str]], count: int) -> tuple[str, ...]:
    """Notes, each with the file that it is on, once for all files of which it is true but for its numbers.

    count : of the recordings.
    """
    alike: dict[str, dict[str, str]] = {}
    for file, note in dict.fromkeys(notes):
        form = _NUMBER.sub("#", note)
        while file in alike.get(form, {}):  # a second of one form is of its own
            form += "#"
        alike.setdefault(form, {})[file] = note
    return tuple(_of_files(of, count) for of in alike.values())


def _of_files(notes: dict[str, str], count: int) -> str:
    """Notes that differ in their numbers alone, by file, as one: the least and the largest of each."""
    names = ["each of the recordings"] if len(notes) == count > 1 else list(notes)
    where = " and ".join([", ".join(names[:-1]), names[-1]] if names[:-1] else names)
    said = list(notes.values())
    numbers = [sorted(each, key=float) for each in zip(*map(_NUMBER.findall, said), strict=True)]
    ends = iter([" to ".join(dict.fromkeys((each[0], each[-1]))) for each in numbers])
    return f"in {where}: {_NUMBER.sub(lambda _: next(ends), said[0])}"


def in_common(recordings: Sequence[Recording]) -> list[str]:
    """The channels that all have. Raises InputError for recordings that cannot be of one machine as it was seen.

    Nor are two accepted that are one: it would count twice.
    """
    if len(recordings) < _FEWEST:
        found = f"{recordings[0].file} alone" if recordings else "no recording"
        raise InputError("--together", found, "two recordings of one machine or more")
    driven = [one.file for one in recordings if is_driven(one)]
    free = [one.file for one in recordings if not is_driven(one)]
    if driven and free:
        found = f"{driven[0]} is driven and {free[0]} a free decay"
        raise InputError("--together", found, "free decays, or driven recordings, not both")
    common = [c for c in ("x", "v", "a") if all(c in one for one in recordings)]
    if not common:
        has = ", ".join(f"{one.file} has {' and '.join(c for c in ('x', 'v', 'a') if c in one)}" for one in recordings)
        raise InputError("--together", has, "recordings with a channel in common")
    for one, again in combinations(recordings, 2):
        if one.t.size == again.t.size and all(np.array_equal(one[c], again[c]) for c in common):
            found = f"{one.file} and {again.file} hold the same motion, sample for sample"
            raise InputError("--together", found, "recordings that each tell something of their own")
    kinds = {one.angular for one in recordings}
    if len(kinds) > 1:
        turning = next(one.file for one in recordings if one.angular)
        other = next(one.file for one in recordings if not one.angular)
        raise InputError("--together", f"{turning} turns, {other} slides", "recordings of one machine")
    return common


def _alone(recording: Recording, asked: Asked, common: Sequence[str]) -> tuple[FreeDecay, tuple[str, ...]]:
    problem, notes = free_decay_problem(recording, asked)
    channels = {c: problem.channels[c] for c in common}
    noise = {c: problem.noise[c] for c in common}
    weight = {c: problem.weight[c] for c in common}
    return replace(problem, channels=channels, noise=noise, weight=weight), notes
