"""Simulate a model: the Python side of the compiled integrator."""

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from harness.core.arrays import FloatArray, IntArray, ModeArray
from harness.core.errors import SimulationError
from harness.core.events import Events
from harness.core.trajectory import Source, Trajectory
from harness.kernels.integrate import DIVERGED, DONE, EVENT_COLUMNS, TOO_MANY_EVENTS, integrate
from harness.kernels.layout import Layout, lay_out
from harness.model.model import Model, Restoring

TOLERANCE = 1e-9
"""Default error per step relative to the scale of the motion."""

_NO_DRIVE: FloatArray = np.empty(0)


By: TypeAlias = str | tuple[int, int]
"""A parameter to differentiate by: a name, or (index of a term in the model, index of its parameter)."""


@dataclass(frozen=True, slots=True)
class Drive:
    """A measured force: knots t (s, increasing) and values u (N, per unit mass when the mass is unknown), linear between."""

    t: FloatArray
    u: FloatArray


@dataclass(frozen=True, slots=True)
class Scales:
    """What counts as ordinary in a motion: displacement (m), speed (m/s), and an angular frequency (rad/s)."""

    x: float
    v: float
    omega: float

    @classmethod
    def of(cls, model: Model, drive: Drive | None = None) -> "Scales":
        """From the model itself: its release, its frequency, the drive."""
        omega = math.sqrt(model.k / model.m) if model.restoring is not Restoring.NONE else 0.0
        push = float(np.max(np.abs(drive.u))) / model.m if drive is not None else 0.0
        if omega == 0.0:
            # without a spring: the time in which viscous damping stops it, at least the recording's own scale
            span = float(drive.t[-1] - drive.t[0]) if drive is not None else 1.0
            omega = max(model.c / model.m, 6.0 / span)
        x = max(abs(model.x0), abs(model.v0) / omega, push / omega**2, 1e-12)
        return cls(x, max(abs(model.v0), x * omega), omega)


@dataclass(frozen=True, slots=True)
class Effort:
    """How hard to try: error per step relative to the scales, and the most steps a cycle of the motion may take."""

    tolerance: float = TOLERANCE
    steps_per_cycle: int = 4000


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
        elif name == "x0":
            start[0, q] = 1.0
        elif name == "v0":
            start[1, q] = 1.0
        elif name in layout.state_names[2:]:
            start[layout.state_names.index(name), q] = 1.0
        else:
            columns[q] = layout.names.index(name)
    return columns, start


def solve(
    model: Model,
    t: FloatArray,
    by: tuple[By, ...] = (),
    drive: Drive | None = None,
    scales: Scales | None = None,
    effort: Effort = Effort(),  # noqa: B008  (frozen)
    want_a: bool = True,
    shortest_cycle: float = 24.0,
) -> Solution:
    """Simulate a model at the times t (s, increasing; those before its release show it held there).

    by : parameters to differentiate by ("c", "x0", "cubic-stiffness.k3", "viscoelastic.w0"). drive : force, or None.
    effort : accuracy and patience. shortest_cycle : least steps a cycle is given. Raises SimulationError when the motion cannot be followed.
    """
    scales = scales or Scales.of(model, drive)
    layout = lay_out(model, scales.v)
    columns, start = _columns(layout, by)
    # a second mass starts at rest relative to the slider
    for q, name in enumerate(by):
        if name == "v0" and "attached-mode.w1" in layout.state_names:
            start[layout.state_names.index("attached-mode.w1"), q] = 1.0
    z0 = layout.start.copy()
    if "attached-mode.w1" in layout.state_names:
        z0[layout.state_names.index("attached-mode.w1")] += model.v0
    error = np.full(z0.size, effort.tolerance * scales.x)
    error[1] = effort.tolerance * scales.v
    for i, name in enumerate(layout.state_names):
        if name == "attached-mode.w1":
            error[i] = effort.tolerance * scales.v
    bristle = model.find("presliding")
    if bristle is not None:
        # the bristle's own scale is the presliding displacement, far below that of the motion
        error[2] *= min(1.0, max(1e-3, model.f_k / (bristle.value("sigma0") * scales.x + 1e-300)))
    n, q_count = t.size, len(by)
    x, v, a = np.empty(n), np.empty(n), np.zeros(n)
    mode = np.empty(n, dtype=np.int8)
    dx, dv = np.zeros((n, q_count)), np.zeros((n, q_count))
    da = np.zeros((n, q_count))
    span = max(float(t[-1]) - model.t0, 0.0)
    cycles = span * scales.omega / math.pi + 1.0
    events = np.zeros((64 + int(4 * cycles), EVENT_COLUMNS))
    u_t, u_y = (drive.t, drive.u) if drive is not None else (_NO_DRIVE, _NO_DRIVE)
    h_max = 2.0 * math.pi / scales.omega / shortest_cycle
    limit = int(effort.steps_per_cycle * (cycles + 2.0)) + 20 * u_t.size
    while True:
        status, n_events, steps, reached = integrate(
            model.t0, z0, start, layout.spec, layout.theta, columns, u_t, u_y, t, error, h_max, limit, want_a,
            x, v, a, mode, dx, dv, da, events,
        )  # fmt: skip
        if status != TOO_MANY_EVENTS or events.shape[0] > 1_000_000:
            break
        events = np.zeros((4 * events.shape[0], EVENT_COLUMNS))
    if status != DONE:
        why = "it diverged" if status == DIVERGED else f"it took more than {limit} steps"
        raise SimulationError(f"the model could not be followed beyond t = {reached:.6g} s: {why}")
    kept = events[:n_events]
    log = Events(kept[:, 0], kept[:, 1].astype(np.int64), kept[:, 2], kept[:, 3], kept[:, 4])
    return Solution(x, v, a, mode, dx, dv, da, by, log, steps)


def simulate(model: Model, t: FloatArray, drive: Drive | None = None, tolerance: float = 1e-11) -> Trajectory:
    """A model's motion as a Trajectory of the reference, at the times t (s)."""
    s = solve(model, t, drive=drive, effort=Effort(tolerance))
    u = np.interp(t, drive.t, drive.u) if drive is not None else None
    source = Source("reference", "exact", settings={"tolerance": tolerance})
    return Trajectory(t, s.x, s.v, s.a, source, u=u, mode=s.mode, events=s.events)
