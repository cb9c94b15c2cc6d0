"""A joint of the user's file as it is: MuJoCo steps the compiled model itself, under its own options, the others held.

They are held by a rotor that nothing moves, which leaves the softness of the joint's friction as the whole model has
it; contacts are off. What a reduced equation ignores is then in it: flags, compensated gravity, noslip, motors'
friction, servos over tendons, whatever else the file says.
"""

import copy
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from harness.core.apart import Found, read_apart
from harness.core.arrays import FloatArray
from harness.core.bounded import MODELS, check_file
from harness.core.errors import InputError
from harness.engines.mujoco.presets import INTEGRATORS, warned
from harness.robot.apart import ACCEPTED, HINGE_OR_SLIDE, prepared
from harness.robot.reduction import gravity_of

Gravity = tuple[float, float, float] | None

HELD = 1e9
"""Rotor inertia, kg m^2 or kg, of a joint that is to stand still."""
_MOST_LOAD = 0.97
"""Of dry friction: a heavier load slides."""
HELD_FOR = 0.5
"""s; creep is that of the second half."""
_SLOWEST = 0.05
"""Of the speed at which a joint is let go, below which it counts as stopped."""
_SECONDS = 120
"""Of a processor, for all of it."""
_LEFT = 0.01
"""rad or m beside its target at which a servo is let go."""
_SERVO_STEPS = 500
_COAST_S, _COAST_STEPS = 4.0, 20_000
_PROBE = 1e-5
"""rad or m, and per s, over which a force's slope is taken."""
_FAR = 1e3
"""rad or m, and per s: no joint is there."""
_LEVEL = 1e-9
"""Torque of gravity, N m or N, below which there is none."""
_SPECK = 1e-12
"""Stiffness and damping of a bristle that is not to be felt; without any a motor has no state for it."""
_OFF = mujoco.mjtDisableBit
_FRICTIONLESS = _OFF.mjDSBL_FRICTIONLOSS.value | _OFF.mjDSBL_CONSTRAINT.value
_BAD = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)
_MOTOR = mujoco.mjtBias.mjBIAS_DCMOTOR.value
# of a dcmotor: gains of its controller in gainprm; Coulomb, static, Stribeck speed in biasprm; the bristle in dynprm
_CONTROLLER, _LUGRE, _BRISTLE = slice(4, 7), slice(3, 6), slice(5, 7)


@dataclass(frozen=True, slots=True)
class Stop:
    """A joint let go at a speed without a load. v0 : rad/s or m/s. time, travel : s, rad or m until ``_SLOWEST`` of it;
    exact_ : by Coulomb's law and the damping there is. Infinite where it has not stopped.
    """

    v0: float
    time: float
    travel: float
    exact_time: float
    exact_travel: float


@dataclass(frozen=True, slots=True)
class AsItIs:
    """What a file's joint does; kg m^2, N m, rad for a hinge, kg, N, m for a slide.

    dt, integrator : of the file. inertia : that the joint moves. softness : that of friction at rest, over that of
    the joint alone with this inertia. gravity : largest torque after compensation. friction,
    break_away : dry friction in force, of joint, tendon and motor. switched_off : friction that the file has and does
    not use. damping, spring : of joint and medium. stiffness, servo_damping : of its servos. at_end : of both dampings,
    what the integrator takes at a step's end. kp : of the one actuator that has a gain. load, creep : the torque it
    held, along it; None without. pose : where gravity is the load; None where it was put on. stop : see there.
    diverges, servo_diverges : steps after which it did, let go with and without servo. hold : t, x, v. notes :
    one sentence each.
    """

    version: str
    dt: float
    integrator: str
    inertia: float
    softness: float
    gravity: float
    friction: float
    break_away: float
    switched_off: float
    damping: float
    spring: float
    stiffness: float
    servo_damping: float
    at_end: float
    kp: float | None
    load: float | None
    creep: float | None
    pose: float | None
    stop: Stop | None
    diverges: int | None
    servo_diverges: int | None
    hold: tuple[FloatArray, FloatArray, FloatArray]
    notes: tuple[str, ...]


