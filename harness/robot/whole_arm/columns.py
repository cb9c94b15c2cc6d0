"""Columns that may be added to the regression of a whole arm: laws of friction, errors of the rigid model."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.model.terms import (
    asymmetric_viscous,
    force_ripple,
    friction_drift,
    load_dependent_friction,
    position_dependent_friction_cosine,
    power_law_damping,
    quadratic_drag,
    stribeck,
)
from harness.robot.arm import Arm
from harness.robot.whole_arm.differentiate import Filtered
from harness.robot.whole_arm.perturb import (
    called,
    loaded_bodies,
    moving_bodies,
    tilted,
    with_load,
    with_mass,
    with_zeros,
)
from harness.robot.whole_arm.rules import (
    COVERED,
    DELAY_SPREAD,
    FASTEST_RIPPLE,
    GAIN_SPREAD,
    LOAD_SPREAD,
    LOADED,
    MASS_SPREAD,
    MOMENT_SPREAD,
    SLOWEST_RIPPLE,
    TILT_SPREAD,
    ZERO_SPREAD,
)

STRIBECK, LOAD, RIPPLE = stribeck.TERM.name, load_dependent_friction.TERM.name, force_ripple.TERM.name
POSITION, ASYMMETRIC = position_dependent_friction_cosine.TERM.name, asymmetric_viscous.TERM.name
QUADRATIC, DRIFT, POWER = quadratic_drag.TERM.name, friction_drift.TERM.name, power_law_damping.TERM.name
INERTIA, PAYLOAD, MOTOR, DELAY = "inertia-error", "payload", "motor-constant", "torque-delay"
SENSOR, TILT, ARMATURE, ZERO = "sensor-side", "tilt", "armature-error", "zero-offset"
SPRING = "joint-spring"
WITHIN_A_SAMPLE = "delay-within-a-sample"

LOAD_OR_POSITION = "load- or position-dependent friction of a gravity joint"
SCALE_OR_MASS = "scale of torque against mass"
MASS_AT_END = "extra mass at the end"
ROTOR_OR_AXIS = "armature or inertia about the axis"
ZERO_OR_CENTRE = "zero of a position or centre of mass of what it carries"
WHICH_IS_LATE = "which of position and torque is late"
ROTOR_OR_SENSOR = "side of the sensor or a rotor's inertia"
ERRORS = {
    INERTIA: (MOTOR, SCALE_OR_MASS),
    PAYLOAD: ("mass of the last link", MASS_AT_END),
    MOTOR: (INERTIA, SCALE_OR_MASS),
    DELAY: ("early position", WHICH_IS_LATE),
    SENSOR: (ARMATURE, ROTOR_OR_SENSOR),
    TILT: ("", ""),
    ZERO: ("centre of mass of what such a joint carries", ZERO_OR_CENTRE),
    ARMATURE: ("inertia of the link about the axis", ROTOR_OR_AXIS),
    SPRING: ("", ""),
}
"""Of an error of the model or of the torque's record: what it can never be told from, and both as one pair."""

