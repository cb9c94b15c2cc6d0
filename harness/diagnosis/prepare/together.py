"""Several recordings of one machine made ready as one problem: held alike, measured in the channels that all have."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.prepare.driven import is_driven
from harness.diagnosis.prepare.free_decay import free_decay_problem
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.problems.together import Together
from harness.diagnosis.request import Asked

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
    notes: list[str] = []
    each: list[FreeDecay] = []
    for one, prepared in zip(recordings, asked_alone, strict=True):
        held_so = (prepared[0].restoring, prepared[0].zero_free) == (widest.restoring, zero_free)
        problem, done = prepared if held_so else _alone(one, alike, common)
        notes += [f"in {one.file}: {note}" for note in done]
        left_out = [c for c in ("x", "v", "a") if c in one and c not in common]
        notes += [f"in {one.file}: {c} is left out, which not every recording has" for c in left_out]
        # its clock begins where it is let go
        each.append(replace(problem, t=problem.t - problem.t[0], zero_chosen=widest.zero_chosen))
    return Together.laid(each), tuple(notes)


def in_common(recordings: Sequence[Recording]) -> list[str]:
    """The channels that all have. Raises InputError for recordings that cannot be of one machine as it was seen.

    Nor are two accepted that are one: it would count twice.
    """
    if len(recordings) < _FEWEST:
        found = recordings[0].file if recordings else "no recording"
        raise InputError("--together", f"{found} alone", "two recordings of one machine or more are accepted")
    driven = [one.file for one in recordings if is_driven(one)]
    free = [one.file for one in recordings if not is_driven(one)]
    if driven and free:
        found = f"{driven[0]} is driven and {free[0]} a free decay"
        raise InputError("--together", found, "free decays, or driven recordings, are accepted, not both")
    common = [c for c in ("x", "v", "a") if all(c in one for one in recordings)]
    if not common:
        has = ", ".join(f"{one.file} has {' and '.join(c for c in ('x', 'v', 'a') if c in one)}" for one in recordings)
        raise InputError("--together", has, "recordings with a channel in common are accepted")
    for one, again in combinations(recordings, 2):
        if _same(one, again, common):
            found = f"{one.file} and {again.file} hold the same motion, sample for sample"
            raise InputError("--together", found, "recordings that each tell something of their own are accepted")
    kinds = {one.angular for one in recordings}
    if len(kinds) > 1:
        turning = next(one.file for one in recordings if one.angular)
        other = next(one.file for one in recordings if not one.angular)
        raise InputError("--together", f"{turning} turns, {other} slides", "recordings of one machine are accepted")
    return common


def _same(one: Recording, other: Recording, channels: Sequence[str]) -> bool:
    return one.t.size == other.t.size and all(np.array_equal(one[c], other[c]) for c in channels)


def _alone(recording: Recording, asked: Asked, common: Sequence[str]) -> tuple[FreeDecay, tuple[str, ...]]:
    problem, notes = free_decay_problem(recording, asked)
    channels = {c: problem.channels[c] for c in common}
    noise = {c: problem.noise[c] for c in common}
    weight = {c: problem.weight[c] for c in common}
    return replace(problem, channels=channels, noise=noise, weight=weight), notes
