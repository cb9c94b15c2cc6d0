"""A model's friction as a Python file that stands alone: numpy, and MuJoCo or PyBullet in the user's own loop.

No format has words for friction that falls with speed, grows with the load or builds up over a bristle: the file puts
it on the joint as a force. Dry friction takes in a step what would bring the joint to rest, up to its level: it sticks
without a creep, and it breaks away where that level is saturated.
"""

import re

from harness.model.model import Model, ModelTerm
from harness.model.term import Slot

_HEAD = '''"""Friction of {plain}: {said}.{lacking}

Written by friction-harness; it needs numpy and the engine alone. N m and rad of a hinge, N and m of a slide.

MuJoCo:   friction = attach(model, data)   # once; the joint's own frictionloss and damping are replaced
          friction()                       # every step, before mujoco.mj_step(model, data)
PyBullet: apply(body, joint)               # every step, before pybullet.stepSimulation()
MJX:      data, state = step(model, data, state)  # in place of mjx.step; begin with START; for jit, vmap and scan
"""

import numpy as np

JOINT, ZERO, C, F_K, F_S = {joint!r}, {zero!r}, {c!r}, {f_k!r}, {f_s!r}
START = (True, {z!r}, np.nan)
NAMES = ("abs", "clip", "cos", "exp", "maximum", "pi", "sign", "sin", "where")


def law(xp, state, x, v, t, stop, a):
    """Force on the joint, the load that it holds, and its state (stuck, bristle, x) behind it; xp: numpy or jax.numpy.

    stop: the force that ends the step at rest. a: acceleration without friction.
    """
    abs, clip, cos, exp, maximum, pi, sign, sin, where = (getattr(xp, name) for name in NAMES)
    (stuck, z, before), f_k = state, F_K
    curve = {curve}
    level = maximum(where(stuck, maximum(F_S, curve), curve) * {factors}, 0.0)
    viscous = {viscous}
'''
_DRY = """    return clip(stop, -level, level) - viscous, level, (abs(stop) <= level, z, x)
"""
_BRISTLE = """    level, dx = maximum(level, 1e-30), where(before == before, x - before, 0.0)
    end = sign(dx) * level / {sigma0!r}
    z = end + (z - end) * exp(-abs(dx) * {sigma0!r} / level)
    return -({law}) - viscous, 0.0, (stuck, z, x)
"""
_SMOOTH = """    return -level * ({law}) - viscous, 0.0, (stuck, z, x)
"""
_TAIL = '''

def attach(model, data, joint=JOINT):
    """For MuJoCo: what is to be called before every step; it writes data.qfrc_applied of the joint."""
    import mujoco

    j, state = model.joint(joint).id, START
    at, dof = model.jnt_qposadr[j], model.jnt_dofadr[j]
    model.dof_frictionloss[dof], model.dof_damping[dof] = 0.0, C
    if hasattr(model, "dof_dampingpoly"):  # what grows with the speed besides is among the laws here
        model.dof_dampingpoly[dof] = 0.0
    unit, response = np.zeros((1, model.nv)), np.zeros((1, model.nv))
    unit[0, dof] = 1.0

    def friction():
        nonlocal state
        h, x, v = model.opt.timestep, data.qpos[at] - ZERO, data.qvel[dof]
        data.qfrc_applied[dof] = 0.0
        mujoco.mj_forward(model, data)
        mujoco.mj_solveM(model, data, response, unit)
        m, a = 1.0 / response[0, dof], data.qacc[dof]
        at_end = 0.0 if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4 else h * C
        data.qfrc_applied[dof], _, state = law(np, state, x, v, data.time, -(v * (m + at_end) / h + m * a), a)

    return friction


_KNOWN = {}


def apply(body, joint, client=0):
    """For PyBullet: to be called before every step; dry friction is the joint's velocity motor."""
    import pybullet as p

    key, step = (client, body, joint), p.getPhysicsEngineParameters(physicsClientId=client)["fixedTimeStep"]
    x, v, _, motor = p.getJointState(body, joint, physicsClientId=client)
    if key not in _KNOWN:
        _KNOWN[key] = 0.0, *START[1:], 0.0
        p.changeDynamics(body, joint, jointDamping=C, linearDamping=0, angularDamping=0, physicsClientId=client)
    limit, z, before, t = _KNOWN[key]
    stuck = abs(motor) < limit * (1.0 - 1e-9) or (t == 0.0 and v == 0.0)
    force, limit, (_, z, before) = law(np, (stuck, z, before), x - ZERO, v, t, 0.0, 0.0)
    p.setJointMotorControl2(body, joint, p.VELOCITY_CONTROL, targetVelocity=0, force=limit, physicsClientId=client)
    p.setJointMotorControl2(body, joint, p.TORQUE_CONTROL, force=force, physicsClientId=client)
    _KNOWN[key] = limit, z, before, t + step


def step(model, data, state=START, joint=JOINT):
    """For MJX: data a step on and state; where the model was put with no frictionloss and dampingpoly on the joint."""
    import jax.numpy as jnp
    from mujoco import mjx

    j = mjx.name2id(model, mjx.mujoco.mjtObj.mjOBJ_JOINT, joint)
    at, dof, h = model.jnt_qposadr[j], model.jnt_dofadr[j], model.opt.timestep
    model = model.replace(dof_damping=model.dof_damping.at[dof].set(C))
    free = mjx.forward(model, data.replace(qfrc_applied=data.qfrc_applied.at[dof].set(0.0)))
    m = 1.0 / jnp.linalg.inv(mjx.full_m(model, free))[dof, dof]
    x, v, a = data.qpos[at] - ZERO, data.qvel[dof], free.qacc[dof]
    force, _, state = law(jnp, state, x, v, data.time, -(v * (m + h * C) / h + m * a), a)
    return mjx.step(model, data.replace(qfrc_applied=data.qfrc_applied.at[dof].set(force))), state
'''


