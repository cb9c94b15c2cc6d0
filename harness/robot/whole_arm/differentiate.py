"""From a log to filtered positions, velocities, accelerations and torques at few samples, all through one filter."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import InputError
from harness.core.robot import JointLog
from harness.estimate.rest import rests, turning
from harness.robot.arm import Arm
from harness.robot.smooth import Band, white_sd
from harness.robot.whole_arm.rules import EITHER_WAY, GUARD, LEAST_SAMPLES, RESTING, STICKS, SURE

LEAST_SECONDS = 3.0
"""Shorter logs leave nothing between the ends of the filter and the reversals."""
_JITTER = 0.01
"""Share of the step by which stamps may swing before the log is put on even steps."""
_GAP = 5.0
"""Steps without a sample from which nothing is said about the time between."""
_HELD, _ABOVE, _LOWEST, _HIGHEST = 0.99, 5.0, 10.0, 20.0
"""The filter passes five times the frequency below which 99 % of the velocities' power lies, within 10 to 20 Hz."""
_MOTION = 25.0
"""Hz: what is faster is no motion of an arm."""
_OFF, _STEPPED = 0.1, 0.9
"""Of a step: nearer to a whole multiple, more than this share of changes are an encoder's."""
_BENDS = 0.159
"""Integral of x^4 times the filter's gain squared, x in f_lowpass: B(5/8, 11/8) / 8."""
_NOISES = 3.0
"""Standard deviations of a position that scatters about one place."""
_OWN = 0.5
"""Share by which what a joint's accelerations before and after say of its turn may be wrong."""
_WIDE = 2.0
"""Times f_lowpass: a product of two motions within it has all its frequencies below this."""
_COLUMNS, _FIT = 9.0, 3.0
"""Samples a second at which columns are formed and at which torque is fitted, in f_lowpass."""


@dataclass(frozen=True, slots=True)
class Filtered:
    """A log after the filter. k joints were logged with effort, the arm has nv.

    joints : names (k,). dof : their places in the arm (k,). t (m,) : s. q, v, a (m, nv) : rad or m, per s, per s^2.
    torque (m, k) : N m or N. temperature (m, k) : degC, nan where it was not logged. good (m,) : away from gaps. band :
    of the recording. fine : band of t_fine, q_fine, v_fine (M, nv), from which columns are formed. wide : positions,
    velocities and accelerations (M, nv) through a filter twice as wide, of which the model's torque is formed. out :
    band of the m samples before the ends were cut. velocity_noise (k,) : standard deviation of v. position_step (k,) :
    rad, the encoder's. torque_noise (k,) : what white noise and steps of the recorded torque leave after the filter,
    N m. acceleration_noise (nv,) : standard deviation of a. rests : by joint, (r, 2), s, from when to when it stayed
    within its encoder's steps and noise for longer (rule sticks) than its acceleration takes to turn it. seconds : of
    the log. notes : what was done, one sentence each.
    """

    joints: tuple[str, ...]
    dof: tuple[int, ...]
    t: FloatArray
    q: FloatArray
    v: FloatArray
    a: FloatArray
    torque: FloatArray
    temperature: FloatArray
    good: BoolArray
    band: Band
    fine: Band
    out: Band
    t_fine: FloatArray
    q_fine: FloatArray
    v_fine: FloatArray
    wide: tuple[FloatArray, FloatArray, FloatArray]
    velocity_noise: tuple[float, ...]
    position_step: tuple[float, ...]
    torque_noise: tuple[float, ...]
    acceleration_noise: FloatArray
    rests: tuple[FloatArray, ...]
    seconds: float
    notes: tuple[str, ...]

    def column(self, fine: FloatArray, jumps: bool = False) -> FloatArray:
        """What the filter leaves (m, ...) of a torque (M, ...) formed at the fine samples.

        jumps : it does, and its values are means over each sample's step.
        """
        return self.fine.filtered(fine, self.out, means=jumps)[0][self.out.trimmed]

    def rigid(self, arm: Arm) -> FloatArray:
        """Torque (m, k) of an arm's model: through the filter, as the recorded one went, and not of a motion that went
        through it, whose products are others."""
        return self.column(arm.inverse(*self.wide)[:, self.dof])

    def sure_speed(self, joint: int) -> float:
        """Speed from which its sign is sure, rad/s."""
        fast = float(np.quantile(np.abs(self.v_fine[:, self.dof[joint]]), 0.95))
        return max(SURE.value * self.velocity_noise[joint], RESTING.value * fast)

    def away(self, joint: int, width: float) -> BoolArray:
        """Samples (m,) over whose whole +-``width``, s, a joint moves one way at a sure speed."""
        v = self.v_fine[:, self.dof[joint]]
        slow = np.abs(v) <= self.sure_speed(joint)
        slow[1:] |= np.sign(v[1:]) != np.sign(v[:-1])
        clear = ~widened(slow, round(width * self.fine.rate))
        step = round(self.fine.rate / self.out.rate)
        return self.good & clear[::step][: self.out.size][self.out.trimmed]

    @property
    def moving(self) -> tuple[int, ...]:
        """Joints with enough guarded samples in both directions."""
        found = []
        for j, dof in enumerate(self.dof):
            v = self.v[self.away(j, GUARD.value / self.band.lowpass), dof]
            fewer = min(np.sum(v > 0), np.sum(v < 0))
            if v.size >= LEAST_SAMPLES.value and fewer >= EITHER_WAY.value * LEAST_SAMPLES.value:
                found.append(j)
        return tuple(found)