def as_it_is(path: Path, joint: str, gravity: Gravity = None) -> AsItIs:
    """Step a file, in a process apart; gravity : m/s^2, None for the file's own. Raises InputError."""
    check_file(path, accepted=ACCEPTED, suffixes=MODELS)
    columns, about = read_apart(
        f"{__name__}:columns_of", path, ACCEPTED, seconds=_SECONDS, kept=True, joint=joint, gravity=gravity
    )
    stop = None if about["stop"] is None else Stop(*(math.inf if one is None else one for one in about["stop"]))
    hold = (columns["t"], columns["x"], columns["v"])
    return AsItIs(**{**about, "stop": stop, "hold": hold, "notes": tuple(about["notes"])})


def columns_of(path: Path, joint: str, gravity: list[float] | None) -> Found:
    """The reader."""
    model, _ = prepared(path, {}, fixed=False)
    if gravity is not None:
        model.opt.gravity[:] = gravity
        model.opt.disableflags &= ~_OFF.mjDSBL_GRAVITY.value
    with warned():
        own = _Joint(str(path), model, joint)
        hold, about = own.scored()
    return dict(zip(("t", "x", "v"), hold, strict=True)), about


class _Joint:
    """One joint of a compiled model whose others are held."""

    def __init__(self, file: str, model: Any, joint: str) -> None:
        own = [i for i in range(model.njnt) if int(model.jnt_type[i]) in HINGE_OR_SLIDE]
        names = [model.joint(i).name or f"joint {n + 1}" for n, i in enumerate(own)]
        if joint not in names:
            raise InputError(file, f"no joint {joint!r}", f"one of {', '.join(names)}")
        self.j = own[names.index(joint)]
        self.at, self.q = int(model.jnt_dofadr[self.j]), int(model.jnt_qposadr[self.j])
        self.slides = int(model.jnt_type[self.j]) == mujoco.mjtJoint.mjJNT_SLIDE.value
        self.inertia = float(_masses(model)[self.at, self.at])
        # mj_setConst is not called: it would take the softness of friction from the held model
        mean, others = float(np.trace(_masses(model))), [i for i in range(model.nv) if i != self.at]
        model.dof_armature[others] = HELD
        model.dof_M0[others] += HELD  # what a body that moves nothing else has for its inertia
        # the solver counts its tolerance in inertias of all joints, the held ones among them
        model.opt.tolerance *= mean / float(np.trace(_masses(model)))
        model.opt.noslip_tolerance *= mean / float(np.trace(_masses(model)))
        model.opt.disableflags |= _OFF.mjDSBL_CONTACT.value
        self.model, self.h = model, float(model.opt.timestep)
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        self.acting: list[tuple[int, float]] = []
        """Actuators that move the joint, each with its arm: torque at the joint over its force."""
        for i in range(model.nactuator):
            row = int(model.actuator_outadr[i])
            arm = _sparse(
                data.actuator_moment, data.moment_rowadr, data.moment_rownnz, data.moment_colind, row, self.at
            )
            if arm != 0.0:
                self.acting.append((i, arm))
        self.notes: list[str] = []

    def scored(self) -> tuple[tuple[FloatArray, FloatArray, FloatArray], dict[str, Any]]:
        """Motion under the load, and the fields of AsItIs."""
        friction, break_away, off = self._friction()
        slopes = self._slopes()
        a, b, level = gravity_of(self.model, self.model.qpos0, self.j, self.inertia)
        gravity = abs(a) if self.slides else 0.0 if level else math.hypot(a, b)
        q_eq = None if self.slides or level else math.atan2(-b, a)
        servo_stays = slopes["stiffness"] <= 0.0
        let_go = self.model if servo_stays else self._let_go()
        dry = max(friction, off)
        # what creep is measured under; nothing is held without dry friction
        load = None if dry <= 0.0 else min(gravity, _MOST_LOAD * dry) if gravity > _LEVEL else _MOST_LOAD * dry
        hold, creep, pose, worst = self._held(let_go, load, gravity, q_eq, slopes["spring"])
        brakes = slopes["damping"] + (slopes["servo_damping"] if servo_stays else 0.0)
        plain = break_away == friction and slopes["spring"] == 0.0
        stop, ran_off = self._coast(let_go, friction if plain else 0.0, brakes)
        kp, pulling = None, [i for i, _ in self.acting if self._pulls(i)]
        if len(pulling) == 1:
            motor = int(self.model.actuator_biastype[pulling[0]]) == _MOTOR
            gain = self.model.actuator_gainprm[pulling[0], _CONTROLLER.start]
            kp = float(gain if motor else -self.model.actuator_biasprm[pulling[0], 1])
        return hold, {
            "version": mujoco.__version__,
            "dt": self.h,
            "integrator": INTEGRATORS[int(self.model.opt.integrator)],
            "inertia": self.inertia,
            "softness": float(self.model.dof_invweight0[self.at]) * self.inertia,
            "gravity": gravity,
            "friction": friction,
            "break_away": break_away,
            "switched_off": off,
            **slopes,
            "kp": kp,
            "load": load,
            "creep": creep,
            "pose": pose,
            "stop": stop,
            "diverges": ran_off if worst is None else worst,
            "servo_diverges": None if servo_stays and slopes["servo_damping"] <= 0.0 else self._released(),
            "notes": self.notes,
        }

    def _friction(self) -> tuple[float, float, float]:
        """Dry friction in force, the load it breaks away at, and what the file has and does not use."""
        model, data = self.model, mujoco.MjData(self.model)
        mujoco.mj_forward(model, data)
        own = float(model.dof_frictionloss[self.at])
        for i in range(model.ntendon):
            arm = _sparse(data.ten_J, model.ten_J_rowadr, model.ten_J_rownnz, model.ten_J_colind, i, self.at)
            own += abs(arm) * float(model.tendon_frictionloss[i])
        off = own if model.opt.disableflags & _FRICTIONLESS else 0.0
        sliding = held = own - off
        for i, arm in self.acting:
            if int(model.actuator_biastype[i]) == _MOTOR and model.actuator_dynprm[i, _BRISTLE.start] > 0.0:
                coulomb, static, speed = map(float, model.actuator_biasprm[i, _LUGRE])
                unit, each = ("N", "m") if self.slides else ("N m", "rad")
                self.notes.append(
                    f"the motor {model.actuator(i).name or i + 1} has friction of its own: it breaks away at"
                    f" {abs(arm) * static:.4g} {unit} and slides at {abs(arm) * coulomb:.4g} {unit}, Stribeck's speed"
                    f" {speed / abs(arm):.4g} {each}/s, bristles of"
                    f" {arm**2 * float(model.actuator_dynprm[i, _BRISTLE.start]):.4g} {unit}/{each}"
                )
                sliding, held = sliding + abs(arm) * coulomb, held + abs(arm) * static
        return sliding, held, off

    def _slopes(self) -> dict[str, float]:
        """How forces at the joint answer to its position and speed, and what of it is taken at a step's end."""
        # without dry friction, gravity, limits and bounds of forces what is left is as good as linear
        model = copy.copy(self.model)
        model.dof_frictionloss[:] = model.tendon_frictionloss[:] = 0.0
        model.opt.disableflags |= _OFF.mjDSBL_GRAVITY.value | _OFF.mjDSBL_LIMIT.value
        model.actuator_forcelimited[:] = model.actuator_ctrllimited[:] = False
        model.jnt_actfrclimited[:] = False
        for i, _ in self.acting:
            if int(model.actuator_biastype[i]) == _MOTOR:
                model.actuator_dynprm[i, _BRISTLE] = np.minimum(model.actuator_dynprm[i, _BRISTLE], _SPECK)

        def forces(q: float, v: float) -> FloatArray:
            data = mujoco.MjData(model)
            data.ctrl[:] = self.target
            data.qpos[self.q] += q
            data.qvel[self.at] = v
            mujoco.mj_forward(model, data)
            passive = data.qfrc_passive[self.at] - data.qfrc_gravcomp[self.at]
            return np.array([data.qfrc_actuator[self.at], passive])

        by_q = (forces(-_PROBE, 0.0) - forces(_PROBE, 0.0)) / (2.0 * _PROBE)
        by_v = (forces(0.0, -_PROBE) - forces(0.0, _PROBE)) / (2.0 * _PROBE)
        scale = self.inertia / self.h
        stiffness, spring, servo, own = (
            float(value) if abs(value) > 1e-9 * least else 0.0
            for value, least in zip((*by_q, *by_v), (scale / self.h, scale / self.h, scale, scale), strict=True)
        )
        return {
            "stiffness": stiffness,
            "spring": spring,
            "servo_damping": servo,
            "damping": own,
            "at_end": self._at_end(model, servo + own),
        }

    def _at_end(self, model: Any, c: float) -> float:
        """Of a damping c, what acts at the end of a step of Euler or of an implicit integrator: a step tells."""
        speeds = []
        for v in (0.0, _PROBE):
            data = mujoco.MjData(model)
            data.ctrl[:] = self.target
            data.qvel[self.at] = v
            mujoco.mj_step(model, data)
            speeds.append(float(data.qvel[self.at]))
        lost = 1.0 - (speeds[1] - speeds[0]) / _PROBE
        return min(max(c / lost - self.inertia / self.h, 0.0), c) if c > 0.0 and lost > 0.0 else 0.0

    @property
    def target(self) -> FloatArray:
        """Controls (nu,) with which the servos of the joint leave it where the model's reference has it."""
        found = np.zeros(self.model.nu)
        model, data = self.model, mujoco.MjData(self.model)
        for i, _ in self.acting:
            u = int(model.actuator_ctrladr[i])
            both = []
            for value in (0.0, 1.0):
                data.ctrl[:] = 0.0
                data.ctrl[u] = value
                mujoco.mj_forward(model, data)
                both.append(float(data.actuator_force[int(model.actuator_outadr[i])]))
            if self._pulls(i) and both[1] != both[0]:
                found[u] = -both[0] / (both[1] - both[0])
        return found

    def _pulls(self, i: int) -> bool:
        """Whether an actuator's force depends on where the joint is."""
        model = self.model
        if int(model.actuator_biastype[i]) == _MOTOR:
            return bool(np.any(model.actuator_gainprm[i, _CONTROLLER]))
        return bool(model.actuator_biasprm[i, 1] != 0.0)

    def _let_go(self) -> Any:
        """A copy whose servos of this joint do not pull; the friction of a motor stays."""
        model = copy.copy(self.model)
        for i, _ in self.acting:
            if not self._pulls(i):
                continue
            if int(model.actuator_biastype[i]) == _MOTOR:
                model.actuator_gainprm[i, _CONTROLLER] = 0.0
            else:
                model.actuator_gainprm[i] = model.actuator_biasprm[i] = 0.0
        return model

    def _held(
        self, model: Any, load: float | None, gravity: float, q_eq: float | None, spring: float
    ) -> tuple[tuple[FloatArray, FloatArray, FloatArray], float | None, float | None, int | None]:
        """Motion under a load, creep along it, the pose in which gravity is it, and the step at which it diverged."""
        if load is None:
            return (np.zeros(0), np.zeros(0), np.zeros(0)), None, None, None
        data = mujoco.MjData(model)
        pose = None if spring != 0.0 else self._pose(load, gravity, q_eq)
        along = 1.0
        if pose is None:
            model = copy.copy(model)
            model.opt.disableflags |= _OFF.mjDSBL_GRAVITY.value
            data.qfrc_applied[self.at] = load
        else:
            data.qpos[self.q] = pose
            mujoco.mj_forward(model, data)
            along = -math.copysign(1.0, float(data.qfrc_bias[self.at] - data.qfrc_gravcomp[self.at]))
        t, x, v, bad = self._run(model, data, max(4, round(HELD_FOR / self.h)))
        x, v = along * (x - x[0]), along * v
        half = t.size // 2
        creep = None if bad is not None else float((x[-1] - x[half]) / (t[-1] - t[half]))
        return (t, x, v), creep, pose, bad

    def _pose(self, load: float, gravity: float, q_eq: float | None) -> float | None:
        """Where gravity is the load, nearest to the reference, within the joint's range; None where that is nowhere."""
        start = float(self.model.qpos0[self.q])
        if self.slides:
            return start if gravity > _LEVEL and math.isclose(load, gravity) else None
        if q_eq is None or load > gravity * (1.0 + 1e-9):
            return None
        turn = math.asin(min(load / gravity, 1.0))
        turned = (q_eq + turn, q_eq - turn, q_eq + math.pi - turn, q_eq - math.pi + turn)
        near = [start + math.remainder(q - start, 2.0 * math.pi) for q in turned]
        low, high = map(float, self.model.jnt_range[self.j])
        limited = bool(self.model.jnt_limited[self.j])
        inside = [q for q in near if not limited or low <= q <= high]
        return min(inside, key=lambda q: abs(q - start), default=None)

    def _coast(self, model: Any, friction: float, c: float) -> tuple[list[float | None] | None, int | None]:
        """A joint let go at a speed without gravity, beside Coulomb's law; the step at which it ran away."""
        if friction <= 0.0 and c <= 0.0:
            return None, None
        model = copy.copy(model)
        model.opt.disableflags |= _OFF.mjDSBL_GRAVITY.value | _OFF.mjDSBL_LIMIT.value
        v0 = 1.0 if friction <= 0.0 or c <= 0.0 else min(1.0, 0.9 * friction / c)
        data = mujoco.MjData(model)
        data.qvel[self.at] = v0
        steps = min(_COAST_STEPS, math.ceil(_COAST_S / self.h))
        t, x, v, bad = self._run(model, data, steps, slow=_SLOWEST * v0, fast=10.0 * v0)
        if bad is not None or friction <= 0.0:
            return None, bad
        end = _SLOWEST * v0
        stopped = abs(float(v[-1])) <= end
        took, went = (float(t[-1]), float(x[-1] - x[0])) if stopped else (None, None)
        m = self.inertia  # m v' = -friction - c v from v0 to the end
        if c <= 0.0:
            return [v0, took, went, m * (v0 - end) / friction, 0.5 * m * (v0**2 - end**2) / friction], None
        time = m / c * math.log((friction + c * v0) / (friction + c * end))
        return [v0, took, went, time, (m * (v0 - end) - friction * time) / c], None

    def _released(self) -> int | None:
        """The step at which a servo that holds the joint diverges, let go beside its target."""
        data = mujoco.MjData(self.model)
        data.ctrl[:] = self.target
        data.qpos[self.q] += _LEFT
        data.qvel[self.at] = _LEFT if not any(self._pulls(i) for i, _ in self.acting) else 0.0
        return self._run(self.model, data, _SERVO_STEPS)[3]

    def _run(
        self, model: Any, data: Any, steps: int, slow: float = 0.0, fast: float = _FAR
    ) -> tuple[FloatArray, FloatArray, FloatArray, int | None]:
        """Times, positions and speeds until it is slow, and the step at which it is lost."""
        rows = [(0.0, float(data.qpos[self.q]), float(data.qvel[self.at]))]
        bad = None
        for n in range(1, steps + 1):
            mujoco.mj_step(model, data)
            q, v = float(data.qpos[self.q]), float(data.qvel[self.at])
            lost = any(data.warning[kind].number for kind in _BAD)
            if lost or not abs(q - rows[0][1]) < _FAR or not abs(v) < fast:
                bad = n
                break
            rows.append((n * self.h, q, v))
            if abs(v) < slow:
                break
        t, x, v = np.array(rows).T.copy()
        return t, x, v, bad


def _masses(model: Any) -> FloatArray:
    data, mass = mujoco.MjData(model), np.zeros((model.nv, model.nv))
    mujoco.mj_forward(model, data)
    mujoco.mj_fullM(model, data, mass)
    return mass


def _sparse(values: Any, first: Any, count: Any, columns: Any, row: int, column: int) -> float:
    """A number of a matrix that is kept by rows without zeros."""
    own = range(int(first[row]), int(first[row]) + int(count[row]))
    return sum(float(values[n]) for n in own if int(columns[n]) == column)
