"""Forms of laws that have a shape of their own, one number each: tried where a law takes most but not all.

What hides has rarely the catalogue's own formula. Before a second name is added to a first its form is freed, so that
one effect in another form stays one name. A change in time that slows down is looked for at once: laws of the amplitude
of a decay follow it more nearly than a change at an even pace does.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Final

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.jit import lean
from harness.model.bristles import bent, bristle, nearing, yielding
from harness.model.law import (
    D_FREE,
    D_INTERNAL,
    D_LEVEL,
    D_PARAMETER,
    D_STIFFNESS,
    D_T,
    D_V,
    D_X,
    KINETIC,
    STIFFNESS,
    VALUE,
)
from harness.model.term import Evidence, Extent, FreedFrom, History, Parameter, Probe, States, Term
from harness.model.terms import (
    asymmetric_viscous,
    backlash,
    cubic_stiffness,
    end_stop,
    friction_drift,
    normal_load_variation,
    power_law_damping,
    presliding,
    quadratic_drag,
    quadratic_stiffness,
    regularised_friction,
    stiffness_drift,
    stribeck,
    viscoelastic,
)


@lean
def saturated(u: float, s: float) -> tuple[float, float, float]:
    """(1 - s) tanh u + s u/sqrt(1 + u^2), its slope by u and its partial by s."""
    soft, root = math.tanh(u), math.sqrt(1.0 + u * u)
    round_ = u / root
    slope = (1.0 - s) * (1.0 - soft * soft) + s / (root * root * root)
    return (1.0 - s) * soft + s * round_, slope, round_ - soft


def law_smooth(v: float, a: float, level: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """f_k ((1 - s) tanh u + s u/sqrt(1 + u^2)), u = (v + lead a0)/v_r, a0 the acceleration without friction."""
    v_r, lead = theta[o], theta[o + 1]
    u = (v + lead * a) / v_r
    ratio, steep, by_s = saturated(u, theta[o + 2])
    slope = level * steep
    out[VALUE] = level * ratio
    out[D_V] = slope / v_r
    out[D_FREE] = slope * lead / v_r
    out[D_LEVEL] = ratio
    out[D_PARAMETER] = -slope * u / v_r
    out[D_PARAMETER + 1] = slope * a / v_r
    out[D_PARAMETER + 2] = level * by_s


def law_stribeck(v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """f_k + (f_s - f_k) exp(-|v/v_s|^p); break-away at f_s."""
    f_s, v_s, p = theta[o], theta[o + 1], theta[o + 2]
    u, excess = abs(v) / v_s, theta[o] - theta[KINETIC]
    power = u**p if u > 0.0 else 0.0
    # exactly f_s at v = 0, where it is held against the break-away level
    fallen = math.expm1(-power)
    left = 1.0 + fallen
    out[VALUE] = f_s + excess * fallen
    out[D_LEVEL] = -fallen
    out[D_PARAMETER] = left
    if u > 0.0:
        out[D_V] = -excess * left * p * power / v
        out[D_PARAMETER + 1] = excess * left * p * power / v_s
        out[D_PARAMETER + 2] = -excess * left * power * math.log(u)


def law_stribeck_tail(v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """f_k + (f_s - f_k) (1 + h (v/v_s)^2)^(-1/h): Gaussian at h = 0, Lorentzian at 1; break-away at f_s."""
    f_s, v_s, h = theta[o], theta[o + 1], theta[o + 2]
    u2, excess = (v / v_s) ** 2, theta[o] - theta[KINETIC]
    wide = 1.0 + h * u2
    # close to h = 0 the difference of two large numbers is nothing
    small = h * u2 < 1e-4
    fall = u2 * (1.0 - 0.5 * h * u2) if small else math.log1p(h * u2) / h
    by_h = u2 * u2 * (0.5 - 2.0 * h * u2 / 3.0) if small else (fall - u2 / wide) / h
    fallen = math.expm1(-fall)
    left = 1.0 + fallen
    out[VALUE] = f_s + excess * fallen
    out[D_V] = -2.0 * excess * left * v / (v_s * v_s * wide)
    out[D_LEVEL] = -fallen
    out[D_PARAMETER] = left
    out[D_PARAMETER + 1] = 2.0 * excess * left * u2 / (v_s * wide)
    out[D_PARAMETER + 2] = excess * left * by_h


def law_saturating(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """c_p v (v^2 + v_0^2)^((p-1)/2): in proportion to v below v_0, a power p of it above; it saturates at p = 0."""
    c_p, p, v_0 = theta[o], theta[o + 1], theta[o + 2]
    s2 = v * v + v_0 * v_0
    if s2 > 0.0:
        grown = s2 ** (0.5 * (p - 1.0))
        out[VALUE] = c_p * v * grown
        out[D_V] = c_p * grown * (1.0 + (p - 1.0) * v * v / s2)
        out[D_PARAMETER] = v * grown
        out[D_PARAMETER + 1] = 0.5 * c_p * v * grown * math.log(s2)
        out[D_PARAMETER + 2] = c_p * v * grown * (p - 1.0) * v_0 / s2


def law_knee(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """c_p ((1 - s) tanh u + s u/sqrt(1 + u^2)), u = v/v_0: in proportion to v below v_0, level above it."""
    c_p, s, v_0 = theta[o], theta[o + 1], theta[o + 2]
    u = v / v_0
    ratio, slope, by_s = saturated(u, s)
    out[VALUE] = c_p * ratio
    out[D_V] = c_p * slope / v_0
    out[D_PARAMETER] = ratio
    out[D_PARAMETER + 1] = c_p * by_s
    out[D_PARAMETER + 2] = -c_p * slope * u / v_0


_LEAST_GAP: Final = 0.05
"""Of a gas column that is left at the end of its way; what goes further meets a column that closes no more."""


@lean
def power(z: float, by_z: int, theta: FloatArray, o: int, out: FloatArray) -> None:
    """c |z|^p sgn z, c and p from theta[o] on; by_z : the column of its partial by z."""
    c, p, s = theta[o], theta[o + 1], abs(z)
    if s > 0.0:
        grown, side = s**p, 1.0 if z > 0.0 else -1.0
        out[VALUE] = c * grown * side
        out[by_z] = c * p * grown / s
        out[D_PARAMETER] = grown * side
        out[D_PARAMETER + 1] = c * grown * side * math.log(s)


def law_drag(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """c2 |v|^p sgn v."""
    power(v, D_V, theta, o, out)


def law_one_way(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """c_diff |v|^p one way, where v has its sign, and nothing the other way."""
    c_diff, p, s = theta[o], theta[o + 1], abs(v)
    if c_diff * v > 0.0:
        grown = s**p
        out[VALUE] = c_diff * grown
        out[D_V] = abs(c_diff) * p * grown / s
        out[D_PARAMETER] = grown
        out[D_PARAMETER + 1] = c_diff * grown * math.log(s)


def law_closing(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """k2 x^2/(1 + closing x), up to closing x = -1: with a spring what a gas at one temperature does (Boyle)."""
    k2, closing = theta[o], theta[o + 1]
    left = max(1.0 + closing * x, _LEAST_GAP)
    own = 1.0 if left > _LEAST_GAP else 0.0
    out[VALUE] = k2 * x * x / left
    out[D_X] = k2 * x * (2.0 - own * closing * x / left) / left
    out[D_PARAMETER] = x * x / left
    out[D_PARAMETER + 1] = -own * k2 * x * x * x / (left * left)


def law_hardening(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """k3 |x|^p sgn x."""
    power(x, D_X, theta, o, out)


@lean
def push(deep: float, side: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Of a stop on this side (1 or -1), ``deep`` m beyond its gap."""
    k_stop, p, grown = theta[o + 1], theta[o + 2], deep ** theta[o + 2]
    out[VALUE] = side * k_stop * grown
    out[D_X] = k_stop * p * grown / deep
    out[D_PARAMETER] = -side * k_stop * p * grown / deep
    out[D_PARAMETER + 1] = side * grown
    out[D_PARAMETER + 2] = side * k_stop * grown * math.log(deep)


