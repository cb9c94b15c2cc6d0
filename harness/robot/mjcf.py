"""An MJCF as the rigid model needs it: shapes kept only where they make a mass, so that no mesh is missed."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from lxml import etree

from harness.core.bounded import MEBIBYTE, read_bytes
from harness.core.errors import InputError

MOST_COPIES = 1000
"""That replicates of a model may make."""
_MOST_MESH_BYTES = 256 * MEBIBYTE
_NOT_RIGID = ("composite", "flexcomp", "flex", "flexstrain", "plugin", "attach")
_SECTIONS = ("compiler", "option", "default", "asset", "worldbody", "tendon", "equality", "actuator")
_NOT_NEEDED = (
    *("sensor", "contact", "keyframe", "deformable", "visual", "statistic", "custom", "size", "extension"),
    *("light", "camera", "pair", "texture", "material", "hfield", "skin", "model"),
)
_DEFAULTS = ("joint", "geom", "site", "mesh", "equality", "tendon")
_ACTUATORS = (
    *("general", "motor", "position", "velocity", "intvelocity", "orientation", "pid", "damper", "cylinder"),
    *("muscle", "adhesion", "dcmotor"),
)
_BODY = ("body", "frame", "replicate", "inertial", "joint", "freejoint", "geom", "site")
_KEPT: Mapping[str, tuple[str, ...]] = {
    "mujoco": _SECTIONS,
    "compiler": ("lengthrange",),
    "option": ("flag",),
    "default": ("default", *_DEFAULTS, *_ACTUATORS),
    "asset": ("mesh",),
    **dict.fromkeys(("worldbody", "body", "frame", "replicate"), _BODY),
    "tendon": ("spatial", "fixed"),
    "spatial": ("site", "geom", "pulley"),
    "fixed": ("joint",),
    "equality": ("connect", "weld", "joint", "tendon"),
    "actuator": _ACTUATORS,
}
"""By element, what may stand in it: nothing else of a file reaches MuJoCo's compiler."""
_OF_COMPILER = (
    *("angle", "autolimits", "balanceinertia", "boundinertia", "boundmass", "coordinate", "eulerseq", "fitaabb"),
    *("fusestatic", "inertiafromgeom", "inertiagrouprange", "settotalmass", "alignfree"),
)
_OF_LOOKS = ("material", "texture", "hfield")


def bare(file: str, root: Any, folder: Path, fixed: bool) -> tuple[bytes, dict[str, bytes], tuple[str, ...]]:
    """The text that MuJoCo's compiler is given, the meshes that a mass depends on, by name, and what is to be said.

    fixed : free and ball joints are taken out, so that their bodies stand still. Raises InputError for what is no rigid
    body, for what is no MJCF, for more copies than are reasonable, and for a moving body whose mass is that of a mesh
    that is not there.
    """
    _refuse(file, root)
    _keep(file, root)
    held = _fixed(root) if fixed else ()
    from_shapes = any(one.get("inertiafromgeom") == "true" for one in root.findall("compiler"))
    needed: set[str] = set()
    for world in root.findall("worldbody"):
        _without_shapes(world, moving=False, from_shapes=from_shapes, needed=needed)
    meshes, notes = _meshes(file, root, folder, needed)
    for compiler in root.findall("compiler"):
        for name in set(compiler.attrib).difference(_OF_COMPILER):
            compiler.attrib.pop(name)
    text: bytes = etree.tostring(root)
    return text, meshes, (*held, *notes)


def _fixed(root: Any) -> tuple[str, ...]:
    """Take out free and ball joints; one sentence for each that bears joints of its own."""
    notes = []
    for joint in [one for one in root.iter("joint", "freejoint") if one.getparent().tag != "default"]:
        if joint.tag == "freejoint" or joint.get("type") in ("free", "ball"):
            body = joint.getparent()
            body.remove(joint)
            if any(one.tag == "joint" for child in body.iter("body") for one in child):
                name = body.get("name") or "without a name"
                notes.append(f"the body {name} is held: what is told of a joint is as if its base were fixed")
    return tuple(notes)


def _keep(file: str, element: Any) -> None:
    """Leave in an element, downwards, what MuJoCo's compiler is to see."""
    for name in _OF_LOOKS:
        element.attrib.pop(name, None)
    for child in list(element):
        if child.tag in _KEPT.get(element.tag, ()):
            _keep(file, child)
        elif child.tag in _NOT_NEEDED:
            element.remove(child)
        else:
            found = f"<{child.tag}> in <{element.tag}>, which is no MJCF"
            raise InputError(file, found, "a model that MuJoCo compiles is accepted")


def _refuse(file: str, root: Any) -> None:
    for tag in _NOT_RIGID:
        if (found := next(root.iter(tag), None)) is not None:
            name = found.get("name") or found.get("prefix") or ""
            raise InputError(f"{file}: {tag} {name}".strip(), "it is no rigid body", "a chain of bodies is accepted")
    for replicate in root.iter("replicate"):
        copies = 1
        for one in (replicate, *replicate.iterancestors("replicate")):
            count = one.get("count") or "1"
            copies *= int(count) if count.isascii() and count.isdigit() and len(count) < 10 else MOST_COPIES + 1
        if copies > MOST_COPIES:
            raise InputError(f"{file}: replicate", f"{copies} copies", f"at most {MOST_COPIES} are accepted")


def _without_shapes(body: Any, moving: bool, from_shapes: bool, needed: set[str]) -> None:
    """Take out shapes that make no mass, downwards; needed : gets the names of meshes that make one."""
    own = list(_within(body))
    moving = moving or any(child.tag in ("joint", "freejoint") for child in own)
    explicit = any(child.tag == "inertial" for child in own) and not from_shapes
    for child in own:
        if child.tag == "geom" and (
            explicit or not moving or any(_zero(child.get(name, "1")) for name in ("mass", "density"))
        ):
            child.getparent().remove(child)
        elif child.tag == "geom" and child.get("mesh") is not None:
            needed.add(child.get("mesh"))
        elif child.tag == "body":
            _without_shapes(child, moving, from_shapes, needed)


def _within(body: Any) -> Iterator[Any]:
    """Elements of a body, those in frames among them."""
    for child in body:
        yield child
        if child.tag in ("frame", "replicate"):
            yield from _within(child)


def _zero(text: str) -> bool:
    try:
        return float(text) == 0.0
    except ValueError:
        return False


def _meshes(file: str, root: Any, folder: Path, needed: set[str]) -> tuple[dict[str, bytes], tuple[str, ...]]:
    """Content of the meshes that are needed, and those that lie outside of the folder; no other asset is left."""
    found: dict[str, bytes] = {}
    outside = []
    compilers = root.findall("compiler")
    base = next((c.get(n) for n in ("meshdir", "assetdir") for c in compilers if c.get(n) is not None), "")
    for asset in root.findall("asset"):
        for one in list(asset):
            name = one.get("name") or Path(one.get("file") or "").stem
            if name not in needed:
                asset.remove(one)
            elif one.get("file") is not None:
                path = (folder / base / one.get("file")).resolve()
                if not path.is_file():
                    raise InputError(
                        f"{file}: mesh {name}",
                        f"a moving body has the mass of {one.get('file')}, which is not there",
                        "the mesh, or an <inertial> in that body, is accepted",
                    )
                if not path.is_relative_to(folder):
                    outside.append(f"the mesh {name} was read from {path}, outside of the model's folder")
                key = f"{len(found)}{path.suffix}"
                found[key] = read_bytes(path, _MOST_MESH_BYTES)
                one.set("name", name)
                one.set("file", key)
    return found, tuple(outside)
