"""The equations of a plant, and their integration by SciPy's solvers from event to event.

Between reversals, kinks and knocks the motion is smooth; each such piece is one run of the solver, ended at the root
of a switching function on its dense output. While stuck, the slider is a constraint (v = 0) and only branches move.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.integrate import DOP853, LSODA, Radau
from scipy.optimize import brentq

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.errors import InputError, SimulationError
from harness.proof.plant.model import PlantModel

State = Any
"""(x, v, bristle, branches..., work against friction) as a list or an array: plain lists are several times faster
where one number at a time is read."""
Switch = Callable[[float, State], float]

SOLVERS = {"DOP853": DOP853, "Radau": Radau, "LSODA": LSODA}
MOST_PIECES = 20_000
LOOKS = (0.25, 0.5, 0.75, 1.0)
"""Fractions of a step at which the switching functions are looked at, lest two roots in a step cancel."""


@dataclass(frozen=True, slots=True)
class PlantRun:
    """The true motion; every array has shape (n,).

    t : s. x : m. v : m/s. a : m/s^2. u : drive, N. friction : dry friction force, N (0 while stuck).
    stuck : held by dry friction. reversals : times of v = 0, s.
    states : branch states, shape (n, states), the work against friction last.
    """

    t: FloatArray
    x: FloatArray
    v: FloatArray
    a: FloatArray
    u: FloatArray
    friction: FloatArray
    stuck: BoolArray
    states: FloatArray
    reversals: FloatArray = field(default_factory=lambda: np.empty(0))

    def at(self, index: IntArray) -> "PlantRun":
        """The same motion at some of its samples."""
        sampled = ("t", "x", "v", "a", "u", "friction", "stuck", "states")
        return replace(self, **{name: getattr(self, name)[index] for name in sampled})


class Machine:
    """The equations of one plant over its state; ``d`` is the direction of sliding, 0 while stuck."""

    def __init__(self, model: PlantModel) -> None:
        self.model = model
        self.bristle = model.friction.states
        self.sticks = model.friction.sticks
        at = 2 + self.bristle
        start = [model.x0, model.v0] + [0.0] * self.bristle
        self.branches = []
        for branch in model.branches:
            own = list(branch.start(model.x0, model.v0))
            self.branches.append((at, at + len(own), branch))
            start += own
            at += len(own)
        self.start = np.array([*start, 0.0])
        restore: dict[str, Callable[[float], float]] = {
            "spring": lambda x: model.k * x,
            "pendulum": lambda x: model.k * math.sin(x),
            "none": lambda x: 0.0,
        }
        self.restore = restore[model.restoring]
        self.laws = tuple(force.law for force in model.forces)
        driven = model.drive.rate if model.drive else 0.0
        rates = [model.omega_n, driven, model.friction.rate / math.sqrt(model.m) if self.bristle else 0.0]
        rates += [force.rate for force in model.forces] + [branch.rate for branch in model.branches]
        fastest = max(rates)
        self.longest_step = 0.6 / fastest if fastest > 0.0 else math.inf
        speed = model.scale * max(model.omega_n, driven, 1e-3)
        self.units = np.full(at + 1, model.scale)
        self.units[1] = speed
        for lo, hi, _ in self.branches:
            if hi - lo == 2:
                self.units[lo + 1] = speed
        self.units[-1] = max(model.friction.level.f_k, 1e-300) * model.scale

    def net(self, t: float, s: State, d: float) -> float:
        """All forces but dry friction, N, on the right."""
        model = self.model
        x: float = s[0]
        v: float = s[1]
        total = -model.c * v - self.restore(x)
        for law in self.laws:
            total -= law(t, x, v, d)
        for lo, hi, branch in self.branches:
            total -= branch.force(x, v, s[lo:hi])
        if model.drive is not None:
            total += model.drive.law(t, x, v)
        return total

    def motion(self, t: float, s: State, d: float) -> tuple[float, float, float]:
        """Acceleration, friction force and the bristle's rate while sliding."""
        friction = self.model.friction
        net = self.net(t, s, d)
        level = friction.level.sliding(t, s[0], s[1], net, s[-1])
        force, z_rate = friction.act(level, s[1], d, net / self.model.m, s[2])
        return (net - force) / self.model.m, force, z_rate

    def rates(self, t: float, s: State, d: float) -> list[float]:
        """Time derivatives of the state; while stuck only the branches move."""
        if d == 0.0:
            v, force, out = 0.0, 0.0, [0.0] * (2 + self.bristle)
        else:
            v = s[1]
            a, force, z_rate = self.motion(t, s, d)
            out = [v, a, z_rate] if self.bristle else [v, a]
        for lo, hi, branch in self.branches:
            out += branch.derivative(s[0], v, s[lo:hi])
        out.append(force * v)
        return out

    def spare(self, t: float, s: State) -> float:
        """What the break-away level has left while stuck, N."""
        net = self.net(t, s, 0.0)
        return self.model.friction.level.break_away(t, s[0], net, s[-1]) - abs(net)

    def direction(self, t: float, s: State) -> float:
        """Direction of sliding from here on; 0 to stick."""
        if s[1] != 0.0:
            return math.copysign(1.0, s[1])
        if not self.sticks:
            # nothing holds it: at rest in balance it is off on either side with the first push
            return math.copysign(1.0, self.motion(t, s, 0.0)[0])
        net = self.net(t, s, 0.0)
        if abs(net) <= self.model.friction.level.break_away(t, s[0], net, s[-1]):
            return 0.0
        return math.copysign(1.0, net)

    def kinks(self, d: float) -> list[tuple[Switch, float]]:
        """Functions whose sign change ends a smooth piece, each with the size its values have."""
        length, speed = self.units[0], self.units[1]
        switches: list[tuple[Switch, float]] = []

        def at(place: float) -> Switch:
            return lambda t, s: float(s[0] - place)

        def of(switch: Callable[[float, float, State], float], lo: int, hi: int) -> Switch:
            return lambda t, s: switch(s[0], s[1], s[lo:hi])

        if d != 0.0:
            places = {place for force in self.model.forces for place in force.kinks} | set(self.model.kinks)
            switches += [(at(place), length) for place in sorted(places)]
            saturates, m = self.model.friction.switch, self.model.m
            if saturates is not None:
                switches.append((lambda t, s: saturates(s[1], self.net(t, s, d) / m), speed))
        return switches + [(of(one, lo, hi), length) for lo, hi, branch in self.branches for one in branch.switches]


