"""Steady response to a harmonic force: Den Hartog's closed form, and the periodic motion with stops.

Source: Den Hartog, Forced vibrations with combined Coulomb and viscous friction, Trans. ASME 53 (1931), with viscous
damping included: over half a period without a stop the motion is linear, and its end is its beginning mirrored.
"""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray, ModeArray
from harness.core.checks import increasing, positive, vector
from harness.core.errors import InputError, SimulationError
from harness.core.events import EventKind, Events
from harness.core.scenario import Harmonic
from harness.core.slider import Slider
from harness.core.trajectory import Source, Trajectory
from harness.exact import forced
from harness.exact.forced import System
from harness.exact.segments import DIRECTION, POSITION, SPEED, START, discriminant, flow

_MOST_PIECES = 400  # of one period
_MOST_CYCLES = 100_000


@dataclass(frozen=True, slots=True)
class DrivenMotion:
    """Slips and stops of a slider under a harmonic force; arrays have shape (n,), one entry a piece.

    start : s. x, v : state there, m and m/s. direction : sign of the speed, 0 in a stop.
    """

    slider: Slider
    drive: Harmonic
    table: FloatArray

    @property
    def start(self) -> FloatArray:
        """Times in s at which the pieces begin."""
        return np.ascontiguousarray(self.table[:, START])

    @property
    def direction(self) -> ModeArray:
        """Contact state (core.events.Mode) of the pieces."""
        return self.table[:, DIRECTION].astype(np.int8)

    def states(self, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, ModeArray]:
        """x, v, a and contact state at times ``t`` (n,) in s that do not lie before the first piece."""
        index = np.maximum(np.searchsorted(self.table[:, START], t, side="right") - 1, 0)
        x, v, a = np.empty((3, t.size))
        forced.fill_forced(_system(self.slider, self.drive), self.table, index, t, x, v, a)
        return x, v, a, self.direction[index]

    def events(self) -> Events:
        """Reversals, stops and break-aways at the joints of the pieces."""
        system = _system(self.slider, self.drive)
        before, after = self.table[:-1], self.table[1:]
        t, x = after[:, START].copy(), after[:, POSITION].copy()
        a_before = np.array([forced.state_at(system, row, time)[2] for row, time in zip(before, t, strict=True)])
        a_after = np.array([forced.state_at(system, row, time)[2] for row, time in zip(after, t, strict=True)])
        kind = np.full(t.size, int(EventKind.REVERSAL))
        kind[after[:, DIRECTION] == 0] = int(EventKind.STICK)
        kind[before[:, DIRECTION] == 0] = int(EventKind.BREAK_AWAY)
        return Events(t, kind, x, a_before, a_after)

    def sample(self, t: FloatArray) -> Trajectory:
        """The motion at increasing times ``t`` (s), with the force as channel u and the events in between."""
        times = vector("harmonic: t", t)
        increasing("harmonic: t", times)
        if times[0] < self.table[0, START]:
            found = f"{times[0]:g} s, before the motion begins"
            raise InputError("harmonic: t", found, f"times from {self.table[0, START]:g} s on")
        x, v, a, mode = self.states(times)
        events = self.events()
        inside = (events.t >= times[0]) & (events.t <= times[-1])
        events = Events(
            *(values[inside] for values in (events.t, events.kind, events.x, events.a_before, events.a_after))
        )
        u = self.drive.amplitude * np.cos(self.drive.omega * times + self.drive.phase)
        return Trajectory(times, x, v, a, Source("reference", "exact"), u=u, mode=mode, events=events)


@dataclass(frozen=True, slots=True)
class Response:
    """The periodic motion under a harmonic force.

    motion : one period of it from t = 0. amplitude : half of the distance between its turning points, m.
    stop_fraction : share of the period at rest. stops : how many a period; 0 is Den Hartog's continuous motion.
    """

    motion: DrivenMotion
    amplitude: float
    stop_fraction: float
    stops: int

    @property
    def period(self) -> float:
        """Of the force, s."""
        return 2.0 * math.pi / self.motion.drive.omega

    def states(self, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, ModeArray]:
        """x, v, a and contact state at any times ``t`` (n,) in s; the phase is that of the force."""
        return self.motion.states(np.mod(t, self.period))


def _system(slider: Slider, drive: Harmonic) -> System:
    """What the kernels need; InputError at undamped resonance, which has no forced response."""
    r = drive.omega / slider.omega_n
    in_phase, out_of_phase = (1.0 - r) * (1.0 + r), 2.0 * slider.zeta * r
    if math.hypot(in_phase, out_of_phase) < 1e-9:
        found = f"{drive.omega:g} rad/s, the natural frequency of a slider without viscous damping"
        raise InputError("drive: omega", found, "another frequency, or c above 0")
    # a negative amplitude is a force half a turn later
    push, phase = abs(drive.amplitude) / slider.k, drive.phase + (math.pi if drive.amplitude < 0.0 else 0.0)
    ripple = push / math.hypot(in_phase, out_of_phase)
    lag = math.atan2(out_of_phase, in_phase)
    return slider.omega_n, slider.zeta, slider.x_k, slider.x_s, push, drive.omega, phase, ripple, phase - lag


