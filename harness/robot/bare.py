"""A robot's model file as the rigid model needs it: read within bounds, shapes kept only where they make a mass.

No document type, no entities, files of its own folder alone; what is only looked at or bumped into is taken out, so
that no mesh is missed.
"""

import re
from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from lxml import etree

from harness.core.bounded import MEBIBYTE, MODELS, check_file, read_bytes
from harness.core.errors import InputError, did_you_mean
from harness.robot.repair import repaired
from harness.robot.sdf import as_urdf

MOST_BYTES = 16 * MEBIBYTE
"""Of one file: a robot's model is text of some thousand lines."""
MOST_FILES = 50
"""Files that a model may include."""


@dataclass(frozen=True, slots=True)
class Source:
    """A file of a model. path : where it lies. text : as it stands there. root : of its tree, an lxml element.

    macros : whether it is a model only once xacro has expanded it.
    """

    path: Path
    text: str
    root: Any
    macros: bool = False


_VERSION = re.compile(rb"^(<\?xml\s+version=[\"'])0\.0(?=[\"'])")
"""Of a declaration that many URDFs begin with, and that only parsers of robots take."""


def read_xml(path: Path, edited: Mapping[Path, str] = MappingProxyType({})) -> Source:
    """One file; edited : by resolved path, texts that take the place of what a file holds.

    Raises InputError when there is none, it is too large, is no XML, or has a document type, which a model does not
    need and entities would come in by.
    """
    check_file(path, accepted="a robot's model, MJCF or URDF", suffixes=MODELS)
    other = edited.get(path.resolve())
    data = read_bytes(path, MOST_BYTES) if other is None else other.encode()
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
    try:
        tree = etree.fromstring(_VERSION.sub(rb"\g<1>1.0", data), parser).getroottree()
        text = data.decode(tree.docinfo.encoding or "utf-8") if other is None else other
    except (etree.XMLSyntaxError, UnicodeDecodeError, LookupError) as error:
        told = str(error).partition(" (<string>")[0]
        raise InputError(str(path), f"no XML ({told})", "a robot's model, MJCF or URDF") from None
    if tree.docinfo.doctype or tree.docinfo.internalDTD is not None:
        raise InputError(str(path), "a document type, by which entities come in", "a model without one")
    root = tree.getroot()
    return Source(path, text, _plain(root, texts=root.tag == "sdf"), any(map(_macro, root.iter(etree.Element))))


def _macro(element: Any) -> bool:
    """Whether an element is xacro's, or has a value of its; what was expanded may still define properties."""
    if element.prefix is not None:
        return bool(element.prefix == "xacro" and etree.QName(element).localname not in _LEFT_BY_XACRO)
    return any("${" in value for value in element.attrib.values())


_LEFT_BY_XACRO = ("property", "arg")


def with_included(path: Path, edited: Mapping[Path, str] = MappingProxyType({})) -> tuple[Source, ...]:
    """A model's file and those that it includes (MJCF), which are put into the first one's tree; edited : as there.

    An SDF is the URDF that says the same. Raises InputError as ``read_xml`` does, for an included file outside the
    folder of the first, and for one that is included twice.
    """
    first = read_xml(path, edited)
    if first.root.tag == "sdf":
        root = as_urdf(str(path), first.root)
        return (Source(path, etree.tostring(root, pretty_print=True).decode(), root),)
    found = [first]
    folder = path.resolve().parent
    seen = {path.resolve()}
    while (element := next(first.root.iter("include"), None)) is not None:
        name = element.get("file") or ""
        file = (folder / name).resolve()
        where = f"{path}: include {name or 'without a file'}"
        if not file.is_relative_to(folder):
            raise InputError(where, "a file outside the model's folder", "one that lies in it")
        if file in seen or len(found) > MOST_FILES:
            raise InputError(where, "a file included before", f"each once, and at most {MOST_FILES}")
        check_file(file, where)
        source = read_xml(file, edited)
        seen.add(file)
        found.append(source)
        at, parent = element.getparent().index(element), element.getparent()
        parent[at : at + 1] = list(read_xml(file, edited).root)
    return tuple(found)


def _plain(element: Any, texts: bool = False) -> Any:
    """An element as MuJoCo's and PyBullet's parsers see it, which know nothing of name spaces: by the name that stands
    there. What has a prefix, comments and, but for ``texts``, text are nothing to them and are left out.
    """
    values = {name: value for name, value in element.attrib.items() if not name.startswith("{")}
    found = etree.Element(etree.QName(element).localname, values)
    found.text = element.text if texts else None
    found.extend([_plain(child, texts) for child in element.iterchildren(tag=etree.Element) if child.prefix is None])
    return found


