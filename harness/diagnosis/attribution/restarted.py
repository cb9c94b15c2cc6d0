"""The recording cut into windows of about a period, each restarted from the recording's smoothed state.

The smoothed state is the refined model's: fitted to all samples, it is the smoother with the least error there is, and
it knows of reversals. A simulation that is right in everything then differs from it nowhere, and a phase that slips
counts for one period and no more.
"""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.events import Mode
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.starts import OneStart, Window, Windows
from harness.kernels.solve import Scales
from harness.model.model import Model

_FEWEST = 4
"""Samples of a window."""
_GAP = 3.0
"""Sampling intervals from which on there is a gap."""
_IN_STEP = 0.5
"""Correlation over a period below which a motion is out of step: that of cos(s) and cos(1.33 s)."""
_MOST = 120
"""Windows that are looked at; of more, as many evenly spread."""
_SEEN, _MOVES = 3.0, 0.1
"""Standard deviations of noise above which a window shows motion, and the share of it that the other must show."""


@dataclass(frozen=True, slots=True)
class Restarted:
    """The question in windows, with what the refined model shows there and the size of the noise.

    problem : with restarts. right : channels (n,) of the refined model, window by window. sigma : by channel.
    """

    problem: Problem
    right: dict[str, FloatArray]
    sigma: dict[str, float]

    def distance(self, shown: dict[str, FloatArray]) -> float:
        """Mean square of what is shown minus the refined model's, in units of the noise, over samples that count."""
        total, count = 0.0, 0
        for c, right in self.right.items():
            counts = self.problem.weight[c] > 0.0
            total += float(np.sum(np.square((shown[c] - right)[counts] / self.sigma[c])))
            count += int(np.count_nonzero(counts))
        return total / max(count, 1)

    def slipping(self, shown: dict[str, FloatArray]) -> float:
        """Share of the windows at whose end the motion shown is a quarter period and more out of step."""
        channel = next(iter(self.right))
        windows = () if not isinstance(self.problem.starts, Windows) else self.problem.starts.windows
        out, moving = 0, 0
        for w in windows:
            one, other = (values[w.start : w.stop] - np.mean(values[w.start : w.stop])
                          for values in (self.right[channel], shown[channel]))  # fmt: skip
            sizes = float(np.std(one)), float(np.std(other))
            # what hardly moves is out of no step
            if sizes[0] > _SEEN * self.sigma[channel] and sizes[1] > _MOVES * sizes[0]:
                moving += 1
                out += float(one @ other) < _IN_STEP * sizes[0] * sizes[1] * one.size
        return out / moving if moving else 0.0


def restarted(refined: Model, problem: Problem, scales: Scales) -> Restarted:
    """Windows of a period along the refined model's motion; raises SimulationError."""
    shown = observe(refined, problem, scales=scales)
    t = problem.t
    begins = [0 if not isinstance(problem.starts, OneStart) else int(np.searchsorted(t, refined.t0, side="left"))]
    intervals, period = np.diff(t), 2.0 * math.pi / scales.omega
    gaps = np.flatnonzero(intervals > _GAP * float(np.median(intervals)))
    while begins[-1] < t.size:
        # the next begins a period later, or behind a gap
        at = begins[-1]
        stop = max(int(np.searchsorted(t, t[at] + period)), at + _FEWEST)
        within = gaps[(gaps >= at) & (gaps < stop)]
        begins.append(int(within[0]) + 1 if within.size else min(stop, t.size))
    spans = [(low, high) for low, high in pairwise(begins) if high - low >= _FEWEST]
    spans = [spans[i] for i in np.unique(np.linspace(0, len(spans) - 1, min(len(spans), _MOST)).astype(int))]
    kept = np.concatenate([np.arange(low, high) for low, high in spans])
    still = shown.mode == Mode.STICK
    windows, at = [], 0
    for low, high in spans:
        v = 0.0 if still[low] else float(shown.v[low])
        windows.append(Window(at, at + high - low, float(t[low]), float(shown.x[low]) + refined.offset, v, 0.0, 0.0))
        at += high - low
    part = replace(
        problem,
        t=t[kept],
        channels={c: y[kept] for c, y in problem.channels.items()},
        weight={c: w[kept] for c, w in problem.weight.items()},
        level={c: y[kept] for c, y in problem.level.items()},
        starts=Windows(tuple(windows), t, shown.v),
    )
    right = observe(refined, part, scales=scales).y
    return Restarted(part, right, {c: noise.sigma for c, noise in problem.noise.items()})
