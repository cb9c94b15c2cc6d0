"""A URDF as the rigid model needs it: what is only looked at or bumped into taken out, so that no mesh is missed."""

from collections.abc import Mapping
from typing import Any

from lxml import etree

from harness.core.errors import InputError

_KNOWN = ("revolute", "continuous", "prismatic", "fixed")
_KEPT: Mapping[str, tuple[str, ...]] = {
    "robot": ("link", "joint", "mujoco"),
    "link": ("inertial",),
    "inertial": ("origin", "mass", "inertia"),
    "joint": ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "calibration", "safety_controller"),
    "mujoco": ("compiler", "option"),
    "option": ("flag",),
}
"""By element, what may stand in it: nothing else of a file reaches a compiler."""
_OF_COMPILER = ("angle", "autolimits", "balanceinertia", "boundinertia", "boundmass", "eulerseq", "fusestatic")


def bare(file: str, root: Any) -> bytes:
    """The text that MuJoCo's importer is given.

    Raises InputError for joints that are neither hinge nor slide, by name, and for a floating base.
    """
    for joint in root.findall("joint"):
        kind = joint.get("type")
        if kind not in _KNOWN:
            name = joint.get("name")
            raise InputError(f"{file}: joint {name}", f"type {kind!r}", f"{', '.join(_KNOWN)} are accepted")
    _keep(root)
    text: bytes = etree.tostring(root)
    return text


def _keep(element: Any) -> None:
    """Leave in an element, downwards, what the rigid model needs."""
    for child in list(element):
        if child.tag in _KEPT.get(element.tag, ()):
            _keep(child)
        else:
            element.remove(child)
    if element.tag == "compiler":
        for name in set(element.attrib).difference(_OF_COMPILER):
            element.attrib.pop(name)


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
