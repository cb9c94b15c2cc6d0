"""MuJoCo's compiler in a process of its own: a model of unknown origin cannot crash us, hang us, or fill our memory.

What comes back is MuJoCo's own binary form of the compiled model, for its torques or to be looked at.
"""

import logging
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import mujoco
import numpy as np
from lxml import etree

from harness.core.apart import Found, read_apart
from harness.core.bounded import MEBIBYTE, MODELS, check_file, read_bytes
from harness.core.errors import InputError
from harness.engines.mujoco.presets import warned
from harness.robot.bare import bare_model, mesh_folder, with_included
from harness.robot.repair import listed

LOGGER = logging.getLogger(__name__)
_MOST_MESH_BYTES = 64 * MEBIBYTE
_READABLE = (".stl", ".obj", ".msh")
_LEFT_OUT = ("sensor", "contact", "keyframe", "deformable", "statistic", "custom", "actuator", "tendon", "equality")
_NO_SHAPE = ("hfield", "sdf", "plane")
_UP = 4
"""Folders above the model's in which a package's meshes are looked for."""


def with_shapes(path: Path, meshes: bool) -> tuple[str, dict[str, bytes]]:
    """Text and meshes, by name, of a model that is good for its looks and its joints, and for no torque.

    meshes : those that are found are kept. Raises InputError as ``read_xml`` does.
    """
    root = with_included(path)[0].root
    folder = path.resolve().parent
    found = _urdf(root, folder, meshes) if root.tag == "robot" else _mjcf(root, folder, meshes)
    return etree.tostring(root).decode(), found


def _mjcf(root: Any, folder: Path, meshes: bool) -> dict[str, bytes]:
    for part in [child for child in root if child.tag in _LEFT_OUT]:
        root.remove(part)
    base = mesh_folder(root)
    for compiler in root.findall("compiler"):
        for name in ("meshdir", "texturedir", "assetdir", "inertiafromgeom"):
            compiler.attrib.pop(name, None)
    found: dict[str, bytes] = {}
    there = set()
    for asset in root.findall("asset"):
        for one in list(asset):
            if one.tag == "mesh" and meshes and _kept(one, "file", [folder / base], found):
                there.add(one.get("name"))
            elif one.tag != "material":
                asset.remove(one)
    for material in root.iter("material"):
        material.attrib.pop("texture", None)
    for geom in list(root.iter("geom")):
        missing = geom.get("mesh") is not None and geom.get("mesh") not in there
        if (missing or geom.get("type") in _NO_SHAPE) and geom.getparent().tag != "default":
            geom.getparent().remove(geom)
    for body in root.iter("body"):
        if body.find("inertial") is None:
            etree.SubElement(body, "inertial", pos="0 0 0", mass="1", diaginertia="1 1 1")
    return found


def _urdf(root: Any, folder: Path, meshes: bool) -> dict[str, bytes]:
    found: dict[str, bytes] = {}
    places = [folder, *list(folder.parents)[:_UP]]
    for link in root.findall("link"):
        for kind in ("visual", "collision"):
            for part in link.findall(kind):
                mesh = part.find("geometry/mesh")
                if mesh is not None and not (meshes and _kept(mesh, "filename", places, found)):
                    link.remove(part)
        if link.find("visual") is not None:
            for part in link.findall("collision"):
                link.remove(part)
        if link.find("inertial") is None:
            inertial = etree.SubElement(link, "inertial")
            etree.SubElement(inertial, "mass", value="1")
            etree.SubElement(inertial, "inertia", ixx="1", iyy="1", izz="1", ixy="0", ixz="0", iyz="0")
    for part in [child for child in root if child.tag not in ("link", "joint", "material")]:
        root.remove(part)
    own = etree.SubElement(root, "mujoco")
    etree.SubElement(own, "compiler", discardvisual="false", fusestatic="false", balanceinertia="true")
    return found


def _kept(mesh: Any, attribute: str, places: list[Path], found: dict[str, bytes]) -> bool:
    """Put a mesh's bytes among those found, under a name of ours; whether there is one that MuJoCo reads."""
    name = mesh.get(attribute) or ""
    words = [word for word in name.partition("://")[2].split("/") if word] if "://" in name else [name]
    if not name.lower().endswith(_READABLE) or ".." in words:
        return False
    for start in range(len(words)):
        for place in places:
            path = place.joinpath(*words[start:])
            if path.is_file():
                try:
                    data = read_bytes(path, _MOST_MESH_BYTES)
                except InputError:
                    return False
                LOGGER.info("the mesh %s was read from %s", name, path.resolve())
                key = f"{len(found)}{path.suffix.lower()}"
                found[key] = data
                if mesh.get("name") is None and attribute == "file":
                    mesh.set("name", path.stem)
                mesh.set(attribute, key)
                return True
    return False


