"""Simulate a model: the Python side of the compiled integrator.

What a simulation is given besides the model: a drive, scales of the motion, and how hard to try.
"""

import math
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from harness.core.arrays import FloatArray, IntArray, ModeArray, read_only
from harness.core.budget import allowed, spend
from harness.core.checks import finite, increasing, vector
from harness.core.errors import InputError, SimulationError
from harness.core.events import Events
from harness.core.jit import compiled
from harness.core.trajectory import Source, Trajectory
from harness.kernels.integrate import DIVERGED, DONE, EVENT_COLUMNS, TOO_MANY_EVENTS, integrate
from harness.kernels.layout import Layout, lay_out
from harness.kernels.work import workspace
from harness.model.model import Model, Restoring
from harness.model.term import Slot

TOLERANCE = 1e-9
"""Default error per step relative to the scale of the motion."""


@dataclass(frozen=True, slots=True)
class Drive:
    """A measured force: knots t (k,) in s and values u (k,) in N (per unit mass when the mass is unknown).

    Linear between the knots, or held from each to the next as a sampled controller's; constant outside them. Raises
    InputError for times that do not increase, lengths that differ, or a value that is not finite.
    """

    t: FloatArray
    u: FloatArray
    held: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "t", vector("drive: t", self.t))
        object.__setattr__(self, "u", vector("drive: u", self.u, self.t.size))
        if self.t.size == 0:
            raise InputError("drive", "no knots", "at least one")
        increasing("drive: t", self.t)

    def within(self, begin: float, end: float) -> tuple[FloatArray, FloatArray]:
        """The knots that decide the force from ``begin`` to ``end`` (s)."""
        first = max(int(np.searchsorted(self.t, begin, side="right")) - 1, 0)
        last = int(np.searchsorted(self.t, end, side="left")) + 1
        return self.t[first:last], self.u[first:last]

    def over(self, begin: float, end: float) -> "Drive":
        """The same force, in time since ``begin`` (s), up to ``end``."""
        at, force = self.within(begin, end)
        return replace(self, t=at - begin, u=force)

    @property
    def straight(self) -> "Drive":
        """In straight lines that pass on as much momentum: of a force that is held, half an interval later."""
        if not self.held:
            return self
        return Drive(np.append(0.5 * (self.t[1:] + self.t[:-1]), self.t[-1]), self.u)

    def at(self, t: FloatArray) -> FloatArray:
        """The force (n,), N, at times t (n,), s; of a step what holds after it."""
        if not self.held:
            return np.interp(t, self.t, self.u)
        return np.asarray(self.u[np.maximum(np.searchsorted(self.t, t, side="right") - 1, 0)], dtype=np.float64)


@dataclass(frozen=True, slots=True)
class Scales:
    """What counts as ordinary in a motion: displacement (m), speed (m/s), and an angular frequency (rad/s)."""

    x: float
    v: float
    omega: float

    @classmethod
    def of(cls, model: Model, drive: Drive | None = None) -> "Scales":
        """From the model itself: its release, its frequency, what pushes and knocks it."""
        omega = math.sqrt(model.k / model.m) if model.restoring is not Restoring.NONE else 0.0
        push = float(np.max(np.abs(drive.u))) if drive is not None else 0.0
        push += sum(abs(e.values[e.term.push]) for e in model.terms if e.term.push is not None)
        if omega == 0.0:
            # without a spring: the time in which viscous damping stops it, at least the recording's own scale
            span = float(drive.t[-1] - drive.t[0]) if drive is not None and drive.t.size > 1 else 1.0
            omega = max(model.c / model.m, 6.0 / span)
        speed = abs(model.v0) + sum(abs(e.values[1]) / model.m for e in model.in_slot(Slot.EVENT))
        inside = max((abs(w) for e in model.terms for w in e.internal0), default=0.0)
        x = max(abs(model.x0), speed / omega, push / model.m / omega**2, inside, 1e-12)
        return cls(x, max(speed, x * omega), omega)


@dataclass(frozen=True, slots=True)
class Effort:
    """How hard to try: error per step relative to the scales, and the most steps a cycle of the motion may take."""

    tolerance: float = TOLERANCE
    steps_per_cycle: int = 4000


