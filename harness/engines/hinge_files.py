"""A slider that turns as MJCF and URDF: a hinge under gravity, or with a torsion spring, each file whole in itself.

A pendulum's k sin x is gravity's: mass M at the distance L from the hinge with M g L = k and M L^2 = m, the inertia, so
that L = m g / k. What is left of the inertia about the mass itself is a millionth.
"""

from typing import Any

from lxml import etree

from harness.engines import models
from harness.engines.joint_words import GRAVITY, JOINT, JointWords, elements, words_of
from harness.model.model import Model, Restoring

NAME = "pendulum"
_OWN = 1e-6
"""Share of the inertia about the mass's own centre."""
_SEEN = 0.2
"""Length that is drawn where no gravity gives one, m."""


def _hung(model: Model) -> tuple[float, float]:
    """Mass (kg) and its distance from the hinge (m); without gravity any that make up the inertia."""
    inertia = model.m * (1.0 - _OWN)
    if model.restoring is not Restoring.PENDULUM:
        return inertia / _SEEN**2, _SEEN
    distance = inertia * GRAVITY / model.k
    return inertia / distance**2, distance


def _tree(suffix: str) -> Any:
    return etree.parse(str(models.path(NAME, suffix))).getroot()


def mjcf(model: Model) -> bytes:
    """The model as MJCF with every digit; loaded and stepped it moves as the model does."""
    tree = _tree("xml")
    mass, distance = _hung(model)
    joint, inertial = tree.find(".//joint[@name='hinge']"), tree.find(".//inertial")
    words = words_of((entry for entry in model.terms if elements(entry, model.k, JOINT)), model.k)
    spring = model.k if model.restoring is Restoring.SPRING else 0.0
    joint.set("frictionloss", repr(model.f_k))
    for attribute, own, more in (("stiffness", spring, words.stiffness), ("damping", model.c, words.damping)):
        total = [own + more[0], *more[1:]]
        if any(total):
            joint.set(attribute, " ".join(map(repr, total)) if any(total[1:]) else repr(total[0]))
        else:
            joint.attrib.pop(attribute, None)
    _put_zones(tree, words)
    inertial.set("pos", f"0 0 {-distance!r}")
    inertial.set("mass", repr(mass))
    inertial.set("diaginertia", " ".join([repr(_OWN * model.m)] * 3))
    tree.find(".//geom[@name='rod']").set("fromto", f"0 0 0 0 0 {-distance!r}")
    tree.find(".//geom[@name='bob']").set("pos", f"0 0 {-distance!r}")
    if model.restoring is not Restoring.PENDULUM:
        tree.find("option").set("gravity", "0 0 0")
    text: bytes = etree.tostring(tree, xml_declaration=True, encoding="utf-8")
    return text


def _put_zones(tree: Any, words: JointWords) -> None:
    if not words.zones:
        return
    tendon = etree.SubElement(tree, "tendon")
    for name, zone in words.zones:
        fixed = etree.SubElement(tendon, "fixed", name=name, stiffness=repr(zone.stiffness))
        fixed.set("springlength", f"{zone.low!r} {zone.high!r}")
        etree.SubElement(fixed, "joint", joint="hinge", coef="1")


def urdf(model: Model) -> bytes:
    """The model as URDF with every digit; under gravity along -z it moves as a pendulum's model does."""
    tree = _tree("urdf")
    mass, distance = _hung(model)
    link = tree.find("link[@name='pendulum']")
    link.find("inertial/mass").set("value", repr(mass))
    for axis in ("ixx", "iyy", "izz"):
        link.find("inertial/inertia").set(axis, repr(_OWN * model.m))
    for origin in (link.find("inertial/origin"), link.find("visual/origin")):
        origin.set("xyz", f"0 0 {-distance!r}")
    dynamics = tree.find("joint[@name='hinge']/dynamics")
    dynamics.set("damping", repr(model.c))
    dynamics.set("friction", repr(model.f_k))
    text: bytes = etree.tostring(tree, xml_declaration=True, encoding="utf-8")
    return text


def cannot_say(model: Model, suffix: str) -> list[str]:
    """What a hinge's file of this format leaves out, one sentence each; terms and release aside."""
    missing = []
    if model.f_s is not None and model.f_s > model.f_k:
        missing.append(f"{suffix}: no break-away torque above sliding friction (f_s = {model.f_s:g} N m)")
    if model.offset != 0.0:
        missing.append(f"{suffix}: no sensor's zero ({model.offset:g} rad)")
    if suffix == "urdf":
        if model.restoring is Restoring.SPRING:
            missing.append(f"urdf: no torsion spring (k = {model.k:g} N m/rad), and gravity is to be none")
        if model.restoring is Restoring.PENDULUM:
            missing.append(f"urdf: gravity is the reader's to set, {GRAVITY:g} m/s^2 along -z")
    return missing