def law_stop(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """k_stop (x - gap)^p beyond +gap, on the positive side."""
    if x > theta[o]:
        push(x - theta[o], 1.0, theta, o, out)


def law_stop_negative(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """-k_stop (-x - gap)^p beyond -gap, on the negative side."""
    if -x > theta[o]:
        push(-x - theta[o], -1.0, theta, o, out)


def law_stop_both(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """k_stop (|x| - gap)^p sgn x beyond the gap, on both sides."""
    if abs(x) > theta[o]:
        push(abs(x) - theta[o], 1.0 if x > 0.0 else -1.0, theta, o, out)


def law_play(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """-share k clip(x, -gap, gap): softer by a share of the spring within the gap."""
    gap, share, k = theta[o], theta[o + 1], theta[STIFFNESS]
    within = -gap < x < gap
    clipped = min(max(x, -gap), gap)
    out[VALUE] = -share * k * clipped
    out[D_X] = -share * k if within else 0.0
    out[D_STIFFNESS] = -share * clipped
    out[D_PARAMETER] = 0.0 if within else (-share * k if x > 0.0 else share * k)
    out[D_PARAMETER + 1] = -k * clipped


def law_relaxing(x: float, v: float, w0: float, w1: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Row 0: force k_m (y_1 + y_2)/2 on the left. Rows 1 and 2: y' = v - y/tau_i, tau/sqrt(spread) and times it."""
    k_m, tau, spread = theta[o], theta[o + 1], theta[o + 2]
    root = math.sqrt(spread)
    out[0, VALUE] = 0.5 * k_m * (w0 + w1)
    out[0, D_PARAMETER] = 0.5 * (w0 + w1)
    out[0, D_INTERNAL] = 0.5 * k_m
    out[0, D_INTERNAL + 1] = 0.5 * k_m
    out[1, VALUE] = v - w0 * root / tau
    out[1, D_V] = 1.0
    out[1, D_PARAMETER + 1] = w0 * root / (tau * tau)
    out[1, D_PARAMETER + 2] = -0.5 * w0 / (root * tau)
    out[1, D_INTERNAL] = -root / tau
    out[2, VALUE] = v - w1 / (tau * root)
    out[2, D_V] = 1.0
    out[2, D_PARAMETER + 1] = w1 / (tau * tau * root)
    out[2, D_PARAMETER + 2] = 0.5 * w1 / (tau * root * spread)
    out[2, D_INTERNAL + 1] = -1.0 / (tau * root)


def _stretched(values: Probe, motion: History) -> States:
    """Both branches as the recorded speed has left them, relaxed at first."""
    k_m, tau, spread = values
    root = math.sqrt(spread)
    one, other = (viscoelastic.stretched((k_m, each), motion) for each in (tau / root, tau * root))
    by = np.column_stack((one.by[1], other.by[1]))
    return States(
        np.column_stack((one.values, other.values)),
        {1: by * (1.0 / root, root), 2: by * (-0.5 * tau / (root * spread), 0.5 * tau / root)},
    )


def law_bristle(v: float, side: int, z: float, level: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """z' = v (1 - w)^p, w = side sigma0 z/f_k, f = sigma0 z + sigma1 z' (Dahl 1968)."""
    q = 1.0 - side * theta[o] * z / level
    pace, by_q, by_p = nearing(q, theta[o + 2])
    bristle(v, side, z, level, theta, o, q, pace, by_q, by_p, out)


def law_yielding(v: float, side: int, z: float, level: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """z' = v (1 - max(w, 0)^n), w = side sigma0 z/f_k, f = sigma0 z + sigma1 z' (Bouc, Wen; elasto-plastic)."""
    q = 1.0 - side * theta[o] * z / level
    pace, by_q, by_n = yielding(q, theta[o + 2])
    bristle(v, side, z, level, theta, o, q, pace, by_q, by_n, out)


@lean
def passed_by(t: float, b: float) -> tuple[float, float]:
    """(1 - exp(-b t))/b, s, and its partial by b."""
    if abs(b * t) > 1e-4:
        passed = -math.expm1(-b * t) / b
        return passed, (t * math.exp(-b * t) - passed) / b
    return t * (1.0 - 0.5 * b * t), -t * t * (0.5 - b * t / 3.0)


def law_warming(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """k rate (1 - exp(-b t))/b x: a change that slows down, or speeds up where b is below 0."""
    rate, b, k = theta[o], theta[o + 1], theta[STIFFNESS]
    passed, by_b = passed_by(t, b)
    out[VALUE] = k * rate * passed * x
    out[D_X] = k * rate * passed
    out[D_T] = k * rate * math.exp(-b * t) * x
    out[D_STIFFNESS] = rate * passed * x
    out[D_PARAMETER] = k * passed * x
    out[D_PARAMETER + 1] = k * rate * by_b * x


def law_wear(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Factor 1 + rate (1 - exp(-b t))/b: a change that slows down, or speeds up where b is below 0."""
    rate, b = theta[o], theta[o + 1]
    passed, by_b = passed_by(t, b)
    out[VALUE] = 1.0 + rate * passed
    out[D_T] = rate * math.exp(-b * t)
    out[D_PARAMETER] = passed
    out[D_PARAMETER + 1] = rate * by_b


def law_swaying(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Factor 1 + depth cos u sqrt((1 + b)/(1 + b cos^2 u)), u = Omega t + phase, b its flatness: square at large b."""
    depth, omega, b = theta[o], theta[o + 1], theta[o + 3]
    u = omega * t + theta[o + 2]
    c, s, most = math.cos(u), math.sin(u), math.sqrt(1.0 + b)
    below = math.sqrt(1.0 + b * c * c)
    steep = -depth * s * most / (below * below * below)
    out[VALUE] = 1.0 + depth * c * most / below
    out[D_T] = omega * steep
    out[D_PARAMETER] = c * most / below
    out[D_PARAMETER + 1] = t * steep
    out[D_PARAMETER + 2] = steep
    out[D_PARAMETER + 3] = 0.5 * depth * c * s * s / (most * below * below * below)


def _of(law: Term, form: Callable[..., None], shape: Parameter, starts: FreedFrom, **other: Any) -> Term:
    """The entry of a law whose form is freed."""
    variant = other.pop("variant", f"{law.variant}-free" if law.variant else "free")
    kept = ("name", "family", "slot", "parameters", "corner", "place", "as_named", "needs", "told_from")
    said: dict[str, Any] = {name: getattr(law, name) for name in kept} | other
    said["parameters"] = (*said["parameters"], shape)
    said["sentence"] = f"{said.get('sentence', law.sentence[:-1])}, {shape.name} = {{{shape.name}}}."
    said.setdefault("searched", False)
    return Term(**said, law=form, variant=variant, frees=law.key, freed=starts, order=law.order + 1)


def _from(*shapes: float) -> FreedFrom:
    """From the law's own numbers, with these shapes."""
    return lambda values, span, speed: [(*values, one) for one in shapes]


_ROUND = {
    -0.59: "clipped (Huber, MuJoCo's friction loss)",
    -0.33: "as s (2 - s) (Drake's TAMSI)",
    0.0: "as tanh (Isaac's SysID, i2rt, OpenArm, Jiminy)",
    1.0: "as v/sqrt(v^2 + v_r^2) (Drake's lagged contact)",
}
"""Forms by the roundness that comes nearest to each."""


def _smoothed_as(values: Probe, k: float) -> Mapping[str, str]:
    return {"form": _ROUND[min(_ROUND, key=lambda roundness: abs(roundness - values[2]))]}


def _falls_as(values: Probe, k: float) -> Mapping[str, str]:
    return {"form": "a Gaussian" if values[2] > _GAUSSIAN else "an exponential"}


def _falls_with_tail(values: Probe, k: float) -> Mapping[str, str]:
    return {"form": "a Lorentzian" if values[2] > _LORENTZIAN else "a Gaussian"}


_GAUSSIAN, _LORENTZIAN, _TANH, _SATURATED, _KNEE = 1.5, 0.5, 0.5, 0.1, 0.15
"""Shapes from which a form has its name, and share of the fastest speed from which damping saturates."""


def _grows_as(values: Probe, k: float) -> Mapping[str, str]:
    return {"form": "saturates above" if values[1] < _SATURATED else "grows less above"}


def _damps(values: Probe, extent: Extent) -> bool:
    """What saturates close to rest is dry friction that is smoothed."""
    return values[1] >= _SATURATED or values[2] >= _KNEE * extent.speed


def _bends_as(values: Probe, k: float) -> Mapping[str, str]:
    return {"form": "as tanh" if values[1] < _TANH else "as v/sqrt(v^2 + v_0^2)"}


def _bends(values: Probe, extent: Extent) -> bool:
    """What saturates close to rest is dry friction that is smoothed."""
    return values[2] >= _KNEE * extent.speed


def _in_the_middle(values: Probe, extent: Extent) -> bool:
    """What is stiffer nearer to an end than to the middle is a stop."""
    return values[0] <= 0.5 * extent.reach


def _slowing(values: Probe, span: float, speed: float) -> list[Probe]:
    """At the same pace all along, and three times as fast at first."""
    return [(*values, 0.0), (3.0 * values[0], 3.0 / span)]


def _slowed(seen: Evidence) -> list[Probe]:
    """By the end of the recording, and well before it: a law of the amplitude follows these, and not an even pace."""
    return [(0.0, pace / seen.duration) for pace in (1.5, 5.0)]


def _stop(stop: Term, form: Callable[..., None]) -> Term:
    gap, k_stop = stop.parameters
    return _of(
        stop, form, Parameter("exponent", "1", 1.0, 4.0), _from(1.0, 1.5), example=(0.53, 200.0, 1.5),
        parameters=(gap, replace(k_stop, unit="N/m^p")),
    )  # fmt: skip


_FALLS = "Friction falls with speed as {form} (Stribeck): from f_s = {f_s} at rest to f_k, over v_s = {v_s}"
_BENDS = "Friction builds up over a presliding displacement (bristle): sigma0 = {sigma0}, sigma1 = {sigma1}"
SMOOTH = _of(
    regularised_friction.TERM, law_smooth, Parameter("roundness", "1", -1.0, 3.0),
    lambda values, span, speed: [(0.8 * values[0], values[1], s) for s in (0.0, 1.0)], example=(0.6, 0.02, 0.4),
    corner=False, words=_smoothed_as,
    sentence="Friction is smoothed over speeds below {v_r}, reverses {lead} ahead of it and never sticks: {form}",
)  # fmt: skip
STRIBECK = _of(
    stribeck.TERM, law_stribeck, Parameter("exponent", "1", 0.5, 4.0), _from(2.0, 1.0), example=(5.0, 0.8, 1.3),
    words=_falls_as, sentence=_FALLS,
)  # fmt: skip
STRIBECK_TAIL = _of(
    stribeck.TERM, law_stribeck_tail, Parameter("tail", "1", 0.0, 3.0), _from(0.3, 1.0), example=(5.0, 0.8, 0.7),
    words=_falls_with_tail, sentence=_FALLS, variant="free-tail",
)  # fmt: skip
SATURATING = _of(
    power_law_damping.TERM, law_saturating, Parameter("v_0", "m/s", 0.0, positive=True),
    lambda values, span, speed: [(values[0] * speed ** values[1], 0.0, 0.2 * speed), (*values, 0.03 * speed)],
    example=(0.8, 0.3, 0.2), words=_grows_as, as_named=_damps,
    parameters=(power_law_damping.TERM.parameters[0], Parameter("exponent", "1", 0.0, 0.8)),
    sentence="Damping {form} a speed v_0: c_p = {c_p}, exponent = {exponent}",
)  # fmt: skip
KNEE = _of(
    power_law_damping.TERM, law_knee, Parameter("v_0", "m/s", 0.0, positive=True),
    lambda values, span, speed: [(values[0] * speed ** values[1], s, 0.3 * speed) for s in (0.0, 1.0)],
    example=(0.8, 0.3, 0.2), words=_bends_as, as_named=_bends, variant="free-knee",
    parameters=(Parameter("c_p", "N", 0.0, none=0.0), Parameter("roundness", "1", -1.0, 3.0)),
    sentence="Damping saturates above a speed v_0, {form}: c_p = {c_p}",
)  # fmt: skip
PLAY = _of(
    backlash.TERM, law_play, Parameter("share", "1", 0.0, 1.0, none=0.0),
    lambda values, span, speed: [(n * values[0], 1.0 / n) for n in (2.0, 8.0)],
    example=(0.1, 0.4), as_named=_in_the_middle,
    sentence="Play that is held softly: the spring is softer within {gap} either side of the middle",
)  # fmt: skip
RELAXING = _of(
    viscoelastic.TERM, law_relaxing, Parameter("spread", "1", 1.0, 1e3),
    lambda values, span, speed: [(values[0], values[1], n) for n in (3.0, 20.0)],
    example=(30.0, 0.1, 5.0), internal=2, implied=_stretched,
    sentence="Two viscoelastic (Maxwell) branches relax, about {tau}, one so many times slower: k_m = {k_m}",
)  # fmt: skip
BRISTLE = _of(
    presliding.TERM, law_bristle, Parameter("exponent", "1", 0.3, 3.0),
    lambda values, span, speed: [(1.5 * values[0], values[1], 0.5), (0.6 * values[0], values[1], 1.7)],
    example=(2000.0, 5.0, 1.4), internal=1, implied=bent(yields=False), sentence=_BENDS,
)  # fmt: skip
YIELDING = _of(
    presliding.TERM, law_yielding, Parameter("sharpness", "1", 1.0, 30.0),
    lambda values, span, speed: [(values[0], values[1], 1.0), (0.8 * values[0], values[1], 4.0)],
    example=(2000.0, 5.0, 2.5), internal=1, implied=bent(yields=True), sentence=_BENDS, variant="free-yield",
)  # fmt: skip
DRAG = _of(
    quadratic_drag.TERM, law_drag, Parameter("exponent", "1", 1.2, 5.0), _from(2.0), example=(0.2, 2.6),
    parameters=(Parameter("c2", "N (s/m)^p", 0.0),), sentence="A drag grows with a power of the speed: c2 = {c2}",
)  # fmt: skip
ONE_WAY = _of(
    asymmetric_viscous.TERM, law_one_way, Parameter("exponent", "1", 1.0, 4.0),
    lambda values, span, speed: [(2.0 * values[0] * speed ** (1.0 - p), p) for p in (1.0, 2.0)], example=(0.3, 1.6),
    parameters=(Parameter("c_diff", "N (s/m)^p"),),
    sentence="Damping grows with a power of the speed one way, forwards where c_diff is above 0: c_diff = {c_diff}",
)  # fmt: skip
CLOSING = _of(
    quadratic_stiffness.TERM, law_closing, Parameter("closing", "1/m"), _from(0.0), example=(20.0, 0.4),
    sentence="The two sides of the spring differ, as of a column of gas: a force k2 x^2/(1 + closing x), k2 = {k2}",
)  # fmt: skip
HARDENING = _of(
    cubic_stiffness.TERM, law_hardening, Parameter("exponent", "1", 1.3, 8.0), _from(3.0), example=(20.0, 2.4),
    parameters=(Parameter("k3", "N/m^p"),), sentence="The spring is not linear: a force k3 |x|^p, k3 = {k3}",
)  # fmt: skip
STOP = _stop(end_stop.TERM, law_stop_both)
STOP_POSITIVE = _stop(end_stop.TERM_POSITIVE, law_stop)
STOP_NEGATIVE = _stop(end_stop.TERM_NEGATIVE, law_stop_negative)
WARMING = _of(
    stiffness_drift.TERM, law_warming, Parameter("slowing", "1/s"), _slowing, example=(-0.1, 0.3),
    searched=True, probes=_slowed, amplitude=0,
)  # fmt: skip
WEAR = _of(
    friction_drift.TERM, law_wear, Parameter("slowing", "1/s"), _slowing, example=(-0.2, 0.3),
    searched=True, probes=_slowed, amplitude=0,
)  # fmt: skip
SWAYING = _of(
    normal_load_variation.TERM, law_swaying, Parameter("flatness", "1", 0.0, 1e3), _from(1.0),
    example=(0.3, 7.0, 0.2, 1.5),
    sentence="The normal load varies at {Omega}, flatter than a cosine, and friction with it by a fraction {depth}",
)  # fmt: skip
