"""An engine with its settings as something that simulates models: what the diagnosis is handed.

A model of the five slots becomes a Task: base parameters natively, terms as force laws that call the kernel's own laws.
Smooth forces, internal states and friction without stick become ForceLaw.force; level curves and modulations of dry
friction become ForceLaw.level, so that sticking stays the engine's own; knocks become part of the drive. What a sensor
makes of the motion (slot O) is no business of an engine and is left to whoever compares channels.
"""

import math
from dataclasses import dataclass, field, replace
from typing import Final, final

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.jit import compiled
from harness.core.scenario import Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Trajectory
from harness.engines import registry
from harness.engines.base import Engine, Preset, Route, Settings, Task
from harness.engines.forces import Drive, ForceLaw
from harness.engines.joint_words import Kinds, elements, words_of
from harness.kernels.dispatch import bristle_law, internal, modulation, smooth, smoothed_law, speed_level
from harness.kernels.layout import (
    BRISTLE,
    COULOMB,
    FRICTION,
    FRICTION_AT,
    FRICTION_LAW,
    LEVEL,
    LEVEL_AT,
    LISTS,
    N_INTERNAL,
    N_MODULATION,
    N_SMOOTH,
    PENDULUM,
    REGULARISED,
    RESTORING,
    SPRING,
    Layout,
    lay_out,
)
from harness.kernels.solve import Drive as Measured
from harness.model.law import COLUMNS, D_FREE, D_INTERNAL, INTERNAL_COLUMNS, KINETIC, MASS, STIFFNESS, VALUE, VISCOUS
from harness.model.model import Model, ModelTerm
from harness.model.term import Slot


@final
@dataclass(frozen=True, slots=True)
class EngineSimulator:
    """Simulates models in one engine on one preset; ``settings`` are overrides of it."""

    engine: Engine
    preset: Preset = "tuned"
    settings: Settings = field(default_factory=dict)

    @classmethod
    def named(cls, name: str, preset: Preset = "tuned", settings: Settings | None = None) -> "EngineSimulator":
        """By the engine's name; raises InputError for an unknown one, SimulationError for one that is not installed."""
        return cls(registry.load(name), preset, settings or {})

    @property
    def name(self) -> str:
        return self.engine.name

    def __call__(self, model: Model, duration: float, dt: float | None, drive: Measured | None) -> Trajectory:
        """See harness.diagnosis.explain.engines.Simulator; dt None is the preset's own step.

        source.settings["terms"] says how each term was realised.
        """
        step = dt if dt is not None else float(self.engine.presets("joint", self.preset)["dt"])
        lines = None if drive is None else drive.straight
        force = None if lines is None else Drive(lines.t, lines.u)
        native = self._native(model)
        task = task_of(model, duration, step, preset=self.preset, settings=self.settings, drive=force, native=native)
        motion = self.engine.simulate(task)
        terms = {entry.term.key: _how(entry, model.k, native) for entry in model.terms}
        if not terms:
            return motion
        source = replace(motion.source, settings={**motion.source.settings, "terms": terms})
        return replace(motion, source=source)

    def _native(self, model: Model) -> Kinds:
        """Kinds of elements that are left to the engine's joint.

        A friction without a state may look at every other force, so that they all must be laws; a step that is implicit
        in position gives back accelerations that only a linear spring can be taken out of.
        """
        smoothed = any(not law.term.internal for law in model.in_slot(Slot.FRICTION_LAW))
        implicit = self.settings.get("integrator") == "discrete"
        return frozenset() if smoothed or implicit else self.engine.native


def _how(entry: ModelTerm, k: float, native: Kinds) -> str:
    """How an engine was told of a term."""
    if elements(entry, k, native):
        return "attribute of the joint"
    match entry.term.slot:
        case Slot.OBSERVATION:
            return "none: what a sensor makes of the motion"
        case Slot.EVENT:
            return "knock in the driving force, two steps wide"
        case Slot.BREAK_AWAY | Slot.FRICTION_LEVEL | Slot.FRICTION_MODULATION:
            return "limit of the engine's own friction, set in every step"
        case _:
            return "force law, called at every stage of the step"


# params: length of spec, time of release, spec, theta. state: t, x, v of the start of the step, then the model's own
SPEC: Final = 2
STATE: Final = 3


def _level(t: float, x: float, v: float, state: FloatArray, params: FloatArray) -> float:
    """Level of dry friction, N: curve times modulations, never below 0."""
    theta = params[SPEC + int(params[0]) :]
    level, row = theta[KINETIC], np.zeros(COLUMNS)
    if int(params[SPEC + LEVEL_AT]) >= 0:
        speed_level(int(params[SPEC + LEVEL]), v, theta, int(params[SPEC + LEVEL_AT]), row)
        level = row[VALUE]
    at = SPEC + LISTS
    for _ in range(int(params[SPEC + N_MODULATION])):
        row[VALUE] = 0.0
        modulation(int(params[at]), x, v, t + params[1], theta, int(params[at + 1]), row)
        if row[VALUE] <= 0.0:
            return 0.0
        level *= row[VALUE]
        at += 3
    return max(float(level), 0.0)