class _Piece:
    """One smooth piece: the direction of sliding in it (0 while stuck), and the switching functions that end it."""

    def __init__(self, machine: Machine, now: float, y: FloatArray) -> None:
        first: list[float] = y.tolist()
        self.direction = d = machine.direction(now, first)
        self.resting = d == 0.0
        self.rhs = lambda t, s: np.array(machine.rates(t, s.tolist(), d))
        self.falls: list[Switch] = [machine.spare] if self.resting else [lambda _t, s: float(s[1] * d)]
        kinks = machine.kinks(d)
        self.switches = self.falls + [switch for switch, _ in kinks]
        self.past = [1.0 if self.resting else float(y[1] != 0.0)]
        for switch, size in kinks:
            value = switch(now, first)
            # one that has just fired stands at zero to rounding: its sign is read at the next look
            self.past.append(float(np.sign(value)) if abs(value) > 1e-11 * size else 0.0)

    def first_root(self, dense: Callable[[float], State], lo: float, hi: float) -> tuple[float, bool] | None:
        """Earliest end of the piece within a step, and whether it is the fall to zero (of speed or of hold)."""
        before = lo
        for fraction in LOOKS:
            now = lo + fraction * (hi - lo)
            s = dense(now)
            best: tuple[float, bool] | None = None
            signs = []
            for i, switch in enumerate(self.switches):
                value, is_fall = switch(now, s), i < len(self.falls)
                signs.append(float(np.sign(value)))
                turned = is_fall and not self.resting and self.past[i] == 0.0 and value < 0.0
                if turned or (self.past[i] * signs[-1] < 0.0 and (self.past[i] > 0.0 or not is_fall)):
                    risen = _risen(switch, dense, before, now) if turned else before
                    root = _root(switch, dense, risen, now, value)
                    if best is None or root < best[0]:
                        best = (root, is_fall)
            if best is not None:
                return best
            self.past = [new or old for new, old in zip(signs, self.past, strict=True)]
            before = now
        return None


def _risen(switch: Switch, dense: Callable[[float], State], lo: float, hi: float) -> float:
    """Where a speed that began at zero and has turned by ``hi`` was still on its first side, or next to ``lo``."""
    share = 0.5
    while share > 1e-12 and switch(lo + share * (hi - lo), dense(lo + share * (hi - lo))) <= 0.0:
        share *= 0.5
    return lo + share * (hi - lo)


def _root(switch: Switch, dense: Callable[[float], State], lo: float, hi: float, at_hi: float) -> float:
    # signs, since the product of what is tiny may be none
    if math.copysign(1.0, switch(lo, dense(lo))) == math.copysign(1.0, at_hi):
        return lo
    return float(brentq(lambda t: switch(t, dense(t)), lo, hi, xtol=1e-15, rtol=1e-14))


