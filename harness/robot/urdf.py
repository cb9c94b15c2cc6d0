"""A URDF as the rigid model needs it: what is only looked at or bumped into taken out, so that no mesh is missed."""

from typing import Any

from lxml import etree

from harness.core.errors import InputError

_KNOWN = ("revolute", "continuous", "prismatic", "fixed")
_SEEN = ("visual", "collision")


def bare(file: str, root: Any) -> bytes:
    """The text that MuJoCo's importer is given.

    Raises InputError for joints that are neither hinge nor slide, by name, and for a floating base.
    """
    for joint in root.findall("joint"):
        kind = joint.get("type")
        if kind not in _KNOWN:
            name = joint.get("name")
            raise InputError(f"{file}: joint {name}", f"type {kind!r}", f"{', '.join(_KNOWN)} are accepted")
    for link in root.findall("link"):
        for part in [child for child in link if child.tag in _SEEN]:
            link.remove(part)
    for part in [child for child in root if child.tag not in ("link", "joint", "mujoco")]:
        root.remove(part)
    for part in root.findall("mujoco"):
        for child in [one for one in part if one.tag not in ("compiler", "option")]:
            part.remove(child)
        compiler = part.find("compiler")
        if compiler is not None:
            for name in ("meshdir", "assetdir", "texturedir"):
                compiler.attrib.pop(name, None)
    text: bytes = etree.tostring(root)
    return text


def mimicking(root: Any) -> dict[str, str]:
    """By joint, why it does not move alone: it mimics another or is mimicked."""
    found = {}
    for joint in root.findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None:
            name, leader = str(joint.get("name")), str(mimic.get("joint"))
            found[name] = f"it mimics {leader}"
            found[leader] = f"{name} mimics it"
    return found