__all__ = ["TOLERANCE", "By", "Drive", "Effort", "Scales", "Solution", "simulate", "solve"]

_NO_DRIVE: FloatArray = np.empty(0)
_SENSITIVITY = 10.0
"""Error allowed in the sensitivities, relative to their own size, over that in the state."""
_LOOKS = 12
"""Steps a cycle of the fastest force in time, while the slider sticks and waits for it."""
_AT_ONCE = 3
"""Half cycles whose steps may be taken at one place: a law that turns infinitely stiff there ends the run."""

_EVENTS_AT_FIRST, _MOST_EVENTS = 100_000, 1_000_000
"""Rows there is room for, however many half-cycles a nearly massless slider would go through."""

_MOST_STEPS = 20_000_000
"""Whatever time is asked for: eight hundred thousand cycles of the fewest steps."""

_CALL = 200
"""Steps that a call costs besides."""

By: TypeAlias = str | tuple[int, int]
"""A parameter to differentiate by: a name, or (index of a term in the model, index of its parameter)."""


@dataclass(frozen=True, slots=True)
class Solution:
    """Samples and their sensitivities.

    x, v, a, mode : (N,). dx, dv, da : (N, q), partials by the q parameters in ``by``. events : of the motion.
    """

    x: FloatArray
    v: FloatArray
    a: FloatArray
    mode: ModeArray
    dx: FloatArray
    dv: FloatArray
    da: FloatArray
    by: tuple[By, ...]
    events: Events
    steps: int


def _columns(layout: Layout, by: tuple[By, ...]) -> tuple[IntArray, FloatArray]:
    """Places in theta and starting sensitivities of the parameters asked for."""
    columns = np.full(len(by), -1, dtype=np.int64)
    start = np.zeros((layout.start.size, len(by)))
    for q, name in enumerate(by):
        if isinstance(name, tuple):
            columns[q] = layout.term_at[name[0]] + name[1]
        elif name == "v0":
            # what moves with the slider starts with it
            start[list(layout.speeds), q] = 1.0
        elif name == "x0":
            start[0, q] = 1.0
        elif name in layout.state_names[2:]:
            start[layout.state_names.index(name), q] = 1.0
        elif name in layout.names:
            columns[q] = layout.names.index(name)
        else:
            known = ", ".join(("x0", "v0", *layout.state_names[2:], *layout.names))
            raise InputError("sensitivities", f"{name!r} is no parameter of the model", f"one of {known}")
    return columns, start


@compiled
def _in_order(times: FloatArray) -> bool:
    """Whether there are times, all finite, and none comes before the one before it."""
    before = -math.inf
    for t in times:
        if not (before <= t < math.inf) or t == -math.inf:
            return False
        before = t
    return times.size > 0


def _times(t: FloatArray, where: str = "simulation: t") -> FloatArray:
    """Sample times, checked."""
    times = read_only(t)
    if times.ndim == 1 and _in_order(times):
        return times
    if times.ndim != 1 or times.size == 0:
        raise InputError(where, f"an array of shape {times.shape}", "a vector of at least one time")
    if not np.isfinite(times).all():
        row = int(np.flatnonzero(~np.isfinite(times))[0])
        finite(f"{where}, row {row + 1}", float(times[row]))
    back = np.flatnonzero(np.diff(times) < 0.0)
    if back.size:
        row = int(back[0]) + 1
        found = f"time {times[row]:.9g} s comes before {times[row - 1]:.9g} s"
        raise InputError(f"{where}, row {row + 1}", found, "times that do not decrease")
    return times


def _errors(layout: Layout, model: Model, scales: Scales, tolerance: float) -> FloatArray:
    """Error allowed in a step for every state, (n,)."""
    error = np.full(layout.start.size, tolerance * scales.x)
    error[list(layout.speeds)] = tolerance * scales.v
    for law in model.in_slot(Slot.FRICTION_LAW):
        if law.term.internal:
            # the bristle's own scale is the presliding displacement, far below that of the motion
            error[2] *= min(1.0, max(1e-9, model.f_k / (law.values[0] * scales.x + 1e-300)))
    return error