Key = tuple[str, int | None]
"""Name of a candidate, and the joint that it is of; None for the whole arm."""
Columns = dict[int, FloatArray]
"""By joint, (m, c) torque for one unit of each of c numbers; joints that it does not touch are left out."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """One thing that may be missing.

    name : as results call it. joint : the one it is of, None for the whole arm. torque : its columns at a value of what
    is not linear in them. numbers : name and unit of what multiplies each column. spread (c,) : standard deviation
    expected of each number beforehand, inf where anything goes. what : name and unit of the value, if there is one.
    values : those that are tried. smooth : the columns go with the value without a jump. looks : independent values
    that this one is the best of, where it was chosen among them and polished. positive : the first number is above 0,
    or the effect is not what its name says. viscous : it stands in place of the joint's viscous friction. among : what
    a polished one was before. limits : between which its value may come out, by default the first and the last tried.
    bodies : where a load may sit, by value; the first stands unless another is surely better. form : what its law is in
    place of the catalogue's own formula. forms : the same law in others, or in place of viscous friction.
    """

    name: str
    joint: int | None
    torque: Callable[[float], Columns]
    numbers: tuple[tuple[str, str], ...]
    spread: FloatArray
    what: tuple[str, str] | None = None
    values: tuple[float, ...] = (0.0,)
    smooth: bool = True
    looks: float = 1.0
    positive: bool = False
    viscous: bool = False
    among: "Candidate | None" = None
    limits: tuple[float, float] | None = None
    bodies: tuple[int, ...] = ()
    form: str = ""
    forms: "tuple[Candidate, ...]" = ()

    @property
    def key(self) -> Key:
        """What tells it from the others."""
        return self.name, self.joint

    @property
    def of_friction(self) -> bool:
        """Whether it is a law of a joint's friction, and no error beside."""
        return self.name not in ERRORS

    def around(self, value: float, numbers: FloatArray, looks: float) -> "Candidate":
        """The candidate at one value, with a further column: what a step of that changes.

        numbers (c,) : of the columns at that value; the further number is the step. looks : values it was among.
        """
        assert self.what is not None
        every, step = self.among or self, _STEP * value
        ((joint, at),) = every.torque(value).items()
        slope = (every.torque(value + step)[joint] - every.torque(value - step)[joint]) @ numbers / (2.0 * step)
        columns = {joint: np.column_stack((at, slope))}
        more, spread = (*every.numbers, self.what), np.append(every.spread, np.inf)
        return replace(
            every, torque=lambda _: columns, numbers=more, spread=spread, values=(value,), looks=looks, among=every
        )

    def stepped(self, value: float, step: float) -> float:
        """Where a step from a value ends: as far away as a neighbour of those tried at most, and within the limits."""
        assert self.among is not None
        grid = self.among.values
        at = min(max(int(np.searchsorted(grid, value)), 1), len(grid) - 1)
        far, (lower, upper) = grid[at] - grid[at - 1], self.limits or (grid[0], grid[-1])
        return float(np.clip(value + np.clip(step, -far, far), lower, upper))


_STEP = 1e-3
"""Share of a value by which it is moved to see what it changes."""
_SPEEDS = 10
"""Stribeck speeds that are tried."""
_EXPONENTS = np.linspace(power_law_damping.TERM.parameters[1].lower, power_law_damping.TERM.parameters[1].upper, 7)
"""Powers of the speed that are tried."""
_NOTHING = 1e-9
"""N m or N: a range of gravity below it is rounding."""
OF_GRAVITY, OF_MOTION, CARRIED = 0.0, 1.0, 2.0
"""Which load friction grows with: gravity's torque, that with the motion's, or all in the gears, friction's too."""


def signs(v: FloatArray) -> FloatArray:
    """Mean sign (M,) of a speed (M,) over each sample's own step, taken for straight."""
    change = np.abs(np.gradient(v)) / 2.0
    return np.asarray(np.clip(v / np.maximum(change, 1e-300), -1.0, 1.0))


def of_friction(
    name: str, joint: int, numbers: tuple[tuple[str, str], ...], columns: FloatArray | Callable[[float], FloatArray],
    what: tuple[str, str] | None = None, values: FloatArray | None = None, smooth: bool = True,
) -> Candidate:  # fmt: skip
    """A law of a joint's friction, of whose numbers nothing is expected. columns : (m, c), or what makes them."""
    tried = (0.0,) if values is None else tuple(values.tolist())
    made = columns if callable(columns) else lambda _: columns
    return Candidate(
        name, joint, lambda value: {joint: made(value)}, numbers, np.full(len(numbers), np.inf), what, tried, smooth
    )


_FALLS: Mapping[str, Callable[[FloatArray], FloatArray]] = {
    "": lambda u: np.exp(-(u**2)),
    "an exponential": lambda u: np.exp(-u),
    "a Lorentzian": lambda u: 1.0 / (1.0 + u**2),
}
"""What is left of a fall at so many Stribeck speeds, by its form (Armstrong, Dupont and Canudas de Wit 1994)."""
_TAIL = 3.0
"""Stribeck speeds at which other forms' tails still hold 5 and 10 % of a fall, and show it; a Gaussian is gone."""


def fall_with_speed(
    name: str, filtered: Filtered, joint: int, speeds: FloatArray, limits: tuple[float, float] | None = None,
    form: str = "",
) -> Candidate:  # fmt: skip
    """Friction that is higher at rest and falls with speed."""
    v, left = filtered.v_fine[:, filtered.dof[joint]], _FALLS[form]
    sign = signs(v)

    def fallen(v_s: float) -> FloatArray:
        return filtered.column((sign * left(np.abs(v) / v_s))[:, None], jumps=True)

    found = of_friction(name, joint, (("f_s - f_c", "N m"),), fallen, ("v_s", "rad/s"), speeds)
    return replace(found, positive=True, limits=limits, form=form)


