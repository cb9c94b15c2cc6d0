"""Recordings that were diagnosed each: whether they look like one machine, and the command that says more of it."""

import math
import shlex
from collections.abc import Sequence
from pathlib import Path

from harness.results.common import P
from harness.results.diagnosis import DiagnosisResult

_SIGMAS, _LEAST = 5.0, 0.02
"""Standard errors, and the share of a value, from which two differ."""
_TUNED = 0.2
"""Of the natural frequency, from which two recordings are hardly of one machine."""
_OF_THE_CALL = {"--out": 1, "--json": 1, "--jobs": 1, "--cluster": 1, "--resume": 0, "--quiet": 0}
"""Options that the next command does not take over, and how many words follow."""


def advice_on(results: Sequence[DiagnosisResult], command: str) -> str:
    """What to try next with recordings that were diagnosed each, one sentence and a line to paste; "" for none.

    command : that gave them, "" where there is none.
    """
    fits = [one.refined.parameters for one in results]
    tuned = [value for fit in fits if (value := _value(fit.get("omega_n")))]
    hashes = [one.recording.sha256 for one in results if one.recording.sha256]
    if (
        len(results) < 2
        or len(set(hashes)) < len(hashes)
        or len(tuned) < len(results)
        or max(tuned) > (1.0 + _TUNED) * min(tuned)
    ):
        return ""
    files = [one.recording.file for one in results]
    if len({tuple(sorted(m.name for m in one.mechanisms)) for one in results}) > 1:
        said = "Not the same physics is missing in all. If they are of one machine, diagnose them together"
        return said + _again(command, files, ["--together"], keep=True)
    names = [name for name in fits[0] if all(_value(fit.get(name)) is not None for fit in fits)]
    apart = [name for name in names if _differ([fit[name] for fit in fits])]
    if not apart:
        listed = f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else names[0]
        said = f"They have the same {listed}, to their errors. If they are of one machine, diagnose them together"
        return said + _again(command, files, ["--together"], keep=True)
    shown = "; ".join(f"{name} {' and '.join(str(fit[name]) for fit in fits)}" for name in apart)
    if len(results) > 2:
        shown = ", ".join(apart)
        said = f"They differ in {shown}. If they are of one machine, a common cause shows together"
        return said + _again(command, files, ["--together"], keep=True)
    said = f"They differ: {shown}. If they are of one machine in two conditions, compare these"
    return said + _again(command, files, ["--before", files[0], "--after", files[1]], keep=False)


def _value(number: P | None) -> float | None:
    return None if number is None else number.value


def _differ(numbers: Sequence[P]) -> bool:
    """Whether the largest and the smallest differ by more than errors and a share of them explain."""
    ordered = sorted(numbers, key=lambda one: one.value or 0.0)
    low, high = ordered[0], ordered[-1]
    if low.value is None or high.value is None:
        return False
    errors = math.hypot(*(part or 0.0 for one in (low, high) for part in (one.stderr, one.systematic)))
    return high.value - low.value > max(_SIGMAS * errors, _LEAST * abs(high.value))


def _again(command: str, files: Sequence[str], words: Sequence[str], *, keep: bool) -> str:
    """The command with these words, its files kept or not, as what ends a sentence."""
    left, own = list[str](), {*files, *(Path(file).name for file in files)}
    typed = iter(shlex.split(command))
    for word in typed:
        if word.partition("=")[0] in _OF_THE_CALL:
            for _ in range(0 if "=" in word else _OF_THE_CALL[word]):
                next(typed, None)
        elif keep or not any(Path(word).name == Path(one).name for one in own):
            left.append(word)
    return f". Try: {shlex.join([*left, *words])}" if left else f": {' '.join(words)}."
