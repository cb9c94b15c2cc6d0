"""SDFormat as URDF: links and joints of one model and of those in it, their frames resolved at the pose of the file.

sdformat.org/tutorials, "Pose Frame Semantics"; a joint's axis is in its own frame, in that which it names, or, as
before 1.5, in the model's. What URDF cannot say of a joint (a loop, a spring, two axes) is refused.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from lxml import etree

from harness.core.arrays import FloatArray
from harness.core.errors import InputError

_ACCEPTED = "one model of links, and hinges, slides and fixed joints between them"
_WORLD, _ROOT, _MODEL = "world", "__world__", ("", "__model__")
_KINDS = {
    "revolute": "revolute",
    "continuous": "continuous",
    "prismatic": "prismatic",
    "fixed": "fixed",
    "ball": "floating",
}
_ENDLESS = 1e15
_OWN_AXES = 1.5
"""From this version on a joint's axis is in its own frame."""
_DEEPEST = 100


def as_urdf(file: str, root: Any) -> Any:
    """The tree of a URDF that has the model of an SDF's tree. Raises InputError for what URDF cannot say."""
    outer = [one for one in root.iter("model") if one.getparent().tag != "model"]
    models = [one for one in outer if any(inner.find("joint") is not None for inner in one.iter("model"))]
    if len(models) != 1:
        raise InputError(file, f"{len(models)} models with joints", _ACCEPTED)
    model = models[0]
    if (included := next(model.iter("include"), None)) is not None:
        accepted = f"{_ACCEPTED}; `gz sdf -p {file} > whole.sdf` puts what is included into it"
        raise InputError(file, f"an <include> of {_text(included, 'uri')}", accepted)
    try:
        version = float(root.get("version") or "1.5")
        _join(model, version)
        return _Frames(file, model, version).urdf()
    except ValueError as error:
        raise InputError(file, f"a number that is none ({error})", _ACCEPTED) from None


def _join(model: Any, version: float) -> None:
    """Put what models within a model have into it, each around a frame of that model's name, and named after it."""
    for inner in model.findall("model"):
        _join(inner, version)
        name = inner.get("name") or ""
        frame = etree.SubElement(model, "frame", name=name)
        frame.extend(inner.findall("pose"))
        for part in [one for one in inner if one.tag in _PARTS]:
            old = version < _OWN_AXES or any(_text(a, "use_parent_model_frame") in _TRUE for a in part.findall("axis"))
            for element in part.iter():
                for key in (key for key in _OF_FRAMES if element.get(key)):
                    own = element.get(key)
                    element.set(key, name if own in _MODEL else f"{name}::{own}")
                if element.tag in ("parent", "child") and _text(element, ".") != _WORLD:
                    element.text = f"{name}::{_text(element, '.')}"
                if element.tag == "xyz" and old:
                    element.set("expressed_in", name)
            pose = part.find("pose")
            if part.tag != "joint" and (pose is None or not (pose.get("relative_to") or pose.get("frame"))):
                pose = etree.SubElement(part, "pose") if pose is None else pose
                pose.set("relative_to", part.get("attached_to") or name)
            part.set("name", f"{name}::{part.get('name') or ''}")
            model.append(part)
        model.remove(inner)


_PARTS, _TRUE = ("link", "joint", "frame"), ("true", "1")
_OF_FRAMES = ("relative_to", "frame", "attached_to", "expressed_in", "joint")
"""Attributes that name a frame or joint of their model."""