def falling(filtered: Filtered, joint: int, kept: BoolArray) -> Candidate | None:
    """The fall with speed that samples ``kept`` (m,) of a joint may show; None where none of them are slow."""
    slow = np.abs(filtered.v[kept, filtered.dof[joint]])
    if not slow.size or not (least := np.quantile(slow, COVERED.value)) > 0.0:
        return None
    most, slowest, fastest = float(np.quantile(slow, 0.7)), float(np.min(slow)), float(np.max(slow))

    def of(form: str) -> Candidate:
        tail = _TAIL if form else 1.0
        speeds = np.geomspace(least / tail, most, _SPEEDS)
        return fall_with_speed(STRIBECK, filtered, joint, speeds, (slowest / tail, fastest), form)

    own, *others = map(of, _FALLS)
    return replace(own, forms=tuple(others))


def concave(filtered: Filtered, joint: int) -> Candidate:
    """Damping by a power of the speed below one, beside viscous friction or, where that says it, in its place."""
    v = filtered.v_fine[:, filtered.dof[joint]]
    sign = signs(v)

    def power(exponent: float) -> FloatArray:
        return filtered.column((sign * np.abs(v) ** exponent)[:, None])

    found = of_friction(POWER, joint, (("c_p", "N m (s/rad)^p"),), power, ("exponent", "1"), _EXPONENTS)
    beside = replace(found, positive=True)
    return replace(beside, forms=(replace(beside, viscous=True),))


def convex(filtered: Filtered, joint: int) -> Candidate:
    """Drag that grows with the square of the speed."""
    v = filtered.v_fine[:, filtered.dof[joint]]
    found = of_friction(QUADRATIC, joint, (("c_2", "N m s^2/rad^2"),), filtered.column((v * np.abs(v))[:, None]))
    return replace(found, positive=True)


def friction_candidates(
    filtered: Filtered, joint: int, loads: Mapping[float, FloatArray], kept: BoolArray
) -> Iterator[Candidate]:
    """What is judged on guarded samples ``kept`` (m,); loads : (M,), N m, by which they are."""
    dof = filtered.dof[joint]
    q, v = filtered.q_fine[:, dof], filtered.v_fine[:, dof]
    sign, time = signs(v), (filtered.t_fine - filtered.t_fine[0]) / filtered.seconds - 0.5

    def one(name: str, number: str, unit: str, column: FloatArray, jumps: bool = False) -> Candidate:
        return of_friction(name, joint, ((number, unit),), filtered.column(column[:, None], jumps))

    if (fall := falling(filtered, joint, kept)) is not None:
        yield fall
    bearing = np.array([by for by, load in loads.items() if np.ptp(load) > _NOTHING])
    if bearing.size:
        pressed = {by: filtered.column((sign * np.abs(loads[by]))[:, None], jumps=True) for by in bearing.tolist()}
        yield of_friction(LOAD, joint, (("share of load", "1"),), pressed.__getitem__, None, bearing, smooth=False)
    yield one(ASYMMETRIC, "half difference", "N m s/rad", np.abs(v))
    yield convex(filtered, joint)
    yield concave(filtered, joint)
    rising = filtered.column(np.stack((sign * time, v * time), axis=1), jumps=True)
    yield of_friction(DRIFT, joint, (("rise of Coulomb", "N m"), ("rise of viscous", "N m s/rad")), rising)
    span = float(np.ptp(filtered.q[:, dof]))
    if span > 0.0:
        typical = float(np.median(np.abs(filtered.v[:, dof])))
        fastest = min(FASTEST_RIPPLE.value, math.pi * filtered.band.lowpass / max(typical, 1e-9))
        step, middle = math.pi / (2.0 * span), (np.max(q) + np.min(q)) / 2.0
        slowest = {RIPPLE: max(SLOWEST_RIPPLE.value, 2.0 * math.pi / span), POSITION: step}

        def waved(wave: float, by: FloatArray | float, jumps: bool) -> FloatArray:
            angle = wave * (q - middle)
            return filtered.column(np.stack((by * np.sin(angle), by * np.cos(angle)), axis=1), jumps)

        made = {RIPPLE: lambda wave: waved(wave, 1.0, False), POSITION: lambda wave: waved(wave, sign, True)}
        for name, columns in made.items():
            if (waves := np.arange(slowest[name], fastest, step)).size:
                numbers = ("sine", "N m"), ("cosine", "N m")
                yield of_friction(name, joint, numbers, columns, ("wave", "1/rad"), waves)


