"""What is hidden: each effect in published forms other than the catalogue's, and effects of a random family.

A form is right when its mechanism is told: ``right`` holds the names that tell it. Forms are those of Armstrong, Dupont
and Canudas de Wit 1994 and Awrejcewicz and Olejnik 2005 (friction), Schiller and Naumann 1933 (drag), Hunt and Crossley
1975 and Johnson 1985 (contact), Dixon 2007 (valves of dampers), and of textbooks of machines (springs, cogging).
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.proof.paths import plant as at
from harness.proof.paths.plant import SIZE, TABLE

DECAY, SWING, DOWN, SPRING, SHAKEN, AXIS, SLOW, CURVE, TOGETHER, JOINT, SERVO, SIMULATED, ARM = PATHS = (
    *("free decay", "pendulum", "run-down", "driven on a spring", "driven pendulum", "axis under a controller"),
    *("slow axis", "friction curve", "several together", "robot joint", "servo", "own simulation"),
    "whole arm",
)
"""Ways that give a verdict."""
FIRST = 9
"""Of them those that the published proof has."""
_SPRUNG, _AXES = (DECAY, SPRING, TOGETHER, SIMULATED), (AXIS, SLOW, JOINT, ARM)
_SWUNG = (*_SPRUNG, SWING, SHAKEN)
_MOVED = (*_SWUNG, *_AXES)
_ALONE = _MOVED[:-1]
"""All of them but an arm's, whose load has an effect of its own and does not sway."""


@dataclass(frozen=True, slots=True)
class Scales:
    """Of a motion: m (kg), c, k, f_k as the slider has them; fast (m/s), far (m), span (s), slow and dt (s)."""

    m: float
    c: float
    k: float
    f_k: float
    fast: float
    far: float
    span: float
    slow: float
    dt: float

    @property
    def force(self) -> float:
        """N, of a spring, or of friction where there is none."""
        return self.k * self.far if self.k else self.f_k + self.c * self.fast


Numbers = Mapping[int, float]
Rng = np.random.Generator


@dataclass(frozen=True, slots=True)
class Form:
    """What is hidden.

    right : names that tell it. paths : on which it is hidden. numbers : by place, at a moderate strength, from the
    scales and chance. strength : place of the number that is made larger or smaller.
    """

    right: tuple[str, ...]
    paths: tuple[str, ...]
    strength: int
    numbers: Callable[[Scales, Rng], Numbers]


def _between(rng: Rng, low: float, high: float) -> float:
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def _stribeck(form: float) -> Form:
    paths = (*_MOVED, DOWN, CURVE)
    return Form(("stribeck", "static-friction"), paths, at.STRIBECK, lambda s, rng: {
        at.STRIBECK: 0.5 * s.f_k, at.STRIBECK_V: s.fast * _between(rng, 0.03, 0.25), at.STRIBECK_FORM: form,
    })  # fmt: skip


def _stick(form: float) -> Form:
    return Form(("static-friction", "stribeck"), (SPRING, SHAKEN), at.STICK, lambda s, rng: {
        at.STICK: 0.5 * s.f_k, at.STICK_T: s.slow * _between(rng, 0.02, 0.2), at.STICK_FORM: form,
    })  # fmt: skip


def _bristle(form: float) -> Form:
    return Form(("presliding",), _MOVED, at.BRISTLE, lambda s, rng: {at.BRISTLE: 0.03 * s.far, at.BRISTLE_FORM: form})


def _drag(form: float) -> Form:
    right = ("power-law-damping",) if form == 2.0 else ("quadratic-drag", "power-law-damping")
    return Form(right, (*_MOVED, DOWN, CURVE), at.DRAG, lambda s, rng: {
        at.DRAG: 0.3 * max(s.c, 0.3 * s.f_k / s.fast), at.DRAG_V: s.fast * _between(rng, 0.5, 3.0), at.DRAG_FORM: form,
    })  # fmt: skip


def _stop(form: float) -> Form:
    return Form(("end-stop",), (*_SPRUNG, SWING, SLOW), at.STOP, lambda s, rng: {
        at.STOP: 2.0 * s.force / (0.2 * s.far) ** 1.5, at.STOP_X: s.far * rng.uniform(0.65, 0.9), at.STOP_FORM: form,
    })  # fmt: skip