level = compiled(_level)


def _bristle(z: float, dx: float, h: float, friction: float, params: FloatArray, rows: FloatArray) -> float:
    """Bristle after a displacement dx in the time h; its rate is linear in z, so that there is a closed form."""
    if dx == 0.0 or h <= 0.0 or friction <= 0.0:
        return z
    theta = params[SPEC + int(params[0]) :]
    number, o = int(params[SPEC + FRICTION_LAW]), int(params[SPEC + FRICTION_AT])
    bristle_law(number, dx / h, 1 if dx > 0.0 else -1, z, friction, theta, o, rows)
    rate, slope = float(rows[1, VALUE]), float(rows[1, D_INTERNAL])
    return z + rate * (math.expm1(slope * h) / slope if slope != 0.0 else h)


bristle = compiled(_bristle)


def _carried(
    number: int,
    o: int,
    w: tuple[float, float],
    before: tuple[float, float, float],
    now: tuple[float, float, float],
    theta: FloatArray,
) -> tuple[float, float]:
    """Internal states w carried from (t, x, v) to (t, x, v): Runge-Kutta along the cubic through both."""
    rows = np.zeros((3, INTERNAL_COLUMNS))
    h = now[0] - before[0]
    w0, w1 = w
    if h <= 0.0:
        return w0, w1
    d0, d1, dx = h * before[2], h * now[2], now[1] - before[1]
    for half in range(2):
        k0, k1, sum0, sum1 = 0.0, 0.0, 0.0, 0.0
        for stage in range(4):
            reach = (0.0, 0.25, 0.25, 0.5)[stage]
            s = 0.5 * half + reach
            curve = s * s * (3.0 - 2.0 * s)
            x = before[1] + d0 * s * (1.0 - s) ** 2 + dx * curve - d1 * s * s * (1.0 - s)
            v = (d0 * (1.0 - s) * (1.0 - 3.0 * s) + 6.0 * dx * s * (1.0 - s) + d1 * s * (3.0 * s - 2.0)) / h
            internal(number, x, v, w0 + reach * h * k0, w1 + reach * h * k1, theta, o, rows)
            k0, k1 = rows[1, VALUE], rows[2, VALUE]
            weight = (1.0, 2.0, 2.0, 1.0)[stage] / 12.0
            sum0 += weight * k0
            sum1 += weight * k1
        w0 += h * sum0
        w1 += h * sum1
    return w0, w1


carried = compiled(_carried)


def _advance(t: float, x: float, v: float, dt: float, state: FloatArray, params: FloatArray) -> None:
    """Move bristle and internal states from the start of the last step to here."""
    theta = params[SPEC + int(params[0]) :]
    before, now = (state[0], state[1], state[2]), (t, x, v)
    if int(params[SPEC + FRICTION]) == BRISTLE:
        rows = np.zeros((3, INTERNAL_COLUMNS))
        state[STATE] = bristle(state[STATE], x - state[1], t - state[0], level(t, x, v, state, params), params, rows)
    at = SPEC + LISTS + 3 * int(params[SPEC + N_MODULATION]) + 3 * int(params[SPEC + N_SMOOTH])
    for _ in range(int(params[SPEC + N_INTERNAL])):
        i, two = int(params[at + 3]) + STATE - 2, int(params[at + 4]) > 1
        w = (state[i], state[i + 1] if two else 0.0)
        w = carried(int(params[at]), int(params[at + 1]), w, before, now, theta)
        state[i] = w[0]
        if two:
            state[i + 1] = w[1]
        at += 5
    state[0], state[1], state[2] = t, x, v


advance = compiled(_advance)


def _smooth_and_internal(t: float, x: float, v: float, state: FloatArray, params: FloatArray) -> float:
    """Smooth forces and those of internal states, on the right-hand side."""
    theta = params[SPEC + int(params[0]) :]
    total = 0.0
    at = SPEC + LISTS + 3 * int(params[SPEC + N_MODULATION])
    row = np.zeros(COLUMNS)
    for _ in range(int(params[SPEC + N_SMOOTH])):
        row[VALUE] = 0.0
        smooth(int(params[at]), x, v, t + params[1], theta, int(params[at + 1]), row)
        total -= row[VALUE]
        at += 3
    before, now = (state[0], state[1], state[2]), (t, x, v)
    rows = np.zeros((3, INTERNAL_COLUMNS))
    for _ in range(int(params[SPEC + N_INTERNAL])):
        number, o, i = int(params[at]), int(params[at + 1]), int(params[at + 3]) + STATE - 2
        w = (state[i], state[i + 1] if int(params[at + 4]) > 1 else 0.0)
        w = carried(number, o, w, before, now, theta)
        internal(number, x, v, w[0], w[1], theta, o, rows)
        total -= rows[0, VALUE]
        at += 5
    return total


