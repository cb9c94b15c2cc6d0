"""What part of the misfit an effect makes: base fits of the recording with all effects, without one, with one alone."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.proof.machines.base_fit import BaseFit, fit_base
from harness.proof.machines.rigs import Effects, Rig
from harness.proof.plant.integrate import PlantRun


@dataclass(frozen=True, slots=True)
class Reading:
    """A noise-free recording with its base fit. run : the true motion. clean : by channel, shape (n,)."""

    run: PlantRun
    clean: Mapping[str, FloatArray]
    fit: BaseFit

    @property
    def misfit(self) -> dict[str, float]:
        """Mean square that the base leaves in each channel."""
        return self.fit.mean_squares()


def read(rig: Rig, effects: Effects, quick: bool = False) -> Reading:
    """The recording of a machine with these effects, computed at a fixed step if ``quick``; raises SimulationError."""
    run, clean = rig.motion(effects, quick)
    return Reading(run, clean, fit_base(rig, run, clean, quick=quick))


def refitted(rig: Rig, reading: Reading, weight: Mapping[str, float]) -> Reading:
    """The same with a base fit in which channels have these weights; one channel has none."""
    if rig.kind.driven or len(rig.channels) == 1:
        return reading
    return replace(reading, fit=fit_base(rig, reading.run, reading.clean, weight))


def size(rig: Rig, reading: Reading, channel: str) -> float:
    """The size of a channel, to which misfits are relative."""
    return float(np.std(reading.clean["u"])) if channel == "u" else rig.scale(channel)


def relative(rig: Rig, reading: Reading) -> float:
    """Root mean square that the base leaves, relative to the size of the channel in which that is most."""
    return float(np.sqrt(max(m / size(rig, reading, c) ** 2 for c, m in reading.misfit.items())))


def weights(of: Reading, noise: Mapping[str, float]) -> dict[str, float]:
    """Weight of each channel: by what the base leaves in it, noise and all."""
    return {c: 1.0 / max(m + noise[c] ** 2, 1e-300) for c, m in of.misfit.items()}


def ratio(part: Reading, whole: Reading, weight: Mapping[str, float]) -> float:
    """Misfit of one recording over that of another, channels weighted."""
    return sum(w * part.misfit[c] for c, w in weight.items()) / sum(w * whole.misfit[c] for c, w in weight.items())


def fitted_share(part: Reading, whole: Reading, weight: Mapping[str, float]) -> float:
    """Share of the misfit that an effect takes off when its strength is fitted beside the base, to first order.

    part : the effect alone, whose misfit is the one more column of the linear problem. What the base's own parameters
    would still take off, where its fit ended before its minimum, is nobody's share.
    """
    slopes, column, left = [], [], []
    for c, w in weight.items():
        slopes.append(math.sqrt(w) * whole.fit.slopes[c])
        column.append(math.sqrt(w) * part.fit.left[c])
        left.append(math.sqrt(w) * whole.fit.left[c])
    design, target = np.vstack(slopes), np.concatenate(left)
    base = _rest(design, target)
    return 1.0 - _rest(np.column_stack([design, np.concatenate(column)]), target) / base


def _rest(design: FloatArray, target: FloatArray) -> float:
    """Sum of squares that the columns of ``design`` (N, p) leave of ``target`` (N,)."""
    length = np.sqrt(np.sum(design**2, axis=0))
    length[length == 0.0] = 1.0
    rest = target - design @ (np.linalg.lstsq(design / length, target, rcond=1e-10)[0] / length)
    return float(rest @ rest)
