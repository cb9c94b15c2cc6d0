"""Sizes of a free decay that are rather those of another unit, as questions with the --columns that would say so."""

import math
import re

import numpy as np

from harness.core.recording import Recording
from harness.diagnosis.baseline.base_fit import dominant_frequency
from harness.diagnosis.moves.kinds import MotionKind, Moves
from harness.diagnosis.problem import Problem

_FASTEST = 100.0
"""m/s, which no slider that swings reaches: what does was read in m and is in mm, or in ms and is in s."""
_SLOWEST = 100.0
"""s of a swing, which a slider on a spring hardly takes."""
_UNIT = re.compile(r"\[[^][]*\]$")
"""That a column is read in, behind it."""


def implausible(recording: Recording, problem: Problem, moves: Moves) -> tuple[str, ...]:
    """Questions on what swings too far, too fast or too slowly for its units; none of what is no free decay."""
    decays = (MotionKind.FREE_DECAY, MotionKind.SEVERAL_DECAYS)
    if moves.kind not in decays or "x" not in problem.channels:
        return ()
    x = problem.channels["x"]
    far, omega = 0.5 * float(np.ptp(x)), dominant_frequency(problem.t, x)
    period = 2.0 * math.pi / omega if omega > 0.0 else 0.0
    said = []
    if problem.angular and far > 2.0 * math.pi:
        turns = far / (2.0 * math.pi)
        said.append(
            f"x swings {far:.3g} rad to each side, {turns:.2g} turns: is it in deg?{_as(recording, 'x', 'deg')}"
        )
    if not problem.angular and far * omega > _FASTEST:
        found = f"x swings {far:.2g} m each way in {period:.2g} s, at up to {far * omega:.2g} m/s"
        likelier = ("t", "s") if period < 0.01 and recording.units.get("t", "s") != "s" else ("x", "mm")
        said.append(f"{found}: is {likelier[0]} in {likelier[1]}?{_as(recording, *likelier)}")
    if period > _SLOWEST:
        said.append(f"one swing takes {period:.2g} s: is t in ms?{_as(recording, 't', 'ms')}")
    return tuple(said)


def _as(recording: Recording, channel: str, unit: str) -> str:
    """What reads a channel in another unit; "" where nobody told from which columns it came."""
    columns = dict(recording.columns)
    if channel not in columns:
        return ""
    columns[channel] = f"{_UNIT.sub('', columns[channel])}[{unit}]"
    said = ",".join(f"{c}={of}" for c, of in columns.items())
    return f' Try: --columns "{said}"'
