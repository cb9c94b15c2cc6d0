"""MuJoCo's compiler in a process of its own: a model of unknown origin cannot crash us, hang us, or fill our memory.

What comes back is MuJoCo's own binary form of the compiled model.
"""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import mujoco
import numpy as np

from harness.core.apart import Found, read_apart
from harness.core.bounded import check_file
from harness.core.errors import InputError
from harness.engines.mujoco.presets import warned
from harness.robot.bare import bare_mjcf, bare_urdf, mimicking, with_included
from harness.robot.shapes import with_shapes

HINGE_OR_SLIDE = (mujoco.mjtJoint.mjJNT_HINGE.value, mujoco.mjtJoint.mjJNT_SLIDE.value)
ACCEPTED = "a robot's model, MJCF or URDF, is accepted"
_SECONDS = 60
"""Of a processor, for one model: hulls of large meshes take some."""
_MODEL = "model.mjb"
_WORD = 8
"""Bytes of a number."""

_LEAST_STEP = 1e-6
"""Of a model, s: a swing of twenty seconds takes as many steps as any run may."""


def compiled(
    path: Path, edited: Mapping[Path, str] = MappingProxyType({}), looks: str = "", fixed: bool = False
) -> tuple[Any, dict[str, Any]]:
    """MuJoCo's model of a file, and what is to be said of it: ``alone`` (by joint, why it does not), ``notes``.

    edited : by resolved path, texts that take the place of what a file of the model holds. looks : "meshes" or "bare"
    for a model that is good for its looks only. fixed : free and ball joints are taken out. Raises InputError when
    there is no such file, or MuJoCo cannot compile it (its message in one line).
    """
    check_file(path, accepted=ACCEPTED)
    texts = {str(file): text for file, text in edited.items()}
    columns, about = read_apart(
        f"{__name__}:columns_of", path, ACCEPTED, seconds=_SECONDS, kept=True, edited=texts, looks=looks, fixed=fixed
    )
    data = columns["model"].tobytes()[: about["size"]]
    return mujoco.MjModel.from_binary_path(_MODEL, {_MODEL: data}), about


def columns_of(path: Path, edited: Mapping[str, str], looks: str, fixed: bool) -> Found:
    """The reader: the model's bytes as numbers, and what is to be said."""
    if looks:
        seen, meshes = with_shapes(path, looks == "meshes")
        text, about = seen.encode(), dict[str, Any]()
    else:
        text, meshes, about = prepared(path, {Path(file): text for file, text in edited.items()}, fixed)
    model = compile_text(str(path), text, meshes)
    size = mujoco.mj_sizeModel(model)
    data = np.zeros(-(-size // _WORD) * _WORD, dtype=np.uint8)
    mujoco.mj_saveModel(model, None, data[:size])
    return {"model": data.view(np.float64)}, {**about, "size": size}


def prepared(
    path: Path, edited: Mapping[Path, str], fixed: bool = False
) -> tuple[bytes, dict[str, bytes], dict[str, Any]]:
    """The text that MuJoCo is given, its meshes, and what is to be said of it. Raises InputError."""
    file, root = str(path), with_included(path, edited)[0].root
    if root.tag == "robot":
        alone = mimicking(root)
        return bare_urdf(file, root), {}, {"alone": alone, "notes": []}
    if root.tag == "mujoco":
        text, meshes, notes = bare_mjcf(file, root, path.resolve().parent, fixed)
        return text, meshes, {"alone": {}, "notes": notes}
    raise InputError(file, f"XML that begins with <{root.tag}>", "MJCF (<mujoco>) or URDF (<robot>) is accepted")


def compile_text(file: str, text: bytes, meshes: dict[str, bytes]) -> Any:
    """MuJoCo's model of a text. Raises InputError with MuJoCo's message, and for a NaN, which it only warns of."""
    try:
        with warned() as warnings:
            model = mujoco.MjModel.from_xml_string(text.decode(), meshes)
    except ValueError as error:
        # it numbers the lines of a text that nobody has seen
        said = " ".join(str(error).split())
        raise InputError(file, f"MuJoCo does not compile it ({said})", "a model that it compiles is accepted") from None
    if any("NaN" in one for one in warnings):
        raise InputError(file, "a value that is no number (nan)", "finite numbers are accepted")
    if model.opt.timestep < _LEAST_STEP:
        found = f"a timestep of {model.opt.timestep:.3g} s, with which a second takes for ever"
        raise InputError(file, found, f"at least {_LEAST_STEP:g} s is accepted")
    return model