def _hard(form: float, *right: str) -> Form:
    return Form(right, _SPRUNG, at.HARD, lambda s, rng: {
        at.HARD: 0.1 * s.force, at.HARD_X: s.far * _between(rng, 0.6, 1.5), at.HARD_FORM: form,
    })  # fmt: skip


def _sides(form: float, *paths: str) -> Form:
    right = ("asymmetric-viscous",) if form == 0.0 else ("asymmetric-viscous", "quadratic-drag")
    return Form(right, paths, at.SIDES, lambda s, rng: {
        at.SIDES: 0.3 * max(s.c, 0.3 * s.f_k / s.fast), at.SIDES_V: s.fast * (0.05 if form == 0.0 else 1.0),
        at.SIDES_FORM: form,
    })  # fmt: skip


def _warm(form: float) -> Form:
    return Form(("friction-drift",), _MOVED, at.WARM, lambda s, rng: {
        at.WARM: 0.4 * s.f_k, at.WARM_FORM: form,
        at.WARM_T: rng.uniform(0.3, 1.0) * s.span * (1.0 if form == 0.0 else 0.3 * s.f_k * s.fast),
    })  # fmt: skip


def _late(form: float) -> Form:
    return Form(("sensor-lag",), (DECAY, SPRING), at.LATE, lambda s, rng: {at.LATE: 0.05 * s.slow, at.LATE_FORM: form})


def _at_rest(form: float) -> Form:
    return replace(_stribeck(form), right=("rest-friction",), paths=(SERVO,))