smooth_and_internal = compiled(_smooth_and_internal)


def _force(t: float, x: float, v: float, state: FloatArray, params: FloatArray) -> float:
    """Every term that is a force, friction without stick among them, on the right-hand side."""
    theta = params[SPEC + int(params[0]) :]
    total = smooth_and_internal(t, x, v, state, params)
    kind, o = int(params[SPEC + FRICTION]), int(params[SPEC + FRICTION_AT])
    number, f_k = int(params[SPEC + FRICTION_LAW]), level(t, x, v, state, params)
    if kind == BRISTLE and f_k > 0.0:
        rows = np.zeros((3, INTERNAL_COLUMNS))
        z = bristle(state[STATE], x - state[1], t - state[0], f_k, params, rows)
        bristle_law(number, v, 1 if v >= 0.0 else -1, z, f_k, theta, o, rows)
        total -= rows[0, VALUE]
    elif kind == REGULARISED:
        others = total - theta[VISCOUS] * v
        if int(params[SPEC + RESTORING]) == SPRING:
            others -= theta[STIFFNESS] * x
        elif int(params[SPEC + RESTORING]) == PENDULUM:
            others -= theta[STIFFNESS] * math.sin(x)
        row = np.zeros(COLUMNS)
        smoothed_law(number, v, others / theta[MASS], f_k, theta, o, row)
        total -= row[VALUE]
    return total


force = compiled(_force)


def _looks_ahead(laid: Layout) -> bool:
    """Whether friction without a state hangs on the acceleration that other forces give."""
    row = np.zeros(COLUMNS)
    smoothed_law(int(laid.spec[FRICTION_LAW]), 0.0, 0.0, 1.0, laid.theta, int(laid.spec[FRICTION_AT]), row)
    return bool(row[D_FREE] != 0.0)


def task_of(
    model: Model,
    duration: float,
    dt: float,
    *,
    route: Route = "joint",
    preset: Preset = "tuned",
    settings: Settings | None = None,
    drive: Drive | None = None,
    native: Kinds = frozenset(),
) -> Task:
    """A Task that simulates ``model`` from its release on for ``duration`` s with step ``dt`` s.

    Time 0 of the run is the release, model.t0; ``drive`` is given in time of the run. native : kinds of elements that
    the engine's joint has words for; a term made of those becomes words and not a law. Raises SimulationError for what
    no engine can be told: friction with a lead under a driving force, and on the contact route friction without stick.
    """
    spoken = [entry for entry in model.terms if elements(entry, model.k, native)]
    words = words_of(spoken, model.k) if spoken else None
    model = replace(model, terms=tuple(entry for entry in model.terms if entry not in spoken))
    laid = lay_out(model, max(abs(model.v0), abs(model.x0) * math.sqrt(max(model.k, 1e-300) / model.m), 1e-9))
    kind = int(laid.spec[FRICTION])
    if kind != COULOMB and route != "joint":
        raise SimulationError(f"a model with friction without stick has no {route} route; there is joint")
    forced = drive is not None or bool(model.in_slot(Slot.EVENT))
    if kind == REGULARISED and forced and _looks_ahead(laid):
        name = model.in_slot(Slot.FRICTION_LAW)[0].term.key
        raise SimulationError(f"{name}: with a lead and a driving force there is no law to call")
    static = model.in_slot(Slot.BREAK_AWAY)
    f_s = static[0].values[0] if static else model.f_s
    f_k = model.f_k if kind == COULOMB else 0.0
    # the level curve ends at its own break-away force
    f_s = None if kind != COULOMB or model.in_slot(Slot.FRICTION_LEVEL) else f_s
    slider = Slider(model.m, model.c, model.k if model.restoring != "none" else 1.0, f_k, f_s)
    for knock in model.in_slot(Slot.EVENT):
        drive = (drive or Drive.none()).with_knock(knock.values[0] - model.t0, knock.values[1], dt)
    has_level = bool(model.in_slot(Slot.FRICTION_LEVEL, Slot.FRICTION_MODULATION)) and kind == COULOMB
    has_force = kind != COULOMB or bool(model.in_slot(Slot.SMOOTH, Slot.INTERNAL))
    moves = kind == BRISTLE or bool(model.in_slot(Slot.INTERNAL))
    law = None
    if has_level or has_force:
        law = ForceLaw(
            force if has_force else None,
            level if has_level else None,
            advance if moves else None,
            np.concatenate([[laid.spec.size, model.t0], laid.spec, laid.theta]),
            np.concatenate([[0.0, model.x0, model.v0], laid.start[2:]]),
        )
    scenario = Scenario("model", slider, model.x0, model.v0, duration)
    task = Task(scenario, route, preset, dt, settings or {}, law, drive)
    return replace(task, restoring=model.restoring.value, words=words)
