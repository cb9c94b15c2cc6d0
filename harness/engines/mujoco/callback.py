"""What MuJoCo cannot do by itself, as one compiled function that it calls at every stage of every step.

The function is installed as mjcb_passive. It adds driving forces and a ForceLaw to qfrc_passive, sets the level of
dry friction (break-away above sliding friction, by saturation of the friction force of the step before), and on the
law route computes the clipped friction force itself. What it needs lies in mjData.userdata, laid out by Slot.
"""

import math
from enum import IntEnum
from functools import lru_cache
from typing import Any

from harness.engines.mujoco.native import CALLBACK, call_advance, call_law, load, load_address, offsets, store

import numba  # isort: skip


class Slot(IntEnum):
    """Meaning of the words of userdata; addresses are kept as doubles, exact below 2^53."""

    CALLS = 0  # how often the function was called in this run
    STAGES = 1  # calls a step
    DT = 2
    FRAME = 3  # speed of the frame the joint moves in (a belt's), m/s
    STIFFNESS = 4  # k of the spring the engine knows, for forces that come with the moving frame
    DAMPING = 5
    PENDULUM = 6  # k of -k sin x, else 0
    AMPLITUDE = 7  # of the harmonic force
    OMEGA = 8
    PHASE = 9
    CONSTANT = 10  # constant force
    DRIVE_N = 11
    DRIVE_T = 12
    DRIVE_U = 13
    FORCE = 14  # address of the law's force, 0 for none
    LEVEL = 15
    ADVANCE = 16
    STATE = 17
    STATE_N = 18
    PARAMS = 19
    PARAMS_N = 20
    F_K = 21
    RATIO = 22  # break-away is level x RATIO + EXCESS: f_s/f_k and 0, or 1 and f_s where f_k is 0
    STUCK = 23  # 1 when the friction force of the step before was not saturated
    LIMIT = 24  # limit of the friction force in force
    CLIPPED = 25  # 1 on the law route
    METRIC = 26  # law route: force that stops unit speed in one step, kg/s
    HELD = 27  # law route: friction force of this step
    APPLIED = 28  # address of the record of applied forces, one a step
    LIMITS = 29  # address of the record of limits, one a step
    RECORDS = 30  # length of both
    SETS_LEVEL = 31  # 1 when the joint's friction limit is ours to set
    EXCESS = 32


SLOTS = len(Slot)

UNSATURATED = 1.0 - 1e-6
"""A friction force below this share of its limit is not saturated: the contact sticks."""

(
    _CALLS, _STAGES, _DT, _FRAME, _STIFFNESS, _DAMPING, _PENDULUM, _AMPLITUDE, _OMEGA, _PHASE, _CONSTANT,
    _DRIVE_N, _DRIVE_T, _DRIVE_U, _FORCE, _LEVEL, _ADVANCE, _STATE, _STATE_N, _PARAMS, _PARAMS_N,
    _F_K, _RATIO, _STUCK, _LIMIT, _CLIPPED, _METRIC, _HELD, _APPLIED, _LIMITS, _RECORDS, _SETS_LEVEL, _EXCESS,
) = (8 * int(slot) for slot in Slot)  # fmt: skip


@numba.njit(inline="never")  # type: ignore[untyped-decorator]
def _driven(u: int, t: float) -> float:
    """Value at time t of the samples that userdata points to."""
    n = int(load(u + _DRIVE_N))
    times, values = int(load(u + _DRIVE_T)), int(load(u + _DRIVE_U))
    low, high = 0, n - 1
    if t <= load(times):
        return load(values)
    if t >= load(times + 8 * high):
        return load(values + 8 * high)
    while high - low > 1:
        middle = (low + high) // 2
        if load(times + 8 * middle) <= t:
            low = middle
        else:
            high = middle
    t0, u0 = load(times + 8 * low), load(values + 8 * low)
    return u0 + (load(values + 8 * high) - u0) * (t - t0) / (load(times + 8 * high) - t0)


@lru_cache(maxsize=1)
def passive() -> Any:
    """The compiled function as a ctypes function pointer for mujoco.set_mjcb_passive; compiled once a process."""
    # offsets enter as numbers of the closure: the cache on disk tells closures apart
    at_time, at_qpos, at_qvel, at_userdata, at_passive, at_constraint, at_floss = offsets()

    def callback(model, data):  # type: ignore[no-untyped-def]
        u = load_address(data + at_userdata)
        t = load(data + at_time)
        q = load(load_address(data + at_qpos))
        qd = load(load_address(data + at_qvel))
        x = q + load(u + _FRAME) * t
        v = qd + load(u + _FRAME)
        state, n_state = int(load(u + _STATE)), int(load(u + _STATE_N))
        params, n_params = int(load(u + _PARAMS)), int(load(u + _PARAMS_N))

        calls, stages = int(load(u + _CALLS)), int(load(u + _STAGES))
        store(u + _CALLS, calls + 1.0)
        first = calls % stages == 0
        if first:
            if load(u + _SETS_LEVEL) > 0.0 and calls > 0:
                friction = load(load_address(data + at_constraint))
                store(u + _STUCK, 1.0 if abs(friction) < UNSATURATED * load(u + _LIMIT) else 0.0)
            if load(u + _ADVANCE) > 0.0:
                call_advance(int(load(u + _ADVANCE)), t, x, v, load(u + _DT), state, n_state, params, n_params)

        force = load(u + _CONSTANT)
        if load(u + _AMPLITUDE) != 0.0:
            force += load(u + _AMPLITUDE) * math.cos(load(u + _OMEGA) * t + load(u + _PHASE))
        if load(u + _DRIVE_N) > 0.0:
            force += _driven(u, t)
        if load(u + _FORCE) > 0.0:
            force += call_law(int(load(u + _FORCE)), t, x, v, state, n_state, params, n_params)
        level = load(u + _F_K)
        if load(u + _LEVEL) > 0.0:
            level = call_law(int(load(u + _LEVEL)), t, x, v, state, n_state, params, n_params)
        if load(u + _STUCK) > 0.0:
            level = level * load(u + _RATIO) + load(u + _EXCESS)
        store(u + _LIMIT, level)

        total = force - load(u + _FRAME) * (load(u + _STIFFNESS) * t + load(u + _DAMPING))
        if load(u + _PENDULUM) != 0.0:
            total -= load(u + _PENDULUM) * math.sin(x)
        if load(u + _CLIPPED) > 0.0:
            if first:
                others = total - load(u + _STIFFNESS) * q - load(u + _DAMPING) * qd
                wanted = -(load(u + _METRIC) * qd + others)
                held = min(max(wanted, -level), level)
                store(u + _HELD, held)
                store(u + _STUCK, 1.0 if abs(held) < UNSATURATED * level else 0.0)
            total += load(u + _HELD)
        elif load(u + _SETS_LEVEL) > 0.0:
            rows = load_address(data + at_floss)
            if rows != 0:
                store(rows, level)
        if first:
            step = calls // stages
            if step < int(load(u + _RECORDS)):
                store(int(load(u + _APPLIED)) + 8 * step, force)
                store(int(load(u + _LIMITS)) + 8 * step, level)
        target = load_address(data + at_passive)
        store(target, load(target) + total)

    return numba.cfunc(CALLBACK, cache=True)(callback).ctypes