_OF_LOOKS = ("material", "texture", "hfield")
_KNOWN, _FREE = ("revolute", "continuous", "prismatic", "fixed"), ("floating", "planar")
_HELD = "the body {} is held: the numbers of a joint are as if its base were fixed"
_URDF: Mapping[str, tuple[str, ...]] = {
    "robot": ("link", "joint", "mujoco"),
    "link": ("inertial",),
    "inertial": ("origin", "mass", "inertia"),
    "joint": ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "calibration", "safety_controller"),
    "mujoco": ("compiler", "option"),
    "option": ("flag",),
}
"""By element, what may stand in it: nothing else of a file reaches a compiler."""
_URDF_COMPILER = ("angle", "autolimits", "balanceinertia", "boundinertia", "boundmass", "eulerseq", "fusestatic")


def _bare_urdf(file: str, root: Any, notes: list[str]) -> None:
    """Leave of a URDF what MuJoCo's importer is to be given. Raises InputError for a joint that URDF has not, and for
    places that are none."""
    held = []
    for part in (*root.findall("link"), *root.findall("joint")):
        _check_places(f"{file}: {part.tag} {part.get('name')}", part)
    links = [link.get("name") or "" for link in root.findall("link")]
    for joint in root.findall("joint"):
        for name in (end.get("link") or "" for end in (*joint.findall("parent"), *joint.findall("child"))):
            if name not in links:
                accepted = f"one of {', '.join(links)}{did_you_mean(name, links)}"
                raise InputError(f"{file}: joint {joint.get('name')}", f"no link {name!r}", accepted)
        kind = joint.get("type")
        if kind in _FREE:
            joint.set("type", "fixed")
            child = joint.find("child")
            held.append("" if child is None else child.get("link") or "")
        elif kind not in _KNOWN:
            found = f"type {kind!r}"
            raise InputError(f"{file}: joint {joint.get('name')}", found, f"{', '.join(_KNOWN + _FREE)}")
    bearing = {parent.get("link") for joint in root.findall("joint") for parent in joint.findall("parent")}
    notes += [_HELD.format(name) for name in held if name in bearing]
    _keep(file, root, _URDF, _URDF_COMPILER)
    notes += repaired(root)


def _check_places(where: str, part: Any) -> None:
    """Raise InputError for a link or joint with places that are no three numbers, or a joint with several axes."""
    for element in (part.find("origin"), part.find("axis"), part.find("inertial/origin")):
        for name in ("xyz", "rpy") if element is not None else ():
            value = element.get(name)
            if value is not None and not _THREE.fullmatch(value):
                raise InputError(where, f'{name}="{value}" in its <{element.tag}>', "three numbers")
    if len(part.findall("axis")) > 1:
        raise InputError(where, "several <axis>", "one")


_THREE = re.compile(r"\s*(?:[-+.\d]\S*\s+){2}[-+.\d]\S*\s*")


def _keep(file: str, element: Any, may: Mapping[str, tuple[str, ...]], compiler: tuple[str, ...]) -> None:
    """Leave in an element, downwards, what may stand in it, and of a compiler's attributes these.

    What no MJCF has is refused there; a URDF may hold anything.
    """
    for name in _OF_LOOKS if element.tag != "compiler" else set(element.attrib).difference(compiler):
        element.attrib.pop(name, None)
    for child in list(element):
        if child.tag in may.get(element.tag, ()):
            _keep(file, child, may, compiler)
        elif may is _URDF or child.tag in _NOT_NEEDED:
            element.remove(child)
        else:
            found = f"<{child.tag}> in <{element.tag}>, which is no MJCF"
            raise InputError(file, found, "a model that MuJoCo compiles")


