"""What the estimators read from one of two traces, and the figures in which the two differ."""

import math
from collections.abc import Mapping

import numpy as np

from harness.app.shared.estimates import estimate
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.core.recording import Recording
from harness.diagnosis.alignment.pair import Clock
from harness.estimate.every import METHODS
from harness.estimate.noise import Noise
from harness.estimate.result import Estimate, Estimation
from harness.results.common import P
from harness.results.compare import Difference, Event, Reading

FIGURES = ("omega_n", "zeta", "x_k", "amplitude", "rest")
UNITS = {"x": "m", "v": "m/s", "a": "m/s^2"}
ANGULAR = {"x": "rad", "v": "rad/s", "a": "rad/s^2"}
_STILL = 0.1
"""Share of a half-cycle that must follow the stop, for a rest to be seen."""


def reading(trace: Recording, noise: Mapping[str, Noise], clock: Clock) -> Reading:
    """Figures and events of one trace. noise : by channel. clock : its clock in that of the second trace.

    A trace that is driven, or shows no free decay, has figures refused with the reason.
    """
    unit = (ANGULAR if trace.angular else UNITS)["x"]
    method, found, edges = None, None, np.empty(0)
    try:
        every = estimate(trace)
    except InputError as error:
        found = Estimate.refused(error.found.removeprefix("no estimate is possible: "), unit)
    else:
        method, found = _best(every)
        edges = every.edges
    x_scale = 1.0 / clock.scale
    return Reading(
        method=method,
        omega_n=P.of(_scaled(found.omega_n, x_scale)),
        zeta=P.of(found.zeta),
        x_k=P.of(found.x_k),
        amplitude=P.of(_amplitude(trace, noise)),
        rest=P.of(_rest(trace, noise, edges)),
        events=_events(trace, edges, clock),
    )


def _best(every: Estimation) -> tuple[str | None, Estimate]:
    """The first method that gives all three figures; else the one that gives most."""

    def known(name: str) -> int:
        one = every[name]
        return sum(p.value is not None for p in (one.omega_n, one.zeta, one.x_k))

    name = max(METHODS, key=known)
    return (name if known(name) else None), every[name]


def _scaled(one: Quantity, by: float) -> Quantity:
    """A frequency by the second trace's clock."""
    if one.value is None or by == 1.0:
        return one
    return Quantity(one.value * by, None if one.stderr is None else one.stderr * by, one.unit, one.why)


def _amplitude(trace: Recording, noise: Mapping[str, Noise]) -> Quantity:
    """Half of the range of the first channel of x, v, a."""
    c = next(c for c in UNITS if c in trace)
    unit = (ANGULAR if trace.angular else UNITS)[c]
    # the extremes are of single samples, whose noise is as likely to add as to take
    return Quantity(0.5 * float(np.ptp(trace[c])), noise[c].sigma / math.sqrt(2.0), unit)


def _rest(trace: Recording, noise: Mapping[str, Noise], edges: np.ndarray) -> Quantity:
    """Where the displacement stands after the stop."""
    unit = (ANGULAR if trace.angular else UNITS)["x"]
    if "x" not in trace:
        return Quantity.refused(unit, "the displacement was not given")
    if edges.size < 2:
        return Quantity.refused(unit, "no stop was found")
    half = float(np.median(np.diff(edges)))
    still = trace["x"][trace.t > edges[-1] + _STILL * half]
    if still.size < 8 or trace.t[-1] - edges[-1] < 0.5 * half:
        return Quantity.refused(unit, "the trace ends before it rests")
    own = noise["x"]
    error = own.sigma * math.sqrt(own.inflation(0.0, trace.interval) / still.size)
    # a quantised sensor at rest says one thing over and over
    return Quantity(float(np.mean(still)), max(error, own.step / math.sqrt(12.0)), unit)


def _events(trace: Recording, edges: np.ndarray, clock: Clock) -> list[Event]:
    if edges.size < 2:
        return []
    values = np.interp(edges, trace.t, trace["x"]) if "x" in trace else [None] * edges.size
    slack = 2.0 * trace.interval
    kinds = ["reversal"] * edges.size
    kinds[0] = "release" if edges[0] > trace.t[0] + slack else "start"
    kinds[-1] = "stop" if edges[-1] < trace.t[-1] - slack else "end"
    shown = clock.onto(edges)
    return [
        Event.model_validate({"time_s": float(t), "kind": kind, "value": None if x is None else float(x)})
        for t, kind, x in zip(shown, kinds, values, strict=True)
    ]


def differences(first: Reading, second: Reading) -> list[Difference]:
    """Every figure that both have, the most significant first."""
    found = []
    for what in FIGURES:
        one, other = getattr(first, what), getattr(second, what)
        if one.value is None or other.value is None:
            continue
        error = None if one.stderr is None or other.stderr is None else math.hypot(one.stderr, other.stderr)
        apart = abs(one.value - other.value)
        significance = None if not error else apart / error
        found.append(Difference(what=what, first=one, second=other, significance=significance))
    return sorted(found, key=lambda one: -(one.significance or 0.0))
