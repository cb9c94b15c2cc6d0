"""Integration by SciPy's solvers, from event to event.

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
from harness.core.errors import SimulationError
from harness.proof.plant.model import PlantModel

SOLVERS = {"DOP853": DOP853, "Radau": Radau, "LSODA": LSODA}
MOST_PIECES = 20_000
LOOKS = (0.25, 0.5, 0.75, 1.0)
"""Fractions of a step at which the switching functions are looked at, lest two roots in a step cancel."""

State = Any
Switch = Callable[[float, State], float]


@dataclass(frozen=True, slots=True)
class PlantRun:
    """The true motion; every array has shape (n,).

    t : s. x : m. v : m/s. a : m/s^2. u : drive, N. friction : dry friction force, N (0 while stuck). stuck : held by dry friction.
    reversals : times of v = 0, s. states : branch states, shape (n, states), the work against friction last.
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


class _Machine:
    """The equations of one plant over the state (x, v, bristle, branches..., work)."""

    def __init__(self, model: PlantModel) -> None:
        self.model = model
        self.bristle = model.friction.states
        self.slots: list[tuple[int, int]] = []
        at = 2 + self.bristle
        start = [model.x0, model.v0] + [0.0] * self.bristle
        for branch in model.branches:
            own = list(branch.start(model.x0, model.v0))
            self.slots.append((at, at + len(own)))
            start += own
            at += len(own)
        self.start = np.array([*start, 0.0])
        self.sticks = model.friction.sticks
        restore = {
            "spring": lambda x: model.k * x,
            "pendulum": lambda x: model.k * math.sin(x),
            "none": lambda x: 0.0,
        }
        self.restore: Callable[[float], float] = restore[model.restoring]
        self.laws = tuple(force.law for force in model.forces)
        rates = [model.omega_n, model.friction.rate / math.sqrt(model.m) if self.bristle else 0.0]
        rates += [force.rate for force in model.forces] + [branch.rate for branch in model.branches]
        rates += [model.drive.rate] if model.drive else []
        fastest = max(rates)
        self.longest_step = 0.6 / fastest if fastest > 0.0 else math.inf
        speed = model.scale * max(model.omega_n, model.drive.rate if model.drive else 0.0, 1e-3)
        self.units = np.full(at + 1, model.scale)
        self.units[1] = speed
        for (lo, hi), _ in zip(self.slots, model.branches, strict=True):
            if hi - lo == 2:
                self.units[lo + 1] = speed
        self.units[-1] = max(model.friction.level.f_k, 1e-300) * model.scale

    def net(self, t: float, s: State, d: float) -> float:
        """All forces but dry friction, N, on the right."""
        model, x, v = self.model, s[0], s[1]
        total = -model.c * v - self.restore(x)
        for law in self.laws:
            total -= law(t, x, v, d)
        for (lo, hi), branch in zip(self.slots, model.branches, strict=True):
            total -= branch.force(x, v, s[lo:hi])
        if model.drive is not None:
            total += model.drive.law(t, x, v)
        return total

    def motion(self, t: float, s: State, d: float) -> tuple[float, float, float]:
        """Acceleration, friction force and the bristle's rate while sliding in direction d."""
        friction = self.model.friction
        net = self.net(t, s, d)
        level = friction.level.sliding(t, s[0], s[1], net, s[-1])
        force, z_rate = friction.act(level, s[1], d, net / self.model.m, s[2])
        return (net - force) / self.model.m, force, z_rate

    def slide(self, d: float) -> Callable[[float, State], State]:
        """Right-hand side while sliding in direction d."""

        def rhs(t: float, y: State) -> State:
            s = y.tolist()
            a, force, z_rate = self.motion(t, s, d)
            out = [s[1], a]
            if self.bristle:
                out.append(z_rate)
            for (lo, hi), branch in zip(self.slots, self.model.branches, strict=True):
                out += branch.derivative(s[0], s[1], s[lo:hi])
            out.append(force * s[1])
            return np.array(out)

        return rhs

    def hold(self) -> Callable[[float, State], State]:
        """Right-hand side while stuck: only the branches move."""

        def rhs(t: float, y: State) -> State:
            s = y.tolist()
            out = [0.0, 0.0]
            for (lo, hi), branch in zip(self.slots, self.model.branches, strict=True):
                out += branch.derivative(s[0], 0.0, s[lo:hi])
            out.append(0.0)
            return np.array(out)

        return rhs

    def spare(self, t: float, s: State) -> float:
        """What the break-away level has left while stuck, N."""
        net = self.net(t, s, 0.0)
        return self.model.friction.level.break_away(t, s[0], net, s[-1]) - abs(net)

    def direction(self, t: float, s: State) -> float:
        """Direction of sliding from here on; 0 to stick."""
        if s[1] != 0.0:
            return math.copysign(1.0, s[1])
        net = self.net(t, s, 0.0)
        if self.sticks:
            if abs(net) <= self.model.friction.level.break_away(t, s[0], net, s[-1]):
                return 0.0
            return math.copysign(1.0, net)
        acceleration = self.motion(t, s, 0.0)[0]
        return math.copysign(1.0, acceleration) if acceleration != 0.0 else 0.0

    def kinks(self, d: float) -> list[tuple[Switch, float]]:
        """Functions whose sign change ends a smooth piece, each with the size its values have."""
        length, speed = self.units[0], self.units[1]
        switches: list[tuple[Switch, float]] = []
        places = {p for force in self.model.forces for p in force.kinks} | set(self.model.kinks)
        if d != 0.0:
            switches += [(lambda t, s, p=p: s[0] - p, length) for p in sorted(places)]
            if not self.sticks and not self.bristle:
                friction, m = self.model.friction, self.model.m
                switches.append((lambda t, s: friction.switch(s[1], self.net(t, s, d) / m), speed))
        for (lo, hi), branch in zip(self.slots, self.model.branches, strict=True):
            switches += [(lambda t, s, f=f, lo=lo, hi=hi: f(s[0], s[1], s[lo:hi]), length) for f in branch.switches]
        return switches


