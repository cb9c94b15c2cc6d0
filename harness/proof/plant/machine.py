"""The equations of one plant over its state (x, v, bristle, branches..., work against friction)."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from harness.proof.plant.model import PlantModel

State = Any
"""A list or an array of floats: plain lists are several times faster where one number at a time is read."""

Switch = Callable[[float, State], float]


class Machine:
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
        model = self.model
        x: float = s[0]
        v: float = s[1]
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

    def rates(self, t: float, s: State, d: float) -> list[float]:
        """Time derivatives of the state while sliding in direction d."""
        a, force, z_rate = self.motion(t, s, d)
        out = [s[1], a]
        if self.bristle:
            out.append(z_rate)
        for (lo, hi), branch in zip(self.slots, self.model.branches, strict=True):
            out += branch.derivative(s[0], s[1], s[lo:hi])
        out.append(force * s[1])
        return out

    def held_rates(self, s: State) -> list[float]:
        """Time derivatives while stuck: only the branches move."""
        out = [0.0] * (2 + self.bristle)
        for (lo, hi), branch in zip(self.slots, self.model.branches, strict=True):
            out += branch.derivative(s[0], 0.0, s[lo:hi])
        out.append(0.0)
        return out

    def slide(self, d: float) -> Callable[[float, State], State]:
        """Right-hand side while sliding in direction d."""
        return lambda t, y: np.array(self.rates(t, y.tolist(), d))

    def hold(self) -> Callable[[float, State], State]:
        """Right-hand side while stuck."""
        return lambda t, y: np.array(self.held_rates(y.tolist()))

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
        # without a stick nothing holds it: at rest in balance it is off on either side with the first push
        return math.copysign(1.0, self.motion(t, s, 0.0)[0])

    def kinks(self, d: float) -> list[tuple[Switch, float]]:
        """Functions whose sign change ends a smooth piece, each with the size its values have."""
        length, speed = self.units[0], self.units[1]
        switches: list[tuple[Switch, float]] = []

        def at(place: float) -> Switch:
            return lambda t, s: float(s[0] - place)

        def of(switch: Callable[[float, float, State], float], lo: int, hi: int) -> Switch:
            return lambda t, s: switch(s[0], s[1], s[lo:hi])

        places = {place for force in self.model.forces for place in force.kinks} | set(self.model.kinks)
        if d != 0.0:
            switches += [(at(place), length) for place in sorted(places)]
            if not self.sticks and not self.bristle:
                friction, m = self.model.friction, self.model.m
                switches.append((lambda t, s: friction.switch(s[1], self.net(t, s, d) / m), speed))
        for (lo, hi), branch in zip(self.slots, self.model.branches, strict=True):
            switches += [(of(switch, lo, hi), length) for switch in branch.switches]
        return switches
