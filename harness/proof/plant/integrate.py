"""Integration by SciPy's solvers, from event to event.

Between reversals, kinks and knocks the motion is smooth; each such piece is one run of the solver, ended at the root
of a switching function on its dense output. While stuck, the slider is a constraint (v = 0) and only branches move.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.integrate import DOP853, LSODA, Radau
from scipy.optimize import brentq

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.errors import InputError, SimulationError
from harness.proof.plant.machine import Machine, State, Switch
from harness.proof.plant.model import PlantModel

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
        return replace(
            self,
            t=self.t[index],
            x=self.x[index],
            v=self.v[index],
            a=self.a[index],
            u=self.u[index],
            friction=self.friction[index],
            stuck=self.stuck[index],
            states=self.states[index],
        )


class _Piece:
    """One smooth piece: the direction of sliding in it (0 while stuck), and the switching functions that end it."""

    def __init__(self, machine: Machine, now: float, y: FloatArray) -> None:
        first: list[float] = y.tolist()
        self.direction = machine.direction(now, first)
        self.resting = self.direction == 0.0
        d = self.direction
        self.rhs = machine.hold() if self.resting else machine.slide(d)
        kinks = machine.kinks(d)
        self.falls: list[Switch] = []
        if not self.resting:
            self.falls = [lambda _t, s: float(s[1] * d)]
        elif machine.sticks:
            self.falls = [machine.spare]
        self.switches = self.falls + [switch for switch, _ in kinks]
        self.past = [1.0 if self.resting else float(y[1] != 0.0)] * len(self.falls)
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
        self.reversals: list[float] = []

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
        raise InputError("plant: solver", solver, f"one of {', '.join(SOLVERS)} is accepted")
    t = np.asarray(t, dtype=np.float64)
    machine = Machine(model)
    tape = _Tape(machine, t)
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
                tape.reversals.append(now)
        elif root is None and knocks:
            y[1] += knocks.pop(0).impulse / model.m
        elif root is None:
            break
    else:
        raise SimulationError(f"plant: more than {pieces} events before {now:g} s")
    x, v = tape.states[:, 0], tape.states[:, 1]
    u = np.zeros(t.size)
    if model.drive is not None:
        u = np.array([model.drive.law(*at) for at in zip(t.tolist(), x.tolist(), v.tolist(), strict=True)])
    return PlantRun(t, x, v, tape.a, u, tape.friction, tape.stuck, tape.states[:, 2:], np.array(tape.reversals))


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
