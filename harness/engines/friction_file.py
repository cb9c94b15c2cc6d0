"""A model's friction as a Python file that stands alone: numpy, and MuJoCo or PyBullet in the user's own loop.

No format has words for friction that falls with speed, grows with the load or builds up over a bristle: the file puts
it on the joint as a force. Dry friction takes in a step what would bring the joint to rest, up to its level: it sticks
without a creep, and it breaks away where that level is saturated.
"""

import re

from harness.model.model import Model, ModelTerm
from harness.model.term import Slot

_HEAD = '''"""Friction of {plain}: {said}.

Written by friction-harness; it needs numpy and the engine alone. N m and rad of a hinge, N and m of a slide.

MuJoCo:   friction = attach(model, data)   # once; the joint's own frictionloss and damping are replaced
          friction()                       # every step, before mujoco.mj_step(model, data)
PyBullet: apply(body, joint)               # every step, before pybullet.stepSimulation()
"""

import numpy as np
from numpy import abs, clip, cos, exp, pi, sign, sin  # noqa: A004, F401

JOINT, ZERO, C, F_K, F_S = {joint!r}, {zero!r}, {c!r}, {f_k!r}, {f_s!r}


def level(x, v, t, stuck=False):
    """Dry friction as it slides, or the load that it holds."""
    f_k = F_K
    curve = {curve}
    return max((max(F_S, curve) if stuck else curve) * {factors}, 0.0)


def viscous(x, v, t):
    """Resistance to a speed, beside C v."""
    return {viscous}


class Friction:
    """That of one joint, with what it remembers."""

    def __init__(self):
        self.stuck, self.limit, self.z, self.x, self.t = True, 0.0, {z!r}, None, 0.0

    def force(self, x, v, t, stop, a):
        """Force on the joint; stop: the one that ends the step at rest. a: acceleration without friction."""
'''
_DRY = """        self.limit = level(x, v, t, self.stuck)
        self.stuck = abs(stop) <= self.limit
        return clip(stop, -self.limit, self.limit) - viscous(x, v, t)
"""
_BRISTLE = """        f, dx = max(level(x, v, t), 1e-300), 0.0 if self.x is None else x - self.x
        end = sign(dx) * f / {sigma0!r}
        self.z, self.x = (end + (self.z - end) * exp(-abs(dx) * {sigma0!r} / f) if dx else self.z), x
        z, level_ = self.z, f
        return -({law}) - viscous(x, v, t)
"""
_SMOOTH = """        return -level(x, v, t) * ({law}) - viscous(x, v, t)
"""
_TAIL = '''

def attach(model, data, joint=JOINT):
    """For MuJoCo: what is to be called before every step; it writes data.qfrc_applied of the joint."""
    import mujoco

    own, j = Friction(), model.joint(joint).id
    at, dof = model.jnt_qposadr[j], model.jnt_dofadr[j]
    model.dof_frictionloss[dof], model.dof_damping[dof] = 0.0, C
    unit, response = np.zeros((1, model.nv)), np.zeros((1, model.nv))
    unit[0, dof] = 1.0

    def friction():
        h, x, v = model.opt.timestep, data.qpos[at] - ZERO, data.qvel[dof]
        data.qfrc_applied[dof] = 0.0
        mujoco.mj_forward(model, data)
        mujoco.mj_solveM(model, data, response, unit)
        m, a = 1.0 / response[0, dof], data.qacc[dof]
        at_end = 0.0 if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4 else h * C
        data.qfrc_applied[dof] = own.force(x, v, data.time, -(v * (m + at_end) / h + m * a), a)

    return friction


_KNOWN = {}


def apply(body, joint, client=0):
    """For PyBullet: to be called before every step; dry friction is the joint's velocity motor."""
    import pybullet as p

    key = (client, body, joint)
    x, v, _, motor = p.getJointState(body, joint, physicsClientId=client)
    if key not in _KNOWN:
        _KNOWN[key] = Friction()
        p.changeDynamics(body, joint, jointDamping=C, linearDamping=0, angularDamping=0, physicsClientId=client)
    own = _KNOWN[key]
    own.stuck = abs(motor) < own.limit * (1.0 - 1e-9) or (own.t == 0.0 and v == 0.0)
    force = own.force(x - ZERO, v, own.t, 0.0, 0.0)
    p.setJointMotorControl2(body, joint, p.VELOCITY_CONTROL, targetVelocity=0, force=own.limit, physicsClientId=client)
    p.setJointMotorControl2(body, joint, p.TORQUE_CONTROL, force=force, physicsClientId=client)
    own.t += p.getPhysicsEngineParameters(physicsClientId=client)["fixedTimeStep"]
'''


def friction_file(model: Model, joint: str, zero: float = 0.0, native: bool = False) -> str:
    """The text of friction.py for a model's joint.

    zero : of its position (rad or m), where the model's x is 0. native : the joint's own element has what MJCF has
    words for.
    """
    level = next((_expression(one) for one in model.in_slot(Slot.FRICTION_LEVEL)), "f_k")
    factors = [_expression(one) for one in model.in_slot(Slot.FRICTION_MODULATION) if one.term.in_python]
    more = [_expression(one) for one in _viscous(model, native)]
    law = next(iter(model.in_slot(Slot.FRICTION_LAW)), None)
    static = model.in_slot(Slot.BREAK_AWAY)
    f_s = static[0].values[0] if static else model.f_s if model.f_s is not None else model.f_k
    body = _DRY
    if law is not None and law.term.internal:
        expression = re.sub(r"\blevel\b", "level_", _expression(law))
        body = _BRISTLE.format(law=expression, sigma0=law.values[0])
    elif law is not None:
        body = _SMOOTH.format(law=_expression(law))
    said = [f"dry {model.f_k:.4g}, viscous {model.c:.4g}", *(entry.term.key for entry in _spoken(model, native))]
    start = law.internal0[0] if law is not None and law.term.internal else 0.0
    head = _HEAD.format(
        joint=joint,
        zero=float(zero),
        plain=re.sub(r"[^\w .:/-]", "_", joint),
        said=", ".join(said),
        c=model.c,
        f_k=model.f_k,
        f_s=0.0 if law is not None else max(f_s, 0.0),
        curve=level,
        factors=" * ".join(f"({one})" for one in factors) or "1.0",
        viscous=" + ".join(more) or "0.0",
        z=start,
    )
    return head + body + _TAIL


def _spoken(model: Model, native: bool) -> tuple[ModelTerm, ...]:
    """Terms that the file has."""
    slots = (Slot.FRICTION_LEVEL, Slot.FRICTION_LAW, Slot.FRICTION_MODULATION)
    dry = [one for one in model.in_slot(*slots) if one.term.in_python]
    return (*dry, *model.in_slot(Slot.BREAK_AWAY), *_viscous(model, native))


def _viscous(model: Model, native: bool) -> list[ModelTerm]:
    every = [one for one in model.in_slot(Slot.SMOOTH) if one.term.in_python]
    return [one for one in every if not (native and one.term.elements)]


def _expression(entry: ModelTerm) -> str:
    """The law with its numbers."""
    values = dict(zip(entry.term.names, entry.values, strict=True))
    return re.sub(
        r"\b[A-Za-z_]\w*\b", lambda found: repr(values.get(found[0], found[0])).strip("'"), entry.term.in_python
    )
