"""Machine-level pieces of the callback: loads, stores and calls at an address, and where fields lie in mjData.

Everything a callback of MuJoCo learns is the address of mjData. The offsets of the fields in it are measured in the
library that is loaded, so that no header has to agree with it.
"""

import ctypes
import struct
from typing import Any

import harness.core.jit  # isort: skip  # noqa: F401  (sets Numba's cache folder before Numba is imported)

import mujoco
import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from harness.core.errors import SimulationError
from harness.engines.law import Function

FIELDS = ("qpos", "qvel", "userdata", "qfrc_passive", "qfrc_constraint")
"""Fields of mjData the callback uses besides ``time`` and ``efc_frictionloss``."""

_DOUBLES = types.CPointer(types.float64)
LAW = types.float64(types.float64, types.float64, types.float64, _DOUBLES, types.int64, _DOUBLES, types.int64)
ADVANCE = types.void(
    types.float64, types.float64, types.float64, types.float64, _DOUBLES, types.int64, _DOUBLES, types.int64
)
CALLBACK = types.void(types.int64, types.int64)


@intrinsic
def load(typingctx: Any, address: Any) -> Any:
    """The double at an address."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.load(builder.inttoptr(args[0], ir.DoubleType().as_pointer()))

    return types.float64(types.int64), codegen


@intrinsic
def load_address(typingctx: Any, address: Any) -> Any:
    """The pointer, as an integer, at an address."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.load(builder.inttoptr(args[0], ir.IntType(64).as_pointer()))

    return types.int64(types.int64), codegen


@intrinsic
def store(typingctx: Any, address: Any, value: Any) -> Any:
    """Write a double at an address."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        builder.store(args[1], builder.inttoptr(args[0], ir.DoubleType().as_pointer()))
        return context.get_dummy_value()

    return types.void(types.int64, types.float64), codegen


def _call(context: Any, builder: Any, numbers: list[Any], vectors: list[Any], address: Any, result: Any) -> Any:
    double, whole = ir.DoubleType(), ir.IntType(64)
    pointer = double.as_pointer()
    shape = ir.FunctionType(result, [double] * len(numbers) + [pointer, whole, pointer, whole])
    function = builder.inttoptr(address, shape.as_pointer())
    state, n_state, params, n_params = vectors
    arguments = [*numbers, builder.inttoptr(state, pointer), n_state, builder.inttoptr(params, pointer), n_params]
    return builder.call(function, arguments)


@intrinsic
def call_law(
    typingctx: Any, address: Any, t: Any, x: Any, v: Any, state: Any, n_state: Any, params: Any, n_params: Any
) -> Any:
    """Call a C function of signature LAW at an address."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return _call(context, builder, list(args[1:4]), list(args[4:]), args[0], ir.DoubleType())

    i, f = types.int64, types.float64
    return f(i, f, f, f, i, i, i, i), codegen


@intrinsic
def call_advance(
    typingctx: Any, address: Any, t: Any, x: Any, v: Any, dt: Any, state: Any, n_state: Any, params: Any, n_params: Any
) -> Any:
    """Call a C function of signature ADVANCE at an address."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        _call(context, builder, list(args[1:5]), list(args[5:]), args[0], ir.VoidType())
        return context.get_dummy_value()

    i, f = types.int64, types.float64
    return types.void(i, f, f, f, f, i, i, i, i), codegen


_kept: dict[Function, Any] = {}


def law_address(function: Function) -> int:
    """Address of a law (t, x, v, state, params) -> float as a C function; compiled once a process."""
    if function not in _kept:

        @numba.cfunc(LAW)
        def wrapped(t, x, v, state, n_state, params, n_params):  # type: ignore[no-untyped-def]
            return function(t, x, v, numba.carray(state, (n_state,)), numba.carray(params, (n_params,)))

        _kept[function] = wrapped
    return int(_kept[function].address)


def advance_address(function: Function) -> int:
    """Address of (t, x, v, dt, state, params) -> None as a C function; compiled once a process."""
    if function not in _kept:

        @numba.cfunc(ADVANCE)
        def wrapped(t, x, v, dt, state, n_state, params, n_params):  # type: ignore[no-untyped-def]
            function(t, x, v, dt, numba.carray(state, (n_state,)), numba.carray(params, (n_params,)))

        _kept[function] = wrapped
    return int(_kept[function].address)


def _find(pattern: int, address: int) -> int:
    """Offset of an eight-byte word behind an address; it must be there, the search does not leave the struct."""
    for start in range(0, 1 << 20, 4096):
        words = np.frombuffer(ctypes.string_at(address + start, 4096), dtype=np.uint64)
        hits = np.flatnonzero(words == pattern)
        if hits.size:
            return start + 8 * int(hits[0])
    raise SimulationError(f"mujoco {mujoco.__version__}: the layout of mjData is not understood")


def offsets() -> tuple[int, ...]:
    """Byte offsets in mjData of time, of FIELDS, and of efc_frictionloss, measured in a throw-away model."""
    spec = mujoco.MjSpec()
    spec.nuserdata = 4
    body = spec.worldbody.add_body()
    body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, frictionloss=1.0)
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.1, 0.0, 0.0])
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    base = int(data._address)
    data.time = 1.2345678901234567e-89
    found = [_find(struct.unpack("Q", struct.pack("d", data.time))[0], base)]
    found += [_find(getattr(data, name).ctypes.data, base) for name in (*FIELDS, "efc_frictionloss")]
    return tuple(found)