MOST_COPIES = 1000
"""That replicates of a model may make."""
_MOST_MESH_BYTES = 256 * MEBIBYTE
_NOT_RIGID = ("composite", "flexcomp", "flex", "flexstrain", "plugin")
_SECTIONS = ("compiler", "option", "default", "asset", "worldbody", "tendon", "equality", "actuator")
_NOT_NEEDED = (
    *("sensor", "contact", "keyframe", "deformable", "visual", "statistic", "custom", "size", "extension"),
    *("light", "camera", "pair", "texture", "material", "hfield", "skin"),
)
_DEFAULTS = ("joint", "geom", "site", "mesh", "equality", "tendon")
_ACTUATORS = (
    *("general", "motor", "position", "velocity", "intvelocity", "orientation", "pid", "damper", "cylinder"),
    *("muscle", "adhesion", "dcmotor"),
)
_BODY = ("body", "frame", "replicate", "inertial", "joint", "freejoint", "geom", "site", "attach")
_MJCF: Mapping[str, tuple[str, ...]] = {
    "mujoco": _SECTIONS,
    "compiler": ("lengthrange",),
    "option": ("flag",),
    "default": ("default", *_DEFAULTS, *_ACTUATORS),
    "asset": ("mesh", "model"),
    **dict.fromkeys(("worldbody", "body", "frame", "replicate"), _BODY),
    "tendon": ("spatial", "fixed"),
    "spatial": ("site", "geom", "pulley"),
    "fixed": ("joint",),
    "equality": ("connect", "weld", "joint", "tendon"),
    "actuator": _ACTUATORS,
}
"""By element, what may stand in it: nothing else of a file reaches MuJoCo's compiler."""
_MJCF_SCENE: Mapping[str, tuple[str, ...]] = {
    **_MJCF,
    "mujoco": (*_SECTIONS, "contact", "keyframe"),
    "default": (*_MJCF["default"], "pair"),
    "contact": ("pair", "exclude"),
    "keyframe": ("key",),
}
"""The same where bodies touch: pairs, and the state it begins in."""
_MJCF_COMPILER = (
    *("angle", "autolimits", "balanceinertia", "boundinertia", "boundmass", "coordinate", "eulerseq", "fitaabb"),
    *("fusestatic", "inertiafromgeom", "inertiagrouprange", "settotalmass", "alignfree"),
)


@dataclass(frozen=True, slots=True)
class Bare:
    """root : of the tree that MuJoCo is given. files : those that it then asks for, by name. notes : what is to be said
    of it, one sentence each.
    """

    root: Any
    files: dict[str, bytes]
    notes: list[str]


def bare_model(
    path: Path, edited: Mapping[Path, str] = MappingProxyType({}), fixed: bool = True, touching: bool = False
) -> Bare:
    """A model's file with those that it includes or attaches, as the rigid model needs it.

    edited : as in ``read_xml``. fixed : free and ball joints are taken out, so that their bodies stand still.
    touching : every shape of an MJCF stays, with its pairs and keyframes. Raises
    InputError for what is no rigid body, for what is neither MJCF nor URDF, for more copies than are reasonable, and
    for a moving body whose mass is that of a mesh that is not there.
    """
    source = with_included(path, edited)[0]
    found = Bare(source.root, {}, [])
    if source.macros:
        raise InputError(str(path), "macros of xacro", f"the model that they make: xacro {path.name} > robot.urdf")
    if found.root.tag == "robot":
        _bare_urdf(str(path), found.root, found.notes)
    elif found.root.tag == "mujoco":
        _bare_mjcf(path, found, path.resolve().parent, edited, fixed, touching)
    else:
        said = f"XML that begins with <{found.root.tag}>"
        raise InputError(str(path), said, "MJCF (<mujoco>), URDF (<robot>) or SDF (<sdf>)")
    return found


def _bare_mjcf(
    path: Path, model: Bare, first: Path, edited: Mapping[Path, str], fixed: bool, touching: bool, part: bool = False
) -> None:
    """first : folder of the model that the others are parts of. part : it is attached to another one."""
    file, root, folder = str(path), model.root, path.resolve().parent
    _check(file, root)
    meshes_at = mesh_folder(root)
    _keep(file, root, _MJCF_SCENE if touching else _MJCF, _MJCF_COMPILER)
    if fixed:
        model.notes.extend(_fixed(root))
    from_shapes = any(one.get("inertiafromgeom") == "true" for one in root.findall("compiler"))
    needed = {name for geom in root.iter("geom") if touching and (name := geom.get("mesh")) is not None}
    wound = {geom.get("geom") for geom in root.iterfind("tendon/spatial/geom")}
    for world in root.findall("worldbody") if not touching else ():
        _without_shapes(world, moving=part, from_shapes=from_shapes, needed=needed, wound=wound)
    for one in list(root.iterfind("asset/*")):
        name = one.get("name") or Path(one.get("file") or "").stem
        if one.tag == "model":
            _attached(file, one, model, first, edited, fixed, touching)
        elif name not in needed:
            one.getparent().remove(one)
        elif one.get("file") is not None:
            mesh = (folder / meshes_at / one.get("file")).resolve()
            if not mesh.is_file():
                of = "a shape of the scene is that" if touching else "a moving body has the mass"
                instead = "the mesh" if touching else "the mesh, or an <inertial> in that body,"
                where, found = f"{file}: mesh {name}", f"{of} of {one.get('file')}, which is not there"
                raise InputError(where, found, instead)
            if not mesh.is_relative_to(first):
                model.notes.append(f"the mesh {name} was read from {mesh}, outside of the model's folder")
            one.set("name", name)
            _give(one, model, mesh.suffix, read_bytes(mesh, _MOST_MESH_BYTES))