def widened(mask: BoolArray, reach: int) -> BoolArray:
    """A mask (n,) with ``reach`` more on either side of what it holds."""
    total = np.concatenate(([0], np.cumsum(mask)))
    rows = np.arange(mask.size)
    return np.asarray(total[np.minimum(rows + reach + 1, mask.size)] - total[np.maximum(rows - reach, 0)] > 0)


def reversals(v: FloatArray, sure: float) -> FloatArray:
    """Where (r,) in samples the speed (n,) changes its sign, from beyond one sure level to beyond the other."""
    side = np.where(v > sure, 1, np.where(v < -sure, -1, 0))
    known = np.flatnonzero(side)
    turns = np.flatnonzero(side[known][1:] != side[known][:-1])
    return (known[turns] + known[turns + 1]) / 2.0


def differentiate(
    log: JointLog, arm: Arm, joints: Sequence[str] | None = None, lowpass: float | None = None, late: float = 0.0
) -> Filtered:
    """Positions and torques of a log, filtered; ``late`` : s by which the torque's record is moved ahead.

    joints : those whose torque is looked at, by default every one logged with effort.

    Raises InputError where the log has no effort, a joint that the arm has not, is too short, or lacks a joint that
    the arm needs; or where ``lowpass``, Hz, is not below a quarter of the log's rate.
    """
    names = _effort_joints(log, arm, joints)
    seconds = long_enough(log)
    step = np.diff(log.t)
    jittered = not np.ptp(step) < _JITTER * np.median(step)
    rate = 1.0 / float(np.median(step)) if jittered else (log.t.size - 1) / seconds
    even = log.t[0] + np.arange(int(seconds * rate * (1 + 1e-12)) + 1) / rate
    notes = [f"Uneven time stamps were put on {rate:.4g} Hz."] if jittered else []

    def regular(y: FloatArray) -> FloatArray:
        return np.interp(even, log.t, y) if jittered else np.asarray(y[: even.size])

    q = np.tile(np.asarray(arm.model.qpos0, dtype=np.float64), (even.size, 1))
    for i, name in enumerate(arm.joints):
        if name in log.position:
            q[:, i] = regular(log.position[name])
        else:
            notes.append(f"{name} was not logged and is taken to rest at {q[0, i]:.4g}.")
    torque = np.stack([regular(log.effort[name]) for name in names], axis=1)
    dof = tuple(arm.joints.index(name) for name in names)
    cut = _lowpass(log.file, q[:, dof], rate, lowpass)
    band = Band(cut, even.size, rate)
    fine = band.taken(_COLUMNS * cut)
    out = fine.taken(_FIT * cut)
    kept = out.trimmed
    t = even[0] + np.arange(out.size) / out.rate
    good, reach = np.ones(t.size, dtype=np.bool_), 1.5 / cut
    for gap in np.flatnonzero(step > _GAP * np.median(step)):
        good &= (t < log.t[gap] - reach) | (t > log.t[gap + 1] + reach)
    quanta, speeds, still, bends = [], [], [], np.zeros(len(arm.joints))
    for i, name in enumerate(arm.joints):
        if name not in log.position:
            continue
        quantum, noise = _quantum(log.position[name]), white_sd(q[:, i])
        level = 2.0 * max(noise**2, quantum**2 / 12.0) / rate
        bends[i] = math.sqrt(level * (2 * math.pi) ** 4 * cut**5 * _BENDS)
        if i not in dof:
            continue
        quanta.append(quantum)
        speeds.append(math.sqrt(level * (2 * math.pi) ** 2 * cut**3 / 3.0))
        within, width = 2.0 * max(quantum, _NOISES * noise), max(int(STICKS.value / cut * rate), 1)
        first, last = rests(q[:, i], within, width + 1)
        turn = turning(q[:, i], within, first, last, max(int(GUARD.value / cut * rate), 1))
        longer = last - first > turn + np.maximum(0.5 * width, _OWN * turn)
        still.append(even[np.column_stack((first, last))[longer]])
    position, speed, acceleration = (y[kept] for y in band.filtered(q, out, 2))
    q_fine, v_fine = band.filtered(q, fine, 1)
    q_wide, v_wide, a_wide = replace(band, lowpass=_WIDE * cut).filtered(q, fine, 2)
    moved = band.filtered(torque, out, late=late)[0][kept]
    unheard = np.full(log.t.size, np.nan)
    warmth = np.stack([np.interp(t[kept], log.t, log.temperature.get(name, unheard)) for name in names], axis=1)
    noises = tuple(_noise_of(y, _quantum(log.effort[name]), rate, cut) for name, y in zip(names, torque.T, strict=True))
    return Filtered(
        names, dof, t[kept], position, speed, acceleration, moved, warmth, good[kept], band, fine, out,
        even[0] + np.arange(fine.size) / fine.rate, q_fine, v_fine, (q_wide, v_wide, a_wide), tuple(speeds),
        tuple(quanta), noises, bends, tuple(still), seconds, tuple(notes),
    )  # fmt: skip