_PLACED = ("load-dependent-friction", "position-dependent-friction")
FORMS: dict[str, Form] = {
    "Stribeck, Lorentzian": _stribeck(0.0),
    "Stribeck, exponential": _stribeck(1.0),
    "Stribeck, exponential of a root": _stribeck(2.0),
    "static friction by dwell time": _stick(0.0),
    "static friction by loading rate": _stick(1.0),
    "presliding, Maxwell slip": _bristle(0.0),
    "presliding, Dahl squared": _bristle(1.0),
    "presliding, elasto-plastic": _bristle(2.0),
    "drag, linear to quadratic": _drag(0.0),
    "drag, Schiller-Naumann": _drag(1.0),
    "drag, |v|^.7": _drag(2.0),
    "stop, Hertz": _stop(0.0),
    "stop, Hunt-Crossley": _stop(1.0),
    "spring, sinh": _hard(0.0, "cubic-stiffness"),
    "spring, arctan": _hard(1.0, "cubic-stiffness", "pendulum-stiffness"),
    "spring, magnets": _hard(2.0, "cubic-stiffness"),
    "spring, gas column": _hard(3.0, "quadratic-stiffness"),
    "valve, two slopes": _sides(0.0, *_MOVED, CURVE),
    "valve, squared on one side": _sides(1.0, *_MOVED, CURVE),
    "warming by time": _warm(0.0),
    "warming by work": _warm(1.0),
    "lag, delay": _late(0.0),
    "lag, first order": _late(1.0),
    "lag, second order": _late(2.0),
    "play with compliance": Form(("backlash",), _SPRUNG, at.PLAY, lambda s, rng: {
        at.PLAY: 0.02 * s.force, at.PLAY_X: 0.025 * s.far,
    }),
    "ripple with harmonics": Form(("force-ripple",), (DECAY, *_AXES), at.COG, lambda s, rng: {
        at.COG: 0.3 * s.f_k, at.COG_L: 2.0 * s.far / _between(rng, 2.0, 20.0), at.COG_P: rng.uniform(0.0, 6.3),
    }),
    "two Maxwell arms": Form(("viscoelastic",), _SPRUNG, at.ARM, lambda s, rng: {
        at.ARM: 0.1 * s.k, at.ARM_1: s.slow * _between(rng, 0.3, 3.0), at.ARM_2: s.slow * _between(rng, 3.0, 15.0),
    }),
    "load on a bearing": Form(_PLACED, _ALONE, at.LOAD, lambda s, rng: {
        at.LOAD: 0.6 * s.f_k, at.LOAD_X: s.far * _between(rng, 0.3, 1.0),
    }),
    "friction along the way": Form(("position-dependent-friction",), _MOVED, at.SLOPE, lambda s, rng: {
        at.SLOPE: 0.3 * s.f_k, at.SLOPE_X: s.far * _between(rng, 0.5, 1.5),
    }),
    "a spring that warms": Form(("stiffness-drift",), _SWUNG, at.SOFT, lambda s, rng: {
        at.SOFT: 0.02 * s.k, at.SOFT_T: s.span * rng.uniform(0.3, 1.0),
    }),
    "load that sways": Form(("normal-load-variation",), _ALONE, at.SWAY, lambda s, rng: {
        at.SWAY: 0.4 * s.f_k, at.SWAY_W: _between(rng, 0.3, 3.0) / s.slow,
    }),
    "hum, clipped": Form(("harmonic-force",), (DECAY, SPRING, AXIS), at.HUM, lambda s, rng: {
        at.HUM: 0.05 * s.force, at.HUM_W: _between(rng, 1.7, 4.0) / s.slow,
    }),
    "a blow, half a sine": Form(("impulse",), (DECAY, SPRING, SHAKEN), at.PULSE, lambda s, rng: {
        at.PULSE: 0.5 * s.force, at.PULSE_T: s.span * rng.uniform(0.15, 0.6), at.PULSE_L: 0.2 * s.slow,
    }),
    "attached, with turbulent damping": Form(("attached-mode",), (DECAY, SPRING), at.MODE, lambda s, rng: {
        at.MODE: 0.03, at.MODE_W: _between(rng, 1.6, 4.0) / s.slow, at.MODE_Z: _between(rng, 0.005, 0.03),
    }),
    "accelerometer that saturates": Form(("sensor-clipping",), (DECAY,), at.CLIP, lambda s, rng: {at.CLIP: 0.5}),
    "sensor that warms": Form(("sensor-drift",), (DECAY,), at.WANDER, lambda s, rng: {
        at.WANDER: 0.02 * s.far, at.WANDER_T: s.span * rng.uniform(0.3, 1.0),
    }),
    "servo, friction at rest, Lorentzian": _at_rest(0.0),
    "servo, friction at rest, exponential": _at_rest(1.0),
    "servo, friction at rest, of a root": _at_rest(2.0),
    "servo, gears under a preload": Form(("load-friction", "load-friction-by-side"), (SERVO,), at.GEAR, lambda s, rng: {
        at.GEAR: 0.15, at.GEAR_U: s.k * _between(rng, 0.1, 0.5),
    }),
    "servo, a supply that sags": Form(("concave-drive", "torque-limit"), (SERVO,), at.SAG, lambda s, rng: {
        at.SAG: 0.1,
    }),
    "servo, a limit with a knee": Form(("torque-limit", "concave-drive"), (SERVO,), at.LIMIT, lambda s, rng: {
        at.LIMIT: 1.0 / (s.k + s.f_k + s.c * s.fast),
    }),
    "servo, a soft dead band": Form(("dead-band",), (SERVO,), at.DEAD, lambda s, rng: {at.DEAD: 0.01}),
    "servo, a profile of its goal": Form(("goal-speed-limit",), (SERVO,), at.RAMP, lambda s, rng: {
        at.RAMP: 1.0 / s.fast,
    }),
    "arm, gears under a preload": Form(("load-dependent-friction",), (ARM,), at.GEAR, lambda s, rng: {
        at.GEAR: 0.1, at.GEAR_U: s.f_k * _between(rng, 0.5, 2.0),
    }),
    "arm, a tool in its hand": Form(("payload",), (ARM,), at.TOOL, lambda s, rng: {at.TOOL: 0.3}),
    "arm, a motor weaker than said": Form(("motor-constant",), (ARM,), at.WEAK, lambda s, rng: {at.WEAK: 0.1}),
    "arm, torque through a filter": Form(("torque-delay",), (ARM,), at.FILTER, lambda s, rng: {at.FILTER: 0.008}),
    "arm, a joint off its mark": Form(("zero-offset",), (ARM,), at.MARK, lambda s, rng: {at.MARK: 0.012}),
    "arm, a base out of level": Form(("tilt",), (ARM,), at.TILT, lambda s, rng: {at.TILT: 0.03}),
}  # fmt: skip
"""By a name in words. Among them none of the catalogue's own formulas but those of a delay and of a goal's profile."""
OF_MODEL = ("payload", "torque-delay", "zero-offset", "tilt")
"""Names that are of no joint."""
NEEDS_BOTH = ("lag, delay", "lag, first order", "lag, second order", "accelerometer that saturates")
"""Forms that show in a free decay only beside the other channel."""
SHAPES = ("f(x)", "f(v)", "f(x, v)", "f(t)", "hysteresis", "g(x) sgn v")
"""Of effects of the random family."""