def _peak(system: System) -> tuple[float, float] | None:
    """Time (s) and height (m) of a maximum of the continuous motion; None where it is not a motion without stops."""
    omega_n, zeta, x_k, x_s, _, drive, _, ripple, phase = system
    sigma, half = zeta * omega_n, math.pi / drive
    c, s = flow(half, omega_n, sigma, discriminant(omega_n, zeta))
    # the free part (b - x_k, d) at the maximum becomes (-b - x_k, -d) half a period later
    p11, p12, p21, p22 = c + sigma * s, s, -omega_n * omega_n * s, c - sigma * s
    determinant = (1.0 + p11) * (1.0 + p22) - p12 * p21
    if determinant == 0.0:
        return None
    b = x_k * ((p11 - 1.0) * (1.0 + p22) - p12 * p21) / determinant
    d = x_k * (p21 * (1.0 + p11) - p21 * (p11 - 1.0)) / determinant
    sine = d / (ripple * drive) if ripple > 0.0 else math.inf
    if not abs(sine) <= 1.0:
        return None
    height = b + ripple * math.sqrt((1.0 - sine) * (1.0 + sine))
    time = (math.asin(sine) - phase) / drive
    if forced.pull(system, time, height) >= -x_s:
        return None
    end = forced.slip_end(system, time, height, 0.0, -1.0, time + 1.5 * half)
    return (time, height) if abs(end - time - half) < 1e-6 * half else None


def continuous_amplitude(slider: Slider, drive: Harmonic) -> float:
    """Amplitude (m) of the motion without stops, in closed form.

    Undamped it is (A/k) sqrt(V^2 - (f_k/A)^2 U^2), V = 1/(1 - r^2), U = sin(pi/r) / (r (1 + cos(pi/r))).
    Raises InputError where the slider stops, naming the least force that keeps it moving (see ``least_force``).
    """
    peak = _peak(_system(slider, drive))
    if peak is None:
        least = least_force(slider, drive.omega)
        accepted = f"{least:.6g} N or more" if math.isfinite(least) else "another frequency"
        raise InputError("drive: amplitude", f"{drive.amplitude:g} N, with which the slider stops", accepted)
    return peak[1]


def least_force(slider: Slider, omega: float) -> float:
    """The least amplitude (N) of a force of frequency ``omega`` (rad/s) that keeps the slider from stopping.

    This is the limit of the closed form, found by bisection to 1e-12; inf where no force does (r = 1/3, undamped).
    """
    positive("drive: omega", omega, "rad/s")

    def moves(force: float) -> bool:
        return _peak(_system(slider, Harmonic(force, omega))) is not None

    high = max(slider.break_away, slider.f_k)
    if high == 0.0:
        return 0.0
    low = 0.0
    while not moves(high):
        low, high = high, 2.0 * high
        if high > 1e9 * slider.break_away:
            return math.inf
    while high - low > 1e-12 * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if moves(middle) else (middle, high)
    return high


def driven(slider: Slider, drive: Harmonic, x0: float, v0: float, until: float) -> DrivenMotion:
    """The motion from x0 (m), v0 (m/s) at t = 0 up to ``until`` (s), exact."""
    positive("harmonic: until", until, "s")
    system = _system(slider, drive)
    rows = 64 + 8 * int(until * max(slider.omega_n, drive.omega))
    table = np.empty((rows, 5))
    count = forced.walk_forced(system, 0.0, x0, v0, until, table)
    if count > rows:
        raise SimulationError(f"harmonic: more than {rows} stops and reversals up to {until:g} s")
    table = table[:count].copy()
    table.flags.writeable = False
    return DrivenMotion(slider, drive, table)


def response(slider: Slider, drive: Harmonic) -> Response:
    """The periodic motion: the closed form where the slider does not stop, else what it settles to from rest at 0.

    With |A| <= f_s and no continuous motion it never moves: amplitude 0, stop_fraction 1. Raises SimulationError when
    it does not settle on the period of the force.
    """
    system = _system(slider, drive)
    period = 2.0 * math.pi / drive.omega
    peak = _peak(system)
    table = np.empty((_MOST_PIECES, 5))
    if peak is not None:
        # follow the continuous orbit from its maximum to the next whole period
        whole = math.ceil(peak[0] / period) * period
        x, v = peak[1], 0.0
        if whole > peak[0]:
            count = forced.walk_forced(system, peak[0], x, v, whole, table)
            x, v, _ = forced.state_at(system, table[count - 1], whole)
    else:
        tolerance = 1e-14 * (system[7] + system[3])
        cycles, x, v, change = forced.settle(system, 0.0, 0.0, tolerance, _MOST_CYCLES, table)
        if change > tolerance:
            raise SimulationError(
                f"harmonic: no motion with the period of the force after {cycles} cycles, change {change:.3g} m"
            )
    motion = driven(slider, drive, x, v, period)
    if peak is not None:
        return Response(motion, peak[1], 0.0, 0)
    rows, lasts = motion.table, np.diff(np.append(motion.start, period))
    resting = motion.direction == 0
    if resting.all():
        return Response(motion, 0.0, 1.0, 1)
    turning = rows[rows[:, SPEED] == 0.0, POSITION]
    stops = int(resting.sum()) - int(resting[0] and resting[-1])
    return Response(motion, 0.5 * float(np.ptp(turning)), float(lasts[resting].sum()) / period, stops)