def _check(file: str, root: Any) -> None:
    """Raise InputError for what is no rigid body, and for more copies than are reasonable."""
    for tag in _NOT_RIGID:
        if (found := next(root.iter(tag), None)) is not None:
            name = found.get("name") or found.get("prefix") or ""
            raise InputError(f"{file}: {tag} {name}".strip(), "it is no rigid body", "a chain of bodies")
    for replicate in root.iter("replicate"):
        copies = 1
        for one in (replicate, *replicate.iterancestors("replicate")):
            count = one.get("count") or "1"
            copies *= int(count) if count.isascii() and count.isdigit() and len(count) < 10 else MOST_COPIES + 1
        if copies > MOST_COPIES:
            raise InputError(f"{file}: replicate", f"{copies} copies", f"at most {MOST_COPIES}")


def _attached(
    file: str, asset: Any, model: Bare, first: Path, edited: Mapping[Path, str], fixed: bool, touching: bool
) -> None:
    """Make ready the model of an asset, whose bodies the first one attaches."""
    name = asset.get("file") or ""
    path = (first / name).resolve()
    where = f"{file}: model {name or 'without a file'}"
    if not path.is_relative_to(first):
        raise InputError(where, "a file outside the model's folder", "one that lies in it")
    if len(model.files) > MOST_FILES:
        raise InputError(where, "too many files", f"at most {MOST_FILES}")
    check_file(path, where)
    part = Bare(with_included(path, edited)[0].root, model.files, model.notes)
    if part.root.tag != "mujoco" or next(part.root.iter("attach", "model"), None) is not None:
        raise InputError(where, "no MJCF, or one that attaches another", "an MJCF that attaches none")
    _bare_mjcf(path, part, first, edited, fixed, touching, part=True)
    _give(asset, model, ".xml", etree.tostring(part.root))


def _give(asset: Any, model: Bare, suffix: str, data: bytes) -> None:
    """Put a file among those that MuJoCo asks for, under a name of ours."""
    key = f"{len(model.files)}{suffix}"
    model.files[key] = data
    asset.set("file", key)


def mesh_folder(root: Any) -> str:
    """Where the meshes of an MJCF lie, from its own folder."""
    compilers = root.findall("compiler")
    return next((c.get(n) for n in ("meshdir", "assetdir") for c in compilers if c.get(n) is not None), "")


def _fixed(root: Any) -> list[str]:
    """Take out free and ball joints; one sentence for each that bears joints of its own."""
    notes, kinds = [], _joint_kinds(root)
    for joint in [one for one in root.iter("joint", "freejoint") if one.getparent().tag != "default"]:
        if joint.tag == "freejoint" or _kind(joint, kinds) in ("free", "ball"):
            body = joint.getparent()
            body.remove(joint)
            if any(one.tag == "joint" for child in body.iter("body") for one in child):
                notes.append(_HELD.format(body.get("name") or "without a name"))
    return notes


def _joint_kinds(root: Any) -> dict[str, str]:
    """Types of joints that defaults give, by their class."""
    found: dict[str, str] = {}

    def gather(default: Any, kind: str) -> None:
        own = default.find("joint")
        kind = kind if own is None else own.get("type") or kind
        found[default.get("class") or _MAIN] = kind
        for inner in default.findall("default"):
            gather(inner, kind)

    for default in root.findall("default"):
        gather(default, found.get(_MAIN, "hinge"))
    return found


def _kind(joint: Any, kinds: Mapping[str, str]) -> str:
    """The type of a joint: its own, or that of its class, which a body around it may give."""
    around = (body.get("childclass") for body in joint.iterancestors())
    of = joint.get("class") or next((name for name in around if name), _MAIN)
    return joint.get("type") or kinds.get(of, "hinge")


_MAIN = "main"
"""The class of what names none."""


def _without_shapes(body: Any, moving: bool, from_shapes: bool, needed: set[str], wound: Container[str | None]) -> None:
    """Take out shapes that make no mass, downwards; needed : gets the names of meshes that make one. wound : names of
    shapes that tendons are wound around, which stay.
    """
    own = list(_within(body))
    moving = moving or any(child.tag in ("joint", "freejoint") for child in own)
    explicit = any(child.tag == "inertial" for child in own) and not from_shapes
    for child in own:
        if child.tag == "geom" and child.get("name") in wound:
            continue
        if child.tag == "geom" and (
            explicit or not moving or any(_zero(child.get(name, "1")) for name in ("mass", "density"))
        ):
            child.getparent().remove(child)
        elif child.tag == "geom" and child.get("mesh") is not None:
            needed.add(child.get("mesh"))
        elif child.tag == "body":
            _without_shapes(child, moving, from_shapes, needed, wound)


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