def numbers(values: Numbers, s: Scales) -> FloatArray:
    """Of an effect, (SIZE,)."""
    p = np.zeros(SIZE)
    p[at.FAST] = s.fast
    for place, value in values.items():
        p[place] = value
    return p


def unknown(shape: str, s: Scales, rng: Rng) -> tuple[FloatArray, FloatArray]:
    """Numbers of an effect of the random family and its three smooth tables, (3, TABLE), of about unit size."""
    grid, found = np.linspace(-2.0, 2.0, TABLE), np.zeros((3, TABLE))
    for order in range(1, 6):
        size, phase = rng.standard_normal((3, 1)) / order, rng.uniform(0.0, 6.3, (3, 1))
        found += size * np.sin(0.5 * math.pi * order * grid + phase)
    p = {
        at.UNKNOWN: 0.1 * s.force if shape != "g(x) sgn v" else 0.4 * s.f_k,
        at.UNKNOWN_FORM: float(SHAPES.index(shape)),
        at.UNKNOWN_X: s.far * (1.0 if shape != "hysteresis" else _between(rng, 0.05, 0.5)),
        at.UNKNOWN_V: s.fast,
        at.UNKNOWN_T: s.span if shape == "f(t)" else rng.uniform(1.0, 3.0),
    }
    return numbers(p, s), found


def laws(x: FloatArray, v: FloatArray, t: FloatArray) -> dict[str, list[FloatArray]]:
    """Columns of the catalogue's laws along a motion, in units of its own: what an unknown effect is projected on.

    In the forms that a name stands for: Stribeck's is any fall of friction with speed, a drag any power above one.
    """
    q, w, s, side = x / (np.ptp(x) or 1.0), v / np.max(np.abs(v)), (t - t[0]) / (t[-1] - t[0]), np.sign(v)
    found = {
        "quadratic-drag": [side * np.abs(w) ** e for e in (1.5, 2.0, 3.0)],
        "power-law-damping": [
            *(side * np.abs(w) ** e for e in (0.1, 0.25, 0.5, 0.75)),
            *(w / np.hypot(w, e) for e in (0.1, 0.25, 0.5)),
        ],
        "asymmetric-viscous": [np.abs(w)],
        "cubic-stiffness": [q**3],
        "quadratic-stiffness": [q**2],
        "constant-force": [np.ones_like(q)],
        "position-dependent-friction": [q * side],
        "load-dependent-friction": [np.abs(q - np.mean(q)) * side, (q - np.mean(q)) ** 2 * side],
        "friction-drift": [s * side],
        "stiffness-drift": [s * q],
        "stribeck": [
            side * fall
            for r in (np.abs(w) / e for e in (0.03, 0.06, 0.12, 0.25, 0.4, 0.7))
            for fall in (np.exp(-(r**2)), np.exp(-r), 1.0 / (1.0 + r**2))
        ],
        "presliding": [np.exp(-np.abs(w) / e) * side for e in (0.02, 0.05)],
    }
    # whatever friction along the way looks like, its name is that of a slope or a wave of it
    carried = [2.0 * math.pi * n for n in np.geomspace(0.25, 40.0, 50)]
    found["position-dependent-friction"] += [side * np.stack((np.cos(n * q), np.sin(n * q))) for n in carried]
    turns = [2.0 * math.pi * n for n in np.geomspace(1.0, 40.0, 50)]
    found["force-ripple"] = [np.stack((np.cos(n * q), np.sin(n * q))) for n in turns]
    found["harmonic-force"] = [np.stack((np.cos(n * s), np.sin(n * s))) for n in turns]
    return found