HINGE_OR_SLIDE = (mujoco.mjtJoint.mjJNT_HINGE.value, mujoco.mjtJoint.mjJNT_SLIDE.value)
ACCEPTED = "a robot's model, MJCF or URDF"
_SECONDS = 60
"""Of a processor, for one model: hulls of large meshes take some."""
_MODEL = "model.mjb"
_WORD = 8
"""Bytes of a number."""

_LEAST_STEP = 1e-6
"""Of a model, s: a swing of twenty seconds takes as many steps as any run may."""


def compiled(path: Path, edited: Mapping[Path, str] = MappingProxyType({}), looks: str = "") -> tuple[Any, list[str]]:
    """MuJoCo's model of a file without free and ball joints, and what is to be said of it, one sentence each.

    edited : by resolved path, texts that take the place of what a file of the model holds. looks : "meshes" or "bare"
    for a model that is good for its looks only, which keeps them. Raises InputError when there is no such file, or
    MuJoCo cannot compile it (its message in one line).
    """
    check_file(path, accepted=ACCEPTED, suffixes=MODELS)
    texts = {str(file): text for file, text in edited.items()}
    columns, about = read_apart(
        f"{__name__}:columns_of", path, ACCEPTED, seconds=_SECONDS, kept=True, edited=texts, looks=looks
    )
    data = columns["model"].tobytes()[: about["size"]]
    return mujoco.MjModel.from_binary_path(_MODEL, {_MODEL: data}), about["notes"]


def columns_of(path: Path, edited: Mapping[str, str], looks: str) -> Found:
    """The reader: the model's bytes as numbers, and what is to be said."""
    notes = list[str]()
    if looks:
        seen, files = with_shapes(path, looks == "meshes")
        model = compile_text(str(path), seen.encode(), files)
    else:
        model, notes = prepared(path, {Path(file): text for file, text in edited.items()})
    size = mujoco.mj_sizeModel(model)
    data = np.zeros(-(-size // _WORD) * _WORD, dtype=np.uint8)
    mujoco.mj_saveModel(model, None, data[:size])
    return {"model": data.view(np.float64)}, {"notes": notes, "size": size}


def prepared(
    path: Path, edited: Mapping[Path, str], fixed: bool = True, touching: bool = False
) -> tuple[Any, list[str]]:
    """MuJoCo's model of a file as far as it is a rigid one, and what is to be said of it, one sentence each.

    fixed : without free and ball joints. touching : with every shape, pair and keyframe. Bodies without a mass that
    move get the least that can be. Raises InputError.
    """
    file = str(path)
    bare = bare_model(path, edited, fixed, touching)
    try:
        return compile_text(file, etree.tostring(bare.root), bare.files), bare.notes
    except InputError as refused:
        if not any(word in str(refused) for word in _INERTIAS):
            raise
    urdf = bare.root.tag == "robot"
    holder = bare.root.find("mujoco") if urdf else bare.root
    holder = etree.SubElement(bare.root, "mujoco") if holder is None else holder
    etree.SubElement(holder, "compiler", balanceinertia="true", **_BOUNDS)
    model = compile_text(file, etree.tostring(bare.root), bare.files)
    light = [i for i in range(1, model.nbody) if model.body_dofnum[i] and model.body_mass[i] <= _LIGHTEST]
    if light:
        names = [model.body(i).name or "without a name" for i in light]
        said = "moves without a mass of its own, and counts" if len(names) == 1 else _SAID_OF_MANY
        bare.notes.append(f"{listed(names)} {said} as {_LIGHTEST:g} kg")
    return model, bare.notes


_INERTIAS = ("mjMINVAL", "inertia must")
"""In MuJoCo's words for bodies that cannot be."""
_SAID_OF_MANY = "move without a mass of their own, and count"
_LIGHTEST = 1e-9
"""kg: not to be felt beside a robot's grams, and with a reach of 3 cm enough to divide by."""
_BOUNDS = {"boundmass": f"{_LIGHTEST:g}", "boundinertia": "1e-12"}


def compile_text(file: str, text: bytes, meshes: dict[str, bytes]) -> Any:
    """MuJoCo's model of a text. Raises InputError with MuJoCo's message, and for a NaN, which it only warns of."""
    try:
        with warned() as warnings:
            model = mujoco.MjModel.from_xml_string(text.decode(), meshes)
    except ValueError as error:
        # it numbers the lines of a text that nobody has seen
        said = " ".join(str(error).split())
        raise InputError(file, f"MuJoCo does not compile it ({said})", "a model that it compiles") from None
    if any("NaN" in one for one in warnings):
        raise InputError(file, "a value that is no number (nan)", "finite numbers")
    if model.opt.timestep < _LEAST_STEP:
        found = f"a timestep of {model.opt.timestep:.3g} s, with which a second takes for ever"
        raise InputError(file, found, f"at least {_LEAST_STEP:g} s")
    return model
