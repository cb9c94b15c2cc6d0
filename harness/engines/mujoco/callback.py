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
from collections.abc import Callable
from typing import Any, cast

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
from harness.engines.base import Function
from harness.engines.samples import UNSATURATED

FIELDS = ("qpos", "qvel", "userdata", "qfrc_passive", "qfrc_constraint", "efc_frictionloss", "iefc_frictionloss")
"""Fields of mjData the callback uses besides ``time``; the last two are the limits of rows of dry friction, in the
order of constraints and in that of islands."""

_I, _F = types.int64, types.float64
_WORD, _DOUBLE = ir.IntType(64), ir.DoubleType()

# state and parameters of a law travel as address and length
LAW = _F(_F, _F, _F, _I, _I, _I, _I)
ADVANCE = types.void(_F, _F, _F, _F, _I, _I, _I, _I)
CALLBACK = types.void(_I, _I)


def _load(typingctx: Any, address: Any) -> Any:
    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.load(builder.inttoptr(args[0], _DOUBLE.as_pointer()))

    return _F(_I), codegen


def _load_address(typingctx: Any, address: Any) -> Any:
    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.load(builder.inttoptr(args[0], _WORD.as_pointer()))

    return _I(_I), codegen


def _store(typingctx: Any, address: Any, value: Any) -> Any:
    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        builder.store(args[1], builder.inttoptr(args[0], _DOUBLE.as_pointer()))
        return context.get_dummy_value()

    return types.void(_I, _F), codegen


def _at(typingctx: Any, address: Any) -> Any:
    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.inttoptr(args[0], _DOUBLE.as_pointer())

    return types.CPointer(_F)(_I), codegen  # type: ignore[no-untyped-call]


def _call(signature: Any, builder: Any, args: Any) -> Any:
    """Call the C function at address args[0] with the rest."""
    llvm = {_F: _DOUBLE, _I: _WORD, types.void: ir.VoidType()}
    shape = ir.FunctionType(llvm[signature.return_type], [llvm[kind] for kind in signature.args[1:]])
    return builder.call(builder.inttoptr(args[0], shape.as_pointer()), args[1:])


def _call_law(typingctx: Any, address: Any, t: Any, x: Any, v: Any, s: Any, n_s: Any, p: Any, n_p: Any) -> Any:
    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return _call(signature, builder, args)

    return _F(_I, *LAW.args), codegen


def _call_advance(
    typingctx: Any, address: Any, t: Any, x: Any, v: Any, dt: Any, s: Any, n_s: Any, p: Any, n_p: Any
) -> Any:
    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        _call(signature, builder, args)
        return context.get_dummy_value()

    return types.void(_I, *ADVANCE.args), codegen


load = cast(Callable[[int], float], intrinsic(_load))
load_address = cast(Callable[[int], int], intrinsic(_load_address))
store = cast(Callable[[int, float], None], intrinsic(_store))
call_law = cast(Callable[..., float], intrinsic(_call_law))
call_advance = cast(Callable[..., None], intrinsic(_call_advance))
_pointer = cast(Callable[[int], Any], intrinsic(_at))
_array = cast(Callable[..., Any], getattr(numba, "carray"))  # noqa: B009  (numba exports it without saying so)

_kept: dict[Function, Any] = {}


def law_address(function: Function) -> int:
    """Address of a law (t, x, v, state, params) -> float as a C function; compiled once a process."""
    if function not in _kept:

        def law(t: float, x: float, v: float, state: int, n_state: int, params: int, n_params: int) -> Any:
            return function(t, x, v, _array(_pointer(state), (n_state,)), _array(_pointer(params), (n_params,)))

        _kept[function] = numba.cfunc(LAW)(law)
    return int(_kept[function].address)


def advance_address(function: Function) -> int:
    """Address of (t, x, v, dt, state, params) -> None as a C function; compiled once a process."""
    if function not in _kept:

        def law(t: float, x: float, v: float, dt: float, state: int, n_state: int, params: int, n_params: int) -> None:
            function(t, x, v, dt, _array(_pointer(state), (n_state,)), _array(_pointer(params), (n_params,)))

        _kept[function] = numba.cfunc(ADVANCE)(law)
    return int(_kept[function].address)


def c_function(function: Callable[[int, int], None]) -> Any:
    """A plain function (model, data) compiled as a callback of MuJoCo, as a ctypes function pointer, cached on disk."""
    return numba.cfunc(CALLBACK, cache=True)(function).ctypes


def _offset(data: Any, pattern: int) -> int:
    """Where in mjData an eight-byte word stands first; the search does not leave the struct when it is there."""
    for start in range(0, 1 << 20, 4096):
        words = np.frombuffer(ctypes.string_at(int(data._address) + start, 4096), dtype=np.uint64)
        hits = np.flatnonzero(words == pattern)
        if hits.size:
            return start + 8 * int(hits[0])
    raise SimulationError(f"mujoco {mujoco.__version__}: the layout of mjData is not understood")


def offsets() -> tuple[int, ...]:
    """Byte offsets in mjData of time and of FIELDS, measured in a throw-away model."""
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