def friction_file(model: Model, joint: str, zero: float = 0.0) -> str:
    """The text of friction.py for a model's joint; zero : of its position (rad or m), where the model's x is 0."""
    level = next((_expression(one) for one in model.in_slot(Slot.FRICTION_LEVEL)), "f_k")
    factors = [_expression(one) for one in model.in_slot(Slot.FRICTION_MODULATION) if one.term.in_python]
    more = [_expression(one) for one in _viscous(model)]
    law = next(iter(model.in_slot(Slot.FRICTION_LAW)), None)
    static = model.in_slot(Slot.BREAK_AWAY)
    f_s = static[0].values[0] if static else model.f_s if model.f_s is not None else model.f_k
    body = _DRY
    if law is not None and law.term.internal:
        body = _BRISTLE.format(law=_expression(law), sigma0=law.values[0])
    elif law is not None:
        body = _SMOOTH.format(law=_expression(law))
    spoken = _spoken(model)
    lacking = [one.term.key for one in model.terms if one not in spoken and one.term.slot is not Slot.OBSERVATION]
    said = [f"dry {model.f_k:.4g}, viscous {model.c:.4g}", *(entry.term.key for entry in spoken)]
    start = law.internal0[0] if law is not None and law.term.internal else 0.0
    head = _HEAD.format(
        joint=joint,
        zero=float(zero),
        plain=re.sub(r"[^\w .:/-]", "_", joint),
        said=", ".join(said),
        lacking=f" Not in it: {', '.join(lacking)}." if lacking else "",
        c=model.c,
        f_k=model.f_k,
        f_s=0.0 if law is not None else max(f_s, 0.0),
        curve=level,
        factors=" * ".join(f"({one})" for one in factors) or "1.0",
        viscous=" + ".join(more) or "0.0",
        z=start,
    )
    return head + body + _TAIL


def _spoken(model: Model) -> tuple[ModelTerm, ...]:
    """Terms that the file has."""
    slots = (Slot.FRICTION_LEVEL, Slot.FRICTION_LAW, Slot.FRICTION_MODULATION)
    dry = [one for one in model.in_slot(*slots) if one.term.in_python]
    return (*dry, *model.in_slot(Slot.BREAK_AWAY), *_viscous(model))


def _viscous(model: Model) -> list[ModelTerm]:
    return [one for one in model.in_slot(Slot.SMOOTH) if one.term.in_python]


def _expression(entry: ModelTerm) -> str:
    """The law with its numbers."""
    values = dict(zip(entry.term.names, entry.values, strict=True))
    return re.sub(
        r"\b[A-Za-z_]\w*\b", lambda found: repr(values.get(found[0], found[0])).strip("'"), entry.term.in_python
    )