def _first_root(
    dense: Callable[[float], State], lo: float, hi: float, falls: list[Switch], kinks: list[Switch], past: list[float]
) -> tuple[float, int] | None:
    """Earliest root within a step and the index of its switch; ``past`` holds the last sign seen of each and is updated."""
    before = lo
    for fraction in LOOKS:
        now = lo + fraction * (hi - lo)
        s = dense(now)
        best: tuple[float, int] | None = None
        signs = []
        for i, switch in enumerate(falls + kinks):
            value = switch(now, s)
            sign = float(np.sign(value))
            signs.append(sign)
            crossed = past[i] * sign < 0.0 and (i >= len(falls) or past[i] > 0.0)
            if crossed:
                at_start = switch(before, dense(before))
                root = (
                    before
                    if at_start * value >= 0.0
                    else brentq(lambda t, f=switch: f(t, dense(t)), before, now, xtol=1e-15, rtol=1e-14)
                )
                if best is None or root < best[0]:
                    best = (root, i)
        if best is not None:
            return best
        for i, sign in enumerate(signs):
            past[i] = sign or past[i]
        before = now
    return None


def simulate(model: PlantModel, t: FloatArray, *, tolerance: float = 1e-10, solver: str = "DOP853") -> PlantRun:
    """The true motion at the times t (s, shape (n,), increasing, t[0] the start of the recording).

    tolerance : relative tolerance of the solver. solver : "DOP853", "Radau" or "LSODA".
    Raises SimulationError when the solver gives up or the motion has no end of events.
    """
    t = np.asarray(t, dtype=np.float64)
    machine = _Machine(model)
    n = t.size
    out = np.zeros((n, machine.start.size))
    a, friction, stuck, reversals = np.zeros(n), np.zeros(n), np.zeros(n, dtype=bool), []
    held = int(np.searchsorted(t, model.release, side="left")) if model.release > t[0] else 0
    out[:held] = machine.start
    out[:held, 1] = 0.0
    done, now, end, y = held, max(model.release, float(t[0])), float(t[-1]), machine.start.copy()
    knocks = sorted((k for k in model.knocks if now < k.time <= end), key=lambda k: k.time)
    for _ in range(MOST_PIECES):
        d = machine.direction(now, y.tolist())
        resting = d == 0.0
        rhs = machine.hold() if resting else machine.slide(d)
        falls: list[Switch] = [machine.spare] if resting and machine.sticks else []
        if not resting:
            falls = [lambda _t, s, d=d: s[1] * d]
        first, kinks = y.tolist(), machine.kinks(d)
        past = [1.0 if resting else float(y[1] != 0.0)] * len(falls)
        # a switch that has just fired stands at zero to rounding: its sign is read at the next look
        past += [float(np.sign(f(now, first))) if abs(f(now, first)) > 1e-11 * size else 0.0 for f, size in kinks]
        stop = knocks[0].time if knocks else end
        root: tuple[float, int] | None = None
        if now < stop:
            stepper = SOLVERS[solver](
                rhs, now, y, stop, rtol=tolerance, atol=tolerance * 0.01 * machine.units, max_step=machine.longest_step
            )
            while stepper.status == "running" and root is None:
                message = stepper.step()
                if stepper.status == "failed":
                    raise SimulationError(f"plant: the solver stopped at {now:g} s: {message}")
                dense = stepper.dense_output()
                root = _first_root(dense, stepper.t_old, stepper.t, falls, [f for f, _ in kinks], past)
                reached = stepper.t if root is None else root[0]
                until = int(np.searchsorted(t, reached, side="right"))
                if until > done:
                    out[done:until] = dense(t[done:until]).T
                    stuck[done:until] = resting
                    if not resting:
                        for i in range(done, until):
                            a[i], friction[i], _ = machine.motion(float(t[i]), out[i].tolist(), d)
                    done = until
            now, y = reached, dense(reached).copy()
        if resting:
            y[1] = 0.0
        if root is not None and not resting and root[1] == 0:
            y[1] = 0.0
            reversals.append(now)
        if root is not None and resting and falls and root[1] == 0:
            y = _break_away(machine, now, y)
        if root is None and knocks and now >= knocks[0].time:
            y[1] += knocks.pop(0).impulse / model.m
        elif root is None:
            break
    else:
        raise SimulationError(f"plant: more than {MOST_PIECES} events before {now:g} s")
    out[done:] = y
    u = np.zeros(n)
    if model.drive is not None:
        u = np.array([model.drive.law(float(t[i]), out[i, 0], out[i, 1]) for i in range(n)])
    return PlantRun(t, out[:, 0], out[:, 1], a, u, friction, stuck, out[:, 2:], np.array(reversals))


def _break_away(machine: _Machine, now: float, y: State) -> State:
    """Set the slider going in the direction of the net force, which equals the break-away level here."""
    # |net| = f_s at the root only to rounding: a speed far below every tolerance settles which side it is on
    y = y.copy()
    y[1] = math.copysign(1e-13 * machine.units[1], machine.net(now, y.tolist(), 0.0))
    return y
