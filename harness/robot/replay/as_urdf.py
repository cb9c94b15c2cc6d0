"""URDF that PyBullet loads: of a compiled model, and of a user's own file, with one joint's rotor in its link."""

import warnings
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from lxml import etree
from scipy.spatial.transform import Rotation

from harness.core.arrays import FloatArray
from harness.robot.arm import Arm

_SPECK = 1e-9
"""Mass, kg, and inertia, kg m^2, of a link between two joints of one body: PyBullet takes no link without any."""
_NO_TURN = np.array([1.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True, slots=True)
class ForBullet:
    """text : of the URDF. inertia (3,) : principal inertia of the joint's link with the rotor, kg m^2; None as written.

    PyBullet refuses such an inertia in a file (no body has it alone), and takes it by a call.
    """

    text: bytes
    inertia: FloatArray | None = None


def of_file(tree: Any, joint: str, rotor: float) -> ForBullet:
    """A user's URDF, without limits. tree : bare, is changed. rotor : kg m^2."""
    for one in tree.findall("joint"):
        if one.get("type") == "revolute":
            one.set("type", "continuous")
        axis = one.find("axis")
        if axis is not None:
            # PyBullet's constraints take an axis for a unit vector
            own = _numbers(axis, "xyz", "1 0 0")
            axis.set("xyz", _words(own / np.linalg.norm(own)))
    return _finished(tree, joint, rotor)


def of_model(arm: Arm, joint: str, rotor: float) -> ForBullet:
    """The rigid bodies and joints of a model; its joints count from the model's reference. rotor : kg m^2."""
    model = arm.model
    tree = etree.Element("robot", name="model")
    etree.SubElement(tree, "link", name="body0")
    shift = np.zeros((model.nbody, 3))
    for body in range(1, model.nbody):
        parent, first = int(model.body_parentid[body]), int(model.body_jntadr[body])
        place, turn = model.body_pos[body] - shift[parent], np.array(model.body_quat[body])
        last, count = f"body{parent}", int(model.body_jntnum[body])
        for i in range(count):
            # joints of one body turn about points of it, one after the other
            anchor = np.array(model.jnt_pos[first + i])
            place, own = (place + _turn(turn).apply(anchor), turn) if i == 0 else (anchor - shift[body], _NO_TURN)
            link = f"body{body}" if i == count - 1 else f"body{body}joint{i}"
            slides = model.jnt_type[first + i] == mujoco.mjtJoint.mjJNT_SLIDE.value
            kind = "prismatic" if slides else "continuous"
            _joint(tree, arm.joints[first + i], kind, (last, link), place, own, model.jnt_axis[first + i])
            if i < count - 1:
                _link(tree, link, _SPECK, np.zeros(3), _NO_TURN, np.full(3, _SPECK))
            last, shift[body] = link, anchor
        if count == 0:
            _joint(tree, f"fixed{body}", "fixed", (last, f"body{body}"), place, turn, None)
        centre = model.body_ipos[body] - shift[body]
        mass, turn = float(model.body_mass[body]), model.body_iquat[body]
        _link(tree, f"body{body}", mass, centre, turn, model.body_inertia[body])
    return _finished(tree, joint, rotor)


def _joint(
    tree: Any, name: str, kind: str, ends: tuple[str, str], place: FloatArray, turn: FloatArray, axis: Any
) -> None:
    own = etree.SubElement(tree, "joint", name=name, type=kind)
    etree.SubElement(own, "origin", xyz=_words(place), rpy=_rpy(_turn(turn)))
    etree.SubElement(own, "parent", link=ends[0])
    etree.SubElement(own, "child", link=ends[1])
    if axis is not None:
        etree.SubElement(own, "axis", xyz=_words(axis))
    if kind == "prismatic":
        # the lower limit above the upper one is none
        etree.SubElement(own, "limit", lower="1", upper="-1", effort="0", velocity="0")


def _link(tree: Any, name: str, mass: float, centre: FloatArray, turn: Any, inertia: Any) -> None:
    own = etree.SubElement(etree.SubElement(tree, "link", name=name), "inertial")
    etree.SubElement(own, "origin", xyz=_words(centre), rpy=_rpy(_turn(turn)))
    etree.SubElement(own, "mass", value=f"{mass:.17g}")
    names = ("ixx", "iyy", "izz")
    words = {name: f"{float(value):.17g}" for name, value in zip(names, inertia, strict=True)}
    etree.SubElement(own, "inertia", ixy="0", ixz="0", iyz="0", **words)


def _finished(tree: Any, joint: str, rotor: float) -> ForBullet:
    """The text, the joint's rotor in its link where it has one."""
    if rotor == 0.0:
        return ForBullet(etree.tostring(tree))
    own = next(one for one in tree.findall("joint") if one.get("name") == joint)
    axis = _numbers(own.find("axis"), "xyz", "1 0 0")
    axis /= np.linalg.norm(axis)
    child = own.find("child").get("link")
    inertial = next(one for one in tree.findall("link") if one.get("name") == child).find("inertial")
    origin, tensor = inertial.find("origin"), inertial.find("inertia")
    turn = Rotation.from_euler("xyz", _numbers(origin, "rpy", "0 0 0")).as_matrix()
    i = {name: float(tensor.get(name) or 0.0) for name in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")}
    body = np.array([[i["ixx"], i["ixy"], i["ixz"]], [i["ixy"], i["iyy"], i["iyz"]], [i["ixz"], i["iyz"], i["izz"]]])
    principal, axes = np.linalg.eigh(turn @ body @ turn.T + rotor * np.outer(axis, axis))
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    if origin is None:
        origin = etree.SubElement(inertial, "origin", xyz="0 0 0")
    origin.set("rpy", _rpy(Rotation.from_matrix(axes)))
    size = f"{float(principal.max()):.17g}"
    for name in i:
        tensor.set(name, size if name[1] == name[2] else "0")
    return ForBullet(etree.tostring(tree), principal)


def _numbers(element: Any, name: str, default: str) -> FloatArray:
    text = default if element is None else element.get(name) or default
    return np.array([float(word) for word in text.split()])


def _words(values: Any) -> str:
    return " ".join(f"{float(value):.17g}" for value in values)


def _turn(quat: Any) -> Rotation:
    return Rotation.from_quat(np.roll(quat, -1))  # w comes last


def _rpy(turn: Rotation) -> str:
    """Angles about the fixed x, y and z, written."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # where roll and yaw are one, yaw is 0
        return _words(turn.as_euler("xyz"))
