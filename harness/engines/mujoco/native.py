"""Machine-level pieces of the callback: loads, stores and calls at an address, and where fields lie in mjData.

Everything a callback of MuJoCo learns is the address of mjData. The offsets of the fields in it are measured in the
library that is loaded, so that no header has to agree with it.
"""

import ctypes
import struct
from collections.abc import Callable
from typing import Any, cast

import harness.core.jit  # isort: skip  # noqa: F401  (chooses Numba's cache folder before Numba is imported)

import mujoco
import numba
import numpy as np
from llvmlite import ir  # type: ignore[import-untyped]
from numba import types
from numba.extending import intrinsic

from harness.core.errors import SimulationError
from harness.engines.law import Function

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