def long_enough(log: JointLog) -> float:
    """Duration of a log, s. Raises InputError where it is too short to say anything of an arm."""
    seconds = float(log.t[-1] - log.t[0])
    if seconds < LEAST_SECONDS:
        raise InputError(log.file, f"{seconds:.3g} s", f"a log of at least {LEAST_SECONDS:g} s")
    return seconds


def _effort_joints(log: JointLog, arm: Arm, joints: Sequence[str] | None) -> tuple[str, ...]:
    """Joints with position and effort, in the arm's order; unknown ones are refused."""
    accepted = f"joints of {arm.file}: {', '.join(arm.joints)}"
    if not log.effort:
        raise InputError(log.file, "no joint's effort", "a log with torques of joints")
    asked = tuple(log.effort) if joints is None else tuple(joints)
    for name in asked:
        if name not in arm.joints:
            raise InputError(log.file, f"joint {name}", accepted)
        if name not in log.effort or name not in log.position:
            raise InputError(log.file, f"joint {name} without position or effort", "a joint with both")
    if not asked:
        raise InputError(log.file, "no joint asked for", accepted)
    return tuple(name for name in arm.joints if name in asked)


def _lowpass(file: str, q: FloatArray, rate: float, given: float | None) -> float:
    """Hz: as asked for, or so that the motion passes."""
    most = rate / 4.0
    if given is not None:
        if not 0.0 < given <= most:
            raise InputError(f"{file}: lowpass", f"{given:g} Hz", f"above 0 and up to {most:.4g} Hz")
        return given
    f = np.fft.rfftfreq(q.shape[0], 1.0 / rate)
    flat = q - np.linspace(q[0], q[-1], q.shape[0])
    power = np.sum((np.abs(np.fft.rfft(flat, axis=0)) * (2 * math.pi * f)[:, None]) ** 2, axis=1) * (f < _MOTION)
    share = np.cumsum(power) / max(float(np.sum(power)), 1e-300)
    held = float(f[min(int(np.searchsorted(share, _HELD)), f.size - 1)])
    return min(max(_ABOVE * held, _LOWEST), _HIGHEST, most)


def _noise_of(torque: FloatArray, step: float, rate: float, cut: float) -> float:
    """What noise and steps of a recorded torque (n,) leave behind the filter, N m.

    An error of a step lasts as long as the torque stays on one level, and so much less of it a filter takes off.
    """
    held = torque.size / max(int(np.count_nonzero(np.diff(torque))), 1)
    white, stepped = white_sd(torque) ** 2 * 2.0 * cut / rate, step**2 / 12.0
    return math.sqrt(max(white, stepped * min(2.0 * cut * held / rate, 1.0)))


def _quantum(q: FloatArray) -> float:
    """The least step of a position, which is an encoder's where most steps are whole multiples of it; else 0.

    A fine encoder shows hardly a level twice, so that no ladder of levels tells it.
    """
    steps = np.abs(np.diff(q))
    steps = steps[steps > 1e-12]
    if not steps.size:
        return 0.0
    least = float(np.quantile(steps, 0.01))
    whole = np.abs(steps / least - np.round(steps / least)) < _OFF
    return least if float(np.mean(whole)) > _STEPPED else 0.0