class _Tape:
    """The samples as they come."""

    def __init__(self, machine: Machine, t: FloatArray) -> None:
        self.machine, self.t, self.done = machine, t, 0
        self.states = np.zeros((t.size, machine.start.size))
        self.a, self.friction = np.zeros(t.size), np.zeros(t.size)
        self.stuck = np.zeros(t.size, dtype=bool)

    def fill(self, reached: float, dense: Callable[[FloatArray], State], piece: _Piece) -> None:
        """Take all samples up to ``reached`` from the solver's dense output."""
        until = int(np.searchsorted(self.t, reached, side="right"))
        if until <= self.done:
            return
        span = slice(self.done, until)
        self.states[span] = dense(self.t[span]).T
        self.stuck[span] = piece.resting
        if not piece.resting:
            for i in range(self.done, until):
                self.a[i], self.friction[i], _ = self.machine.motion(
                    float(self.t[i]), self.states[i].tolist(), piece.direction
                )
        self.done = until

    def hold(self, until: float) -> None:
        """The slider is held at its start up to ``until``."""
        self.done = int(np.searchsorted(self.t, until, side="left"))
        self.states[: self.done] = self.machine.start
        self.states[: self.done, 1] = 0.0


def simulate(
    model: PlantModel, t: FloatArray, *, tolerance: float = 1e-10, solver: str = "DOP853", pieces: int = MOST_PIECES
) -> PlantRun:
    """The true motion at the times t (s, shape (n,), increasing, t[0] the start of the recording).

    tolerance : relative tolerance of the solver. solver : "DOP853", "Radau" or "LSODA". pieces : most smooth pieces.
    Raises InputError for another solver, SimulationError when it gives up or the motion has no end of events.
    """
    if solver not in SOLVERS:
        raise InputError("plant: solver", solver, f"one of {', '.join(SOLVERS)}")
    t = np.asarray(t, dtype=np.float64)
    machine = Machine(model)
    tape, reversals = _Tape(machine, t), []
    now, end, y = float(t[0]), float(t[-1]), machine.start.copy()
    if model.release > now:
        tape.hold(model.release)
        now = model.release
    knocks = sorted((k for k in model.knocks if now < k.time <= end), key=lambda k: k.time)
    for _ in range(pieces):
        piece = _Piece(machine, now, y)
        stop = knocks[0].time if knocks else end
        now, y, root = _follow(machine, tape, piece, now, y, stop, tolerance, solver)
        if root is not None and root[1]:
            if piece.resting:
                # |net| equals the level to rounding: a speed far below every tolerance settles on which side it is
                y[1] = math.copysign(1e-13 * machine.units[1], machine.net(now, y.tolist(), 0.0))
            else:
                y[1] = 0.0
                reversals.append(now)
        elif root is None and knocks:
            y[1] += knocks.pop(0).impulse / model.m
        elif root is None:
            break
    else:
        raise SimulationError(f"plant: more than {pieces} events before {now:g} s")
    x, v = tape.states[:, 0], tape.states[:, 1]
    u = driven(model, t, x, v)
    return PlantRun(t, x, v, tape.a, u, tape.friction, tape.stuck, tape.states[:, 2:], np.array(reversals))


def driven(model: PlantModel, t: FloatArray, x: FloatArray, v: FloatArray) -> FloatArray:
    """The measured force along a motion, N, shape (n,); 0 where there is none."""
    if model.drive is None:
        return np.zeros(t.size)
    return np.array([model.drive.law(*at) for at in zip(t.tolist(), x.tolist(), v.tolist(), strict=True)])


def _follow(
    machine: Machine, tape: _Tape, piece: _Piece, now: float, y: FloatArray, stop: float, tolerance: float, solver: str
) -> tuple[float, FloatArray, tuple[float, bool] | None]:
    """Run one piece to its end or to ``stop``: time and state there, and the root that ended it."""
    if now >= stop:
        return now, y, None
    stepper = SOLVERS[solver](
        piece.rhs, now, y, stop, rtol=tolerance, atol=0.01 * tolerance * machine.units, max_step=machine.longest_step
    )
    root: tuple[float, bool] | None = None
    while stepper.status == "running" and root is None:
        message = stepper.step()
        if stepper.status == "failed":
            raise SimulationError(f"plant: the solver stopped at {now:g} s: {message}")
        dense = stepper.dense_output()
        root = piece.first_root(dense, stepper.t_old, stepper.t)
        now = stepper.t if root is None else root[0]
        tape.fill(now, dense, piece)
    y = np.array(dense(now))
    if piece.resting:
        y[1] = 0.0
    return now, y, root
