"""Free decay of any slider, exact: turning points, events and samples; how long a run should last.

Source: Liang, eqs. 2 to 6, extended to any start, f_s > f_k, and every damping ratio.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from harness.core.arrays import FloatArray, ModeArray, read_only
from harness.core.checks import finite, increasing, not_negative, positive, vector
from harness.core.errors import InputError
from harness.core.events import EventKind, Events
from harness.core.scenario import Hold, Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Source, Trajectory
from harness.exact import segments
from harness.exact.fill import disorder
from harness.exact.fill import fill_at as _fill_at
from harness.exact.fill import fill_uniform as _fill_uniform
from harness.exact.segments import CENTRE, DIRECTION, POSITION, SPEED, START

_MOST_HALF_CYCLES = 10_000_000


@dataclass(frozen=True, slots=True)
class Decay:
    """A free decay without its mass: everything that decides x(t).

    omega_n : rad/s. zeta : damping ratio. x_k : f_k/k, m. x_s : f_s/k, m (``x_k`` when not given).
    x0 : start, m. v0 : start, m/s. It begins at t = 0; before that the slider is held at x0.

    Raises InputError for omega_n not above 0, zeta or x_k below 0, x_s below x_k, or anything not finite.
    """

    omega_n: float
    zeta: float
    x_k: float
    x0: float = 1.0
    v0: float = 0.0
    x_s: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "omega_n", positive("decay: omega_n", self.omega_n, "rad/s"))
        object.__setattr__(self, "zeta", not_negative("decay: zeta", self.zeta))
        object.__setattr__(self, "x_k", not_negative("decay: x_k", self.x_k, "m"))
        object.__setattr__(self, "x0", finite("decay: x0", self.x0))
        object.__setattr__(self, "v0", finite("decay: v0", self.v0))
        x_s = self.x_k if self.x_s is None else not_negative("decay: x_s", self.x_s, "m")
        if x_s < self.x_k:
            raise InputError("decay: x_s", f"{x_s:g} m, below x_k = {self.x_k:g} m", "x_s >= x_k")
        object.__setattr__(self, "x_s", x_s)

    @classmethod
    def of(cls, slider: Slider, x0: float, v0: float = 0.0) -> "Decay":
        """The decay of ``slider`` from x0 (m) with v0 (m/s)."""
        return cls(slider.omega_n, slider.zeta, slider.x_k, x0, v0, slider.x_s)

    @classmethod
    def of_scenario(cls, scenario: Scenario) -> "Decay":
        """The decay a scenario describes; InputError when something acts on its slider."""
        if scenario.action is not None:
            raise InputError(f"scenario {scenario.name}", "an acting force or belt", "a free decay")
        return cls.of(scenario.slider, scenario.x0, scenario.v0)

    @property
    def break_away(self) -> float:
        """x_s in m, never None."""
        return self.x_k if self.x_s is None else self.x_s

    @property
    def arguments(self) -> tuple[float, float, float, float, float, float]:
        """omega_n, zeta, x_k, x_s, x0, v0: the leading arguments of every kernel of this room."""
        return self.omega_n, self.zeta, self.x_k, self.break_away, self.x0, self.v0


@dataclass(frozen=True, slots=True)
class Schedule:
    """The half-cycles of a decay; arrays have shape (n,), one entry a half-cycle (or final rest).

    start : s. x, v : state there, m and m/s. centre : m. direction : sign of the speed, 0 at rest.
    stick_time : s; None when it never sticks, or not within the time asked for. events : reversals and the stick.
    """

    start: FloatArray
    x: FloatArray
    v: FloatArray
    centre: FloatArray
    direction: ModeArray
    stick_time: float | None
    events: Events = field(default_factory=Events)

    @property
    def turning_points(self) -> FloatArray:
        """Positions of rest in order, m: the start when it is at rest, every reversal, the stick."""
        at_rest: FloatArray = self.x[self.v == 0.0]
        return at_rest

    def mode(self, t: FloatArray) -> ModeArray:
        """Contact state (core.events.Mode) at the times ``t`` in s; stuck while held before the start."""
        index = np.searchsorted(self.start, t, side="right")
        return np.concatenate(([np.int8(0)], self.direction))[index].astype(np.int8)


def never_sticks(decay: Decay) -> bool:
    """Whether it goes on for ever: without friction, undamped without f_k, or creeping in at zeta >= 1."""
    if decay.break_away == 0.0:
        return True
    x = decay.x0
    if decay.v0 != 0.0:
        time, x = segments.first_reversal(decay.omega_n, decay.zeta, decay.x_k, decay.x0, decay.v0)
        if time == math.inf:
            return True
    return abs(x) > decay.break_away and (decay.zeta >= 1.0 or (decay.zeta == 0.0 and decay.x_k == 0.0))


def schedule(decay: Decay, until: float | None = None) -> Schedule:
    """The half-cycles of ``decay`` that begin up to ``until`` (s), or all of them.

    Raises InputError when there is no end to them and ``until`` is not given, or more than ten million.
    """
    omega_n, zeta = decay.omega_n, decay.zeta
    if until is None:
        if zeta < 1.0 and never_sticks(decay):
            raise InputError("schedule: until", "none, for a slider that never sticks", "a time in s")
        until = math.inf
    elif not until >= 0.0:
        raise InputError("schedule: until", f"{until}", "a time of 0 s or more")
    check_span(decay, until)
    table = segments.half_cycles(*decay.arguments, until)
    start, x, v = (np.ascontiguousarray(table[:, column]) for column in (START, POSITION, SPEED))
    centre, direction = np.ascontiguousarray(table[:, CENTRE]), table[:, DIRECTION].astype(np.int8)
    sticks = direction[-1] == 0 and decay.break_away > 0.0
    after = omega_n**2 * (centre - x) - 2.0 * zeta * omega_n * v
    before = np.empty_like(after)
    before[1:] = omega_n**2 * (centre[:-1] - x[1:])
    before[0] = 0.0
    # a row that starts at rest at t = 0 is no event, unless it is stuck there
    event = np.arange(start.size) > 0
    event[0] = sticks and start.size == 1
    kind = np.where(direction == 0, int(EventKind.STICK), int(EventKind.REVERSAL))
    events = Events(start[event], kind[event], x[event], before[event], after[event])
    for array in (start, x, v, centre, direction):
        array.flags.writeable = False
    return Schedule(start, x, v, centre, direction, float(start[-1]) if sticks else None, events)


def check_span(decay: Decay, until: float) -> None:
    """Refuse a span whose half-cycles would not fit into memory."""
    if until * decay.omega_n < _MOST_HALF_CYCLES:
        return
    probe = np.empty((0, 5))
    limit = math.inf
    if decay.zeta < 1.0:
        limit = _MOST_HALF_CYCLES * math.pi / (decay.omega_n * math.sqrt((1.0 - decay.zeta) * (1.0 + decay.zeta)))
    if segments.walk(*decay.arguments, min(until, limit), probe) >= _MOST_HALF_CYCLES:
        raise InputError("free decay", "more than ten million half-cycles", "a shorter time")


def check_outputs(shape: tuple[int, ...], *arrays: FloatArray) -> None:
    """Raise InputError unless every array is one a kernel can write to: contiguous float64 of this shape."""
    for array in arrays:
        if array.shape != shape or array.dtype != np.float64 or not array.flags.c_contiguous:
            found = f"an array of {array.dtype}, shape {array.shape}"
            raise InputError("free decay: arrays", found, f"contiguous float64 of shape {shape}")


def check_times(decay: Decay, t: FloatArray) -> None:
    """Raise InputError for times (s) that decrease or are no numbers, or span too many half-cycles."""
    row = disorder(read_only(t))
    if row >= 0:
        raise InputError(f"free decay: t, row {row + 1}", f"{t[row]:.9g} s", "times that do not decrease")
    if t.size:
        check_span(decay, float(t[-1]))


def fill_uniform(decay: Decay, t0: float, dt: float, x: FloatArray, v: FloatArray, a: FloatArray) -> None:
    """Write x (m), v (m/s), a (m/s^2), each (n,), at the times t0 + j dt (s), dt > 0; nothing is allocated but tables.

    At an event a sample shows the acceleration after it. Before t = 0 the slider rests at x0.
    """
    finite("free decay: t0", t0)
    positive("free decay: dt", dt, "s")
    check_outputs((x.size,), x, v, a)
    check_span(decay, t0 + x.size * dt)
    _fill_uniform(*decay.arguments, t0, dt, x, v, a)


def fill_at(decay: Decay, t: FloatArray, x: FloatArray, v: FloatArray, a: FloatArray) -> None:
    """Write x, v, a, each (n,), at any times ``t`` (n,) in s that do not decrease; see ``fill_uniform``."""
    check_outputs((t.size,), t, x, v, a)
    check_times(decay, t)
    _fill_at(*decay.arguments, read_only(t), x, v, a)


def free_decay(start: Decay | Scenario, t: FloatArray) -> Trajectory:
    """The exact motion at increasing times ``t`` (s), with contact mode and every event up to the last of them.

    Raises InputError for times that do not increase or a scenario that is no free decay.
    """
    decay = Decay.of_scenario(start) if isinstance(start, Scenario) else start
    times = vector("free decay: t", t)
    increasing("free decay: t", times)
    x, v, a = np.empty_like(times), np.empty_like(times), np.empty_like(times)
    fill_at(decay, times, x, v, a)
    plan = schedule(decay, max(float(times[-1]), 0.0))
    return Trajectory(times, x, v, a, Source("reference", "exact"), mode=plan.mode(times), events=plan.events)


MOST_PERIODS = 200.0
"""Nothing that is worth watching lasts longer."""


def until_rest(decay: Decay) -> float:
    """A fifth longer than a free decay takes to stick, ten periods where that never comes, s; two digits."""
    period = 2.0 * math.pi / decay.omega_n
    if never_sticks(decay):
        return rounded_up(10.0 * period)
    time = schedule(decay, MOST_PERIODS * period).stick_time
    return rounded_up(MOST_PERIODS * period if time is None else 1.2 * time or period)


def rounded_up(value: float) -> float:
    """A positive number with two digits, not below ``value``."""
    exponent = math.floor(math.log10(value)) - 1
    return float(f"{math.ceil(value / 10.0**exponent)}e{exponent}")


def creep(slider: Slider, hold: Hold) -> float:
    """Speed in m/s at which the load moves the slider: exactly 0.

    Raises InputError when the load exceeds the break-away force f_s, and the slider does not hold.
    """
    if abs(hold.force) > slider.break_away:
        accepted = f"a load of at most f_s = {slider.break_away:g} N"
        raise InputError("hold: force", f"{hold.force:g} N", accepted)
    return 0.0
