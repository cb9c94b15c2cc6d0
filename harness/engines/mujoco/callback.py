"""What MuJoCo cannot do by itself, as one compiled function that it calls at every stage of every step.

The function is installed as mjcb_passive. It adds driving forces and a ForceLaw to qfrc_passive, sets the level of
dry friction (break-away above sliding friction, by saturation of the friction force of the step before), and on the
law route computes the clipped friction force itself. What it needs lies in mjData.userdata, laid out by Slot.

Machine-level pieces of the callback: loads, stores and calls at an address, and where fields lie in mjData.

Everything a callback of MuJoCo learns is the address of mjData. The offsets of the fields in it are measured in the
library that is loaded, so that no header has to agree with it.
"""

import ctypes
import struct
from collections.abc import Callable, MutableSequence, Sequence
from typing import Any, TypeAlias, cast

import harness.core.jit  # isort: skip  # noqa: F401  (chooses Numba's cache folder before Numba is imported)
import math
from enum import IntEnum
from functools import lru_cache

import mujoco
import numba
import numpy as np
from llvmlite import ir  # type: ignore[import-untyped]
from numba import types
from numba.extending import intrinsic

from harness.core.errors import SimulationError
from harness.core.jit import compiled
from harness.engines.forces import Function
from harness.engines.samples import UNSATURATED

FIELDS = ("qpos", "qvel", "userdata", "qfrc_passive", "qfrc_constraint", "efc_frictionloss", "iefc_frictionloss")
"""Fields of mjData the callback uses besides ``time``; the last two are the limits of rows of dry friction, in the
order of constraints and in that of islands."""

_I, _F = types.int64, types.float64

# state and parameters of a law travel as address and length
LAW = _F(_F, _F, _F, _F, _I, _I, _I, _I)
CALLBACK = types.void(_I, _I)


def _pointer_to(kind: Any) -> Any:
    """An address as a pointer to numbers of this kind."""

    def cast_address(typingctx: Any, address: Any) -> Any:
        def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            return builder.inttoptr(args[0], context.get_value_type(signature.return_type))

        return types.CPointer(kind)(_I), codegen  # type: ignore[no-untyped-call]

    return intrinsic(cast_address)


Numbers: TypeAlias = MutableSequence[float]
doubles = cast(Callable[[int], Numbers], _pointer_to(_F))
addresses = cast(Callable[[int], Sequence[int]], _pointer_to(_I))