_MODEL_STEP, _TURN, _BESIDE = 0.1, 0.01, 0.05
"""kg, rad and m: how far the model is moved to see what a load, a tilt and a place change; all but linear in them."""


def model_candidates(
    filtered: Filtered, arm: Arm, payload_known: bool, sensor_known: bool, gain_known: bool
) -> Iterator[Candidate]:
    """Errors of the model and of the torque's record that stand beside friction."""
    rigid, dofs = filtered.rigid(arm), np.array(filtered.dof)

    def error(
        name: str, columns: FloatArray, spread: float | list[float], *numbers: tuple[str, str], of: int | None = None
    ) -> Candidate:
        """columns (m, k, c), or (m, c) of one joint."""
        own = {of: columns} if of is not None else {j: columns[:, j].copy() for j in range(dofs.size)}
        return Candidate(name, of, lambda _: own, numbers, np.broadcast_to(spread, len(numbers)))

    def changed(other: Arm, step: float) -> FloatArray:
        return np.asarray((filtered.rigid(other) - rigid) / step)

    def loaded(body: int) -> FloatArray:
        """Torque (m, k, 4) of a load on a body, by its mass and its moments."""
        middle = changed(with_load(arm, _MODEL_STEP, on=body), _MODEL_STEP)
        places = (with_load(arm, _MODEL_STEP, _BESIDE * axis, body) for axis in np.eye(3))
        return np.stack((middle, *((changed(one, _MODEL_STEP) - middle) / _BESIDE for one in places)), axis=2)

    bodies = moving_bodies(arm)
    masses = np.stack([changed(with_mass(arm, body, 1.0 + _MODEL_STEP), _MODEL_STEP) for body in bodies], axis=2)
    names = [(called(arm, body), "1") for body in bodies]
    yield error(INERTIA, masses, MASS_SPREAD.value, *names)
    if not payload_known:
        on = loaded_bodies(arm, int(LOADED.value))
        columns = [loaded(body) for body in on]
        moments = [(f"moment {axis}", "kg m") for axis in "xyz"]
        spread = [LOAD_SPREAD.value, *[MOMENT_SPREAD.value] * 3]
        load = error(PAYLOAD, columns[0], spread, ("mass", "kg"), *moments)
        by_body = [{j: one[:, j].copy() for j in range(dofs.size)} for one in columns]
        values = tuple(float(i) for i in range(len(on)))
        yield replace(load, torque=lambda i: by_body[int(i)], values=values, smooth=False, bodies=on)
    turned = np.stack([changed(tilted(arm, _TURN, axis), _TURN) for axis in (0, 1)], axis=2)
    if np.max(np.abs(turned)) > _NOTHING:
        yield error(TILT, turned, TILT_SPREAD.value, ("about x", "rad"), ("about y", "rad"))
    tied = {j for tie in arm.ties for j in (tie.leads, tie.follows)}
    own = [dof for dof in filtered.dof if dof not in tied]
    shifts = [changed(with_zeros(arm, _TURN * np.eye(len(arm.joints))[dof]), _TURN) for dof in own]
    seen = [k for k, columns in enumerate(shifts) if np.max(np.abs(columns)) > _NOTHING]
    if seen:
        names = [(arm.joints[own[k]], "m" if arm.slides(arm.joints[own[k]]) else "rad") for k in seen]
        yield error(ZERO, np.stack([shifts[k] for k in seen], axis=2), ZERO_SPREAD.value, *names)
    late = -np.gradient(rigid, 1.0 / filtered.out.rate, axis=0)[:, :, None]
    yield error(DELAY, late, DELAY_SPREAD.value, ("delay", "s"))
    if not sensor_known and np.any(arm.armature[dofs] > 0.0):
        unseen = -(arm.armature * filtered.a)[:, dofs, None]
        yield error(SENSOR, unseen, 1.0, ("share of rotors unseen", "1"))
    gain = GAIN_SPREAD.value, ("gain - 1", "1")
    for j, dof in enumerate(filtered.dof):
        # a balancer, cables: beside an offset it pulls towards any place
        yield error(SPRING, filtered.q[:, dof : dof + 1], np.inf, ("stiffness", "N m/rad"), of=j)
        yield error(ARMATURE, filtered.a[:, dof : dof + 1], np.inf, ("inertia", "kg m^2"), of=j)
        if not gain_known:
            yield error(MOTOR, rigid[:, j : j + 1], *gain, of=j)
    if not gain_known:
        yield error(MOTOR, rigid[:, :, None], *gain)
