"""A robot's model with what is seen of it: the text that MuJoCo's compiler is given when the robot is to be drawn."""

import logging
from pathlib import Path
from typing import Any

from lxml import etree

from harness.core.bounded import MEBIBYTE, read_bytes
from harness.core.errors import InputError
from harness.robot.bare import mesh_folder, with_included

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