# fmt: off
(
    _CALLS, _STAGES, _DT, _FRAME, _STIFFNESS, _DAMPING, _PENDULUM, _AMPLITUDE, _OMEGA, _PHASE, _CONSTANT,
    _DRIVE_N, _DRIVE_T, _DRIVE_U, _FORCE, _LEVEL, _ADVANCE, _STATE, _STATE_N, _PARAMS, _PARAMS_N,
    _F_K, _RATIO, _STUCK, _LIMIT, _CLIPPED, _METRIC, _HELD, _APPLIED, _LIMITS, _RECORDS, _SETS_LEVEL, _EXCESS,
) = (8 * int(slot) for slot in Slot)
# fmt: on


def _sampled(u: int, t: float) -> float:
    """Value at time t of the driving samples."""
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


def _law(u: int, slot: int, t: float, x: float, v: float) -> float:
    """Value of the law whose address stands in a slot."""
    state, n_state = int(load(u + _STATE)), int(load(u + _STATE_N))
    params, n_params = int(load(u + _PARAMS)), int(load(u + _PARAMS_N))
    return call_law(int(load(u + slot)), t, x, v, state, n_state, params, n_params)


def _advance(u: int, t: float, x: float, v: float) -> None:
    """Move the law's internal states."""
    state, n_state = int(load(u + _STATE)), int(load(u + _STATE_N))
    params, n_params = int(load(u + _PARAMS)), int(load(u + _PARAMS_N))
    call_advance(int(load(u + _ADVANCE)), t, x, v, load(u + _DT), state, n_state, params, n_params)


def _clipped(u: int, q: float, qd: float, others: float, limit: float) -> None:
    """Neutral friction force of this step: what stops the joint at its end, as far as the limit allows."""
    others -= load(u + _STIFFNESS) * q + load(u + _DAMPING) * qd
    held = min(max(-(load(u + _METRIC) * qd + others), -limit), limit)
    store(u + _HELD, held)
    store(u + _STUCK, 1.0 if abs(held) < UNSATURATED * limit else 0.0)


def _record(u: int, step: int, force: float, limit: float) -> None:
    """Keep what acted at the start of a step."""
    if step < int(load(u + _RECORDS)):
        store(int(load(u + _APPLIED)) + 8 * step, force)
        store(int(load(u + _LIMITS)) + 8 * step, limit)


_sampled, _law, _advance = compiled(_sampled), compiled(_law), compiled(_advance)
_clipped, _record = compiled(_clipped), compiled(_record)


def _applied(u: int, t: float, x: float, v: float) -> float:
    """Driving forces and force law, N."""
    force = load(u + _CONSTANT)
    if load(u + _AMPLITUDE) != 0.0:
        force += load(u + _AMPLITUDE) * math.cos(load(u + _OMEGA) * t + load(u + _PHASE))
    if load(u + _DRIVE_N) > 0.0:
        force += _sampled(u, t)
    if load(u + _FORCE) > 0.0:
        force += _law(u, _FORCE, t, x, v)
    return force


def _limit(u: int, t: float, x: float, v: float) -> float:
    """What the friction force can reach, N."""
    level = _law(u, _LEVEL, t, x, v) if load(u + _LEVEL) > 0.0 else load(u + _F_K)
    return level * load(u + _RATIO) + load(u + _EXCESS) if load(u + _STUCK) > 0.0 else level


_applied, _limit = compiled(_applied), compiled(_limit)


@lru_cache(maxsize=1)
def layout() -> tuple[int, ...]:
    """Offsets in mjData; measured once a process."""
    return offsets()


@lru_cache(maxsize=1)
def passive() -> Any:
    """The compiled function as a ctypes function pointer for mujoco.set_mjcb_passive; compiled once a process."""
    # offsets enter as numbers of the closure: the cache on disk tells closures apart
    at_time, at_qpos, at_qvel, at_userdata, at_passive, at_constraint, at_rows, at_island_rows = layout()

    def callback(model: int, data: int) -> None:
        u = load_address(data + at_userdata)
        t = load(data + at_time)
        q, qd = load(load_address(data + at_qpos)), load(load_address(data + at_qvel))
        frame = load(u + _FRAME)
        x, v = q + frame * t, qd + frame
        calls, stages = int(load(u + _CALLS)), int(load(u + _STAGES))
        store(u + _CALLS, calls + 1.0)
        first, sets_level = calls % stages == 0, load(u + _SETS_LEVEL) > 0.0

        if first and sets_level and calls > 0:
            friction = load(load_address(data + at_constraint))
            store(u + _STUCK, 1.0 if abs(friction) < UNSATURATED * load(u + _LIMIT) else 0.0)
        if first and load(u + _ADVANCE) > 0.0:
            _advance(u, t, x, v)
        force, limit = _applied(u, t, x, v), _limit(u, t, x, v)
        store(u + _LIMIT, limit)

        # in the moving frame the spring's end moves backwards
        total = force - frame * (load(u + _STIFFNESS) * t + load(u + _DAMPING))
        if load(u + _PENDULUM) != 0.0:
            total -= load(u + _PENDULUM) * math.sin(x)
        if load(u + _CLIPPED) > 0.0:
            if first:
                _clipped(u, q, qd, total, limit)
            total += load(u + _HELD)
        elif sets_level:
            store(load_address(data + at_rows), limit)
            store(load_address(data + at_island_rows), limit)
        if first:
            _record(u, calls // stages, force, limit)
        target = load_address(data + at_passive)
        store(target, load(target) + total)

    return c_function(callback)