@dataclass(frozen=True, slots=True)
class _Frames:
    """Of one model: where its links, joints and frames are, as transforms (4, 4) from the model's frame."""

    file: str
    model: Any
    version: float

    def urdf(self) -> Any:
        """The tree."""
        robot = etree.Element("robot", name=self.model.get("name") or "robot")
        etree.SubElement(robot, "link", name=_ROOT)
        place, carried = {_ROOT: np.eye(4)}, set[str]()
        joints = self.model.findall("joint")
        at_model = _transform(self.model.find("pose"))
        for joint in joints:
            name, child = joint.get("name") or "", _text(joint, "child")
            if child in carried:
                found = f"{child} is carried by two joints, which is a loop"
                raise InputError(f"{self.file}: joint {name}", found, f"{_ACCEPTED}; an MJCF may have loops")
            carried.add(child)
            place[child] = at_model @ self._at(joint, 0)
        for link in self.model.findall("link"):
            name = link.get("name") or ""
            own = at_model @ self._at(link, 0)
            place.setdefault(name, own)
            self._link(robot, link, name, np.linalg.inv(place[name]) @ own)
            if name not in carried:
                fixed = _text(self.model, "static", "false") in ("true", "1")
                kind = "fixed" if fixed else "floating"
                self._joint(robot, f"world_to_{name}", kind, _ROOT, name, place[name])
        for joint in joints:
            self._moving(robot, joint, place, at_model)
        return robot

    def _at(self, element: Any, depth: int) -> FloatArray:
        """Where an element is, from the model's frame."""
        pose = element.find("pose")
        of = "" if pose is None else pose.get("relative_to") or pose.get("frame") or ""
        own = _transform(pose)
        if of == "":
            of = _text(element, "child") if element.tag == "joint" else element.get("attached_to") or ""
        if of in _MODEL:
            return own
        return self._named(of, depth) @ own

    def _named(self, name: str, depth: int) -> FloatArray:
        """Where a link, a joint or a frame of this name is."""
        kinds = ("link", "joint", "frame")
        found = next((one for one in self.model if one.tag in kinds and one.get("name") == name), None)
        if found is None or depth > _DEEPEST:
            raise InputError(self.file, f"no frame {name!r}", f"a frame of the model, and {_ACCEPTED}")
        return self._at(found, depth + 1)

    def _link(self, robot: Any, link: Any, name: str, shift: FloatArray) -> None:
        """A link whose frame is its joint's; shift : from there to the link's own."""
        made, own = etree.SubElement(robot, "link", name=name), link.find("inertial")
        if own is not None and own.get("auto") in _TRUE:
            found, accepted = "an inertia that shapes make", f"numbers: gz sdf -p --expand-auto-inertials {self.file}"
            raise InputError(f"{self.file}: link {name}", found, accepted)
        if own is None:  # one kilogramme and one kg m^2, as the format and all that read it have it
            own = etree.Element("inertial")
        inertial = etree.SubElement(made, "inertial")
        _origin(inertial, shift @ _transform(own.find("pose")))
        etree.SubElement(inertial, "mass", value=_text(own, "mass", "1"))
        moments = {n: _text(own, f"inertia/{n}", "1" if n[1] == n[2] else "0") for n in _MOMENTS}
        etree.SubElement(inertial, "inertia", moments)

    def _joint(self, robot: Any, name: str, kind: str, parent: str, child: str, origin: FloatArray) -> Any:
        made = etree.SubElement(robot, "joint", name=name, type=kind)
        etree.SubElement(made, "parent", link=parent)
        etree.SubElement(made, "child", link=child)
        _origin(made, origin)
        return made

    def _moving(self, robot: Any, joint: Any, place: dict[str, FloatArray], at_model: FloatArray) -> None:
        """A joint of the file."""
        name, kind, where = joint.get("name") or "", joint.get("type") or "", f"{self.file}: joint {joint.get('name')}"
        parent, child = _text(joint, "parent"), _text(joint, "child")
        if parent == _WORLD and _WORLD not in place:  # old files have a link of that name
            parent = _ROOT
        if kind not in _KINDS or joint.find("axis2") is not None:
            raise InputError(where, f"the type {kind!r}", _ACCEPTED)
        if parent not in place or child not in place:
            raise InputError(where, f"no link {parent if parent not in place else child!r}", _ACCEPTED)
        axis = joint.find("axis")
        limit = [float(_text(joint, f"axis/limit/{n}", "inf")) for n in ("lower", "upper")]
        kind = "continuous" if kind == "revolute" and not max(map(abs, limit)) < _ENDLESS else kind
        made = self._joint(robot, name, _KINDS[kind], parent, child, np.linalg.inv(place[parent]) @ place[child])
        if axis is None or _KINDS[kind] in ("fixed", "floating"):
            return
        if float(_text(axis, "dynamics/spring_stiffness", "0")) != 0.0:
            raise InputError(where, "a spring", f"{_ACCEPTED}; an MJCF may have springs")
        xyz = np.array([float(one) for one in _text(axis, "xyz", "0 0 1").split()])
        told = axis.find("xyz")
        of = "" if told is None else told.get("expressed_in") or ""
        old = self.version < _OWN_AXES or _text(axis, "use_parent_model_frame", "false") in ("true", "1")
        if of or old:
            frame = at_model if of in _MODEL else at_model @ self._named(of, 0)
            xyz = place[child][:3, :3].T @ frame[:3, :3] @ xyz
        etree.SubElement(made, "axis", xyz=_row(xyz))
        if kind != "continuous":
            effort, speed = (_text(axis, f"limit/{n}", "-1") for n in ("effort", "velocity"))
            bounds = dict(zip(("lower", "upper"), map(repr, limit), strict=True))
            more = {n: v for n, v in (("effort", effort), ("velocity", speed)) if 0.0 <= float(v) < _ENDLESS}
            etree.SubElement(made, "limit", {**bounds, **more})
        dynamics = {n: _text(axis, f"dynamics/{n}", "0") for n in ("damping", "friction")}
        etree.SubElement(made, "dynamics", dynamics)
        mimic = axis.find("mimic")
        if mimic is not None:
            numbers = {n: _text(mimic, n, "0") for n in ("multiplier", "offset")}
            etree.SubElement(made, "mimic", joint=mimic.get("joint") or "", **numbers)


_MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


def _text(element: Any, way: str, default: str = "") -> str:
    return (element.findtext(way) or default).strip()


def _transform(pose: Any) -> FloatArray:
    """Of "x y z roll pitch yaw"; none is where its parent is. Raises ValueError."""
    found = np.eye(4)
    if pose is None or not (pose.text or "").strip():
        return found
    x, y, z, *turn = (float(one) for one in pose.text.split())
    roll, pitch, yaw = np.radians(turn) if pose.get("degrees") in ("true", "1") else turn
    (cr, cp, cy), (sr, sp, sy) = np.cos((roll, pitch, yaw)), np.sin((roll, pitch, yaw))
    found[:3, :3] = (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )
    found[:3, 3] = x, y, z
    return found


def _origin(element: Any, at: FloatArray) -> None:
    turn = at[:3, :3]
    level = float(np.hypot(turn[0, 0], turn[1, 0]))
    pitch = np.arctan2(-turn[2, 0], level)
    if level > 1e-9:
        roll, yaw = np.arctan2(turn[2, 1], turn[2, 2]), np.arctan2(turn[1, 0], turn[0, 0])
    else:  # roll and yaw turn about one axis
        roll, yaw = np.arctan2(-turn[1, 2], turn[1, 1]), 0.0
    etree.SubElement(element, "origin", xyz=_row(at[:3, 3]), rpy=_row(np.array((roll, pitch, yaw))))


def _row(values: FloatArray) -> str:
    return " ".join(repr(float(one)) for one in values)