def _call(typingctx: Any, address: Any, t: Any, x: Any, v: Any, dt: Any, s: Any, n_s: Any, p: Any, n_p: Any) -> Any:
    """Call the law at an address with the rest."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        llvm = {_F: ir.DoubleType(), _I: ir.IntType(64)}
        shape = ir.FunctionType(llvm[signature.return_type], [llvm[kind] for kind in signature.args[1:]])
        return builder.call(builder.inttoptr(args[0], shape.as_pointer()), args[1:])

    return _F(_I, *LAW.args), codegen


call_law = cast(Callable[..., float], intrinsic(_call))
_array = cast(Callable[..., Any], getattr(numba, "carray"))  # noqa: B009  (numba exports it without saying so)

_kept: dict[Function, Any] = {}


def law_address(function: Function, moves: bool = False) -> int:
    """Address of a law (t, x, v, state, params) -> float as a C function; compiled once a process.

    moves : it is (t, x, v, dt, state, params) -> None instead.
    """
    if function not in _kept:

        def law(t: float, x: float, v: float, dt: float, s: int, n_s: int, p: int, n_p: int) -> Any:
            return function(t, x, v, _array(doubles(s), (n_s,)), _array(doubles(p), (n_p,)))

        def move(t: float, x: float, v: float, dt: float, s: int, n_s: int, p: int, n_p: int) -> float:
            function(t, x, v, dt, _array(doubles(s), (n_s,)), _array(doubles(p), (n_p,)))
            return 0.0

        _kept[function] = numba.cfunc(LAW)(move if moves else law)
    return int(_kept[function].address)


def _offset(data: Any, pattern: int) -> int:
    """Where in mjData an eight-byte word stands first; the search does not leave the struct when it is there."""
    for start in range(0, 1 << 20, 4096):
        words = np.frombuffer(ctypes.string_at(int(data._address) + start, 4096), dtype=np.uint64)
        hits = np.flatnonzero(words == pattern)
        if hits.size:
            return start + 8 * int(hits[0])
    raise SimulationError(f"mujoco {mujoco.__version__}: the layout of mjData is not understood")


@lru_cache(maxsize=1)
def offsets() -> tuple[int, ...]:
    """Byte offsets in mjData of time and of FIELDS, measured in a throw-away model once a process."""
    spec = mujoco.MjSpec()
    spec.nuserdata = 4
    body = spec.worldbody.add_body()
    body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, frictionloss=1.0)
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.1, 0.0, 0.0])
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    data.time = 1.2345678901234567e-89
    word = struct.unpack("Q", struct.pack("d", data.time))[0]
    return (_offset(data, word), *(_offset(data, getattr(data, name).ctypes.data) for name in FIELDS))


def verify(data: Any, where: tuple[int, ...]) -> None:
    """Raise SimulationError unless the words at these offsets of ``data`` are what they are taken for."""
    for name, offset in zip(FIELDS[:5], where[1:6], strict=True):
        word = struct.unpack("Q", ctypes.string_at(int(data._address) + offset, 8))[0]
        if word != getattr(data, name).ctypes.data:
            raise SimulationError(f"mujoco {mujoco.__version__}: {name} is not where it was measured in mjData")


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


@compiled
def _sampled(u: Numbers, t: float) -> float:
    """Value at time t of the driving samples."""
    times, values = doubles(int(u[Slot.DRIVE_T])), doubles(int(u[Slot.DRIVE_U]))
    low, high = 0, int(u[Slot.DRIVE_N]) - 1
    if t <= times[0]:
        return values[0]
    if t >= times[high]:
        return values[high]
    while high - low > 1:
        middle = (low + high) // 2
        if times[middle] <= t:
            low = middle
        else:
            high = middle
    return values[low] + (values[high] - values[low]) * (t - times[low]) / (times[high] - times[low])


@compiled
def _law(u: Numbers, address: float, t: float, x: float, v: float) -> float:
    """Value of the law at an address."""
    state, n_state = int(u[Slot.STATE]), int(u[Slot.STATE_N])
    params, n_params = int(u[Slot.PARAMS]), int(u[Slot.PARAMS_N])
    return call_law(int(address), t, x, v, u[Slot.DT], state, n_state, params, n_params)


@compiled
def _applied(u: Numbers, t: float, x: float, v: float) -> float:
    """Driving forces and force law, N."""
    force = u[Slot.CONSTANT]
    if u[Slot.AMPLITUDE] != 0.0:
        force += u[Slot.AMPLITUDE] * math.cos(u[Slot.OMEGA] * t + u[Slot.PHASE])
    if u[Slot.DRIVE_N] > 0.0:
        force += _sampled(u, t)
    if u[Slot.FORCE] > 0.0:
        force += _law(u, u[Slot.FORCE], t, x, v)
    return force


@compiled
def _limit(u: Numbers, t: float, x: float, v: float) -> float:
    """What the friction force can reach, N."""
    level = _law(u, u[Slot.LEVEL], t, x, v) if u[Slot.LEVEL] > 0.0 else u[Slot.F_K]
    return level * u[Slot.RATIO] + u[Slot.EXCESS] if u[Slot.STUCK] > 0.0 else level


@lru_cache(maxsize=1)
def passive() -> Any:
    """The compiled function as a ctypes function pointer for mujoco.set_mjcb_passive; compiled once a process."""
    # offsets enter as numbers of the closure: the cache on disk tells closures apart
    at_time, at_qpos, at_qvel, at_userdata, at_passive, at_constraint, at_rows, at_island_rows = offsets()

    def callback(model: int, data: int) -> None:
        u = _array(doubles(addresses(data + at_userdata)[0]), (SLOTS,))
        t = doubles(data + at_time)[0]
        q, qd = doubles(addresses(data + at_qpos)[0])[0], doubles(addresses(data + at_qvel)[0])[0]
        frame = u[Slot.FRAME]
        x, v = q + frame * t, qd + frame
        calls, stages = int(u[Slot.CALLS]), int(u[Slot.STAGES])
        u[Slot.CALLS] = calls + 1.0
        first, sets_level = calls % stages == 0, u[Slot.SETS_LEVEL] > 0.0

        if first and sets_level and calls > 0:
            friction = doubles(addresses(data + at_constraint)[0])[0]
            u[Slot.STUCK] = 1.0 if abs(friction) < UNSATURATED * u[Slot.LIMIT] else 0.0
        if first and u[Slot.ADVANCE] > 0.0:
            _law(u, u[Slot.ADVANCE], t, x, v)
        force, limit = _applied(u, t, x, v), _limit(u, t, x, v)
        u[Slot.LIMIT] = limit

        # in the moving frame the spring's end moves backwards
        total = force - frame * (u[Slot.STIFFNESS] * t + u[Slot.DAMPING])
        if u[Slot.PENDULUM] != 0.0:
            total -= u[Slot.PENDULUM] * math.sin(x)
        if u[Slot.CLIPPED] > 0.0:
            if first:
                # what stops the joint at the end of this step, as far as the limit allows
                others = total - (u[Slot.STIFFNESS] * q + u[Slot.DAMPING] * qd)
                held = min(max(-(u[Slot.METRIC] * qd + others), -limit), limit)
                u[Slot.HELD] = held
                u[Slot.STUCK] = 1.0 if abs(held) < UNSATURATED * limit else 0.0
            total += u[Slot.HELD]
        elif sets_level:
            doubles(addresses(data + at_rows)[0])[0] = limit
            doubles(addresses(data + at_island_rows)[0])[0] = limit
        step = calls // stages
        if first and step < int(u[Slot.RECORDS]):
            doubles(int(u[Slot.APPLIED]))[step] = force
            doubles(int(u[Slot.LIMITS]))[step] = limit
        doubles(addresses(data + at_passive)[0])[0] += total

    return numba.cfunc(CALLBACK, cache=True)(callback).ctypes