def solve(
    model: Model,
    t: FloatArray,
    by: tuple[By, ...] = (),
    drive: Drive | None = None,
    scales: Scales | None = None,
    effort: Effort = Effort(),
    want_a: bool = True,
    shortest_cycle: float = 24.0,
) -> Solution:
    """Simulate a model at the times t (s, not decreasing; those before its release show it held there).

    by : parameters to differentiate by ("c", "x0", "cubic-stiffness.k3", "viscoelastic.w0"). drive : force, or None.
    effort : accuracy and patience. shortest_cycle : least steps a cycle is given. At an event a sample shows what holds
    after it. Raises SimulationError when the motion cannot be followed, InputError for bad times or an unknown name.
    """
    times = _times(t)
    scales = scales or Scales.of(model, drive)
    layout = lay_out(model, scales.v)
    columns, start = _columns(layout, by)
    error = _errors(layout, model, scales, effort.tolerance)
    n, q_count = times.size, len(by)
    # what a step costs grows with its sensitivities, and so does what is shown at a sample
    each_step, beside = 1 + q_count // 8, _CALL + n * (2 + q_count) // 8
    most = min(_MOST_STEPS, allowed(_MOST_STEPS * each_step) // each_step)
    x, v, a = np.empty(n), np.empty(n), np.zeros(n)
    mode = np.empty(n, dtype=np.int8)
    dx, dv, da = np.empty((n, q_count)), np.empty((n, q_count)), np.zeros((n, q_count))
    end = float(times[-1])
    cycles = max(end - model.t0, 0.0) * scales.omega / math.pi + 1.0
    events = np.zeros((min(64 + int(4 * cycles), _EVENTS_AT_FIRST), EVENT_COLUMNS))
    u_t, u_y = (_NO_DRIVE, _NO_DRIVE) if drive is None else drive.within(model.t0, max(end, model.t0))
    steps_up = drive is not None and drive.held
    h_max = 2.0 * math.pi / scales.omega / shortest_cycle
    h_stick = min(h_max, 2.0 * math.pi / _LOOKS / max(layout.fastest, scales.omega))
    at_once, pace = _AT_ONCE * effort.steps_per_cycle + 20 * u_t.size, effort.steps_per_cycle * scales.omega / math.pi
    fixed = (read_only(u_t), read_only(u_y), steps_up, times, h_stick, at_once, pace, most, want_a)
    while True:
        record = workspace(layout.spec, layout.theta, len(layout.names), columns, error, layout.start, start)
        record.h_max, record.sensitivity_error = h_max, _SENSITIVITY * effort.tolerance
        status, n_events, steps, reached = integrate(model.t0, record, *fixed, x, v, a, mode, dx, dv, da, events)
        spend(each_step * steps + beside)
        if status != TOO_MANY_EVENTS or events.shape[0] > _MOST_EVENTS:
            break
        events = np.zeros((4 * events.shape[0], EVENT_COLUMNS))
    if status != DONE:
        why = "it diverged" if status == DIVERGED else f"it took more than {steps} steps"
        raise SimulationError(f"the model could not be followed beyond t = {reached:.6g} s: {why}")
    if not np.isfinite(events[:n_events]).all():
        raise SimulationError(f"the model could not be followed up to t = {end:.6g} s: it diverged at an event")
    t_event, kind, x_event, before, after = np.ascontiguousarray(events[:n_events].T)
    log = Events.sure(t_event, kind.astype(np.int64), x_event, before, after)
    return Solution(x, v, a, mode, dx, dv, da, by, log, steps)


def simulate(model: Model, t: FloatArray, drive: Drive | None = None, tolerance: float = 1e-11) -> Trajectory:
    """A model's motion as a Trajectory of the reference, at the times t (s)."""
    s = solve(model, t, drive=drive, effort=Effort(tolerance))
    u = drive.at(t) if drive is not None else None
    source = Source("reference", "exact", settings={"tolerance": tolerance})
    return Trajectory(t, s.x, s.v, s.a, source, u=u, mode=s.mode, events=s.events)
