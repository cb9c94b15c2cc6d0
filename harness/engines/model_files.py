"""A model of the five slots as MJCF and URDF: what those formats have words for, and a list of what they have not.

MJCF has words for what harness.engines.joint_words lists, and gravity along the axis stands for a push.
URDF has mass, linear damping and a friction it is vague about.

A slider that turns is a hinge under gravity, or with a torsion spring: a pendulum's k sin x is that of mass M at the
distance L from the hinge with M g L = k and M L^2 = m, the inertia, so that L = m g / k. What is left of the inertia
about the mass itself is a millionth.
"""

from pathlib import Path
from typing import Any

from lxml import etree

from harness.core.slider import Slider
from harness.engines import models
from harness.engines.base import choice
from harness.engines.friction_file import friction_file
from harness.engines.joint_words import GRAVITY, JOINT, JointWords, Kinds, elements, words_of
from harness.model.model import Model, Restoring
from harness.model.term import Push, Slot

_PUSH: Kinds = frozenset({Push})
SLIDER, HINGE, ROTOR = "slider", "pendulum", "rotor"
FRICTION = "friction.py"
_OWN = 1e-6
"""Share of the inertia about the mass's own centre."""
_SEEN = 0.2
"""Length that is drawn where no gravity gives one, m."""


def turns(model: Model, angular: bool = False) -> bool:
    """Whether a model is that of a hinge: a pendulum always is, others where their recording is of an angle."""
    return angular or model.restoring is Restoring.PENDULUM


def file_name(model: Model, angular: bool = False) -> str:
    """What a model's files are called, without ending."""
    if not turns(model, angular):
        return SLIDER
    return ROTOR if model.restoring is Restoring.NONE else HINGE


def _words(model: Model) -> JointWords:
    return words_of((entry for entry in model.terms if elements(entry, model.k, JOINT)), model.k)


def _put_zones(tendon: Any, joint: str, words: JointWords) -> None:
    for name, zone in words.zones:
        fixed = etree.SubElement(tendon, "fixed", name=name, stiffness=repr(zone.stiffness))
        fixed.set("springlength", f"{zone.low!r} {zone.high!r}")
        etree.SubElement(fixed, "joint", joint=joint, coef="1")


def _slider(model: Model) -> Slider:
    """The base parameters; a free axis has no stiffness that anybody looks at."""
    return Slider(model.m, model.c, model.k or 1.0, model.f_k, model.f_s)


def mjcf(model: Model) -> bytes:
    """A model that slides as MJCF with every digit."""
    tree = etree.fromstring(models.exact_mjcf(_slider(model), SLIDER, model.restoring.value))
    joint, words = tree.find(".//joint[@name='slide']"), _words(model)
    for attribute, more in (("stiffness", words.stiffness), ("damping", words.damping)):
        own = [float(number) for number in joint.get(attribute, "0").split()]
        joint.set(attribute, " ".join(repr(a + b) for a, b in zip([*own, 0.0, 0.0][:3], more, strict=True)))
    _put_zones(tree.find("tendon"), "slide", words)
    push = sum(e.force for entry in model.terms for e in elements(entry, model.k, _PUSH) if isinstance(e, Push))
    if push != 0.0:
        option = tree.find("option")
        option = etree.SubElement(tree, "option") if option is None else option
        option.set("gravity", f"{push / model.m!r} 0 {-GRAVITY!r}")
    if model.in_slot(Slot.FRICTION_LAW):
        joint.set("frictionloss", "0")
    return models.text_of(tree)


def _hung(model: Model) -> tuple[float, float]:
    """Mass (kg) and its distance from the hinge (m); without gravity any that make up the inertia."""
    inertia = model.m * (1.0 - _OWN)
    distance = inertia * GRAVITY / model.k if model.restoring is Restoring.PENDULUM else _SEEN
    return inertia / distance**2, distance


def _hinge_mjcf(model: Model) -> bytes:
    """A model that turns as MJCF with every digit; loaded and stepped it moves as the model does."""
    tree = etree.parse(str(models.path(HINGE, "xml"))).getroot()
    (mass, distance), words = _hung(model), _words(model)
    joint, inertial = tree.find(".//joint[@name='hinge']"), tree.find(".//inertial")
    spring = model.k if model.restoring is Restoring.SPRING else 0.0
    joint.set("frictionloss", repr(model.f_k))
    for attribute, own, more in (("stiffness", spring, words.stiffness), ("damping", model.c, words.damping)):
        total = [own + more[0], *more[1:]]
        if any(total):
            joint.set(attribute, " ".join(map(repr, total)) if any(total[1:]) else repr(total[0]))
        else:
            joint.attrib.pop(attribute, None)
    if words.zones:
        _put_zones(etree.SubElement(tree, "tendon"), "hinge", words)
    inertial.set("pos", f"0 0 {-distance!r}")
    inertial.set("mass", repr(mass))
    inertial.set("diaginertia", " ".join([repr(_OWN * model.m)] * 3))
    tree.find(".//geom[@name='rod']").set("fromto", f"0 0 0 0 0 {-distance!r}")
    tree.find(".//geom[@name='bob']").set("pos", f"0 0 {-distance!r}")
    if model.restoring is not Restoring.PENDULUM:
        tree.find("option").set("gravity", "0 0 0")
    return models.text_of(tree)


def _hinge_urdf(model: Model) -> bytes:
    """A model that turns as URDF with every digit; under gravity along -z it moves as a pendulum's model does."""
    tree = etree.parse(str(models.path(HINGE, "urdf"))).getroot()
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
    return models.text_of(tree)


def _hinge_lacks(model: Model, suffix: str) -> list[str]:
    """What a hinge's file of this format leaves out, terms and release aside."""
    missing = []
    if model.f_s is not None and model.f_s > model.f_k:
        missing.append(f"{suffix}: no break-away torque above sliding friction (f_s = {model.f_s:g} N m)")
    if model.offset != 0.0:
        missing.append(f"{suffix}: no sensor's zero ({model.offset:g} rad)")
    if suffix == "urdf" and model.restoring is Restoring.SPRING:
        missing.append(f"urdf: no torsion spring (k = {model.k:g} N m/rad), and gravity is to be none")
    if suffix == "urdf" and model.restoring is Restoring.PENDULUM:
        missing.append(f"urdf: gravity is the reader's to set, {GRAVITY:g} m/s^2 along -z")
    return missing


def cannot_say(model: Model, suffix: str, angular: bool = False) -> tuple[str, ...]:
    """What a file of this format ("xml" is MJCF, or "urdf") leaves out of the model, one sentence each.

    angular : x is an angle. Raises InputError for another format.
    """
    choice("model format", suffix, ("xml", "urdf"))
    hinge = turns(model, angular)
    if hinge:
        missing = _hinge_lacks(model, suffix)
    else:
        missing = list(models.cannot_say(_slider(model), SLIDER, suffix, model.restoring.value))
    unit = "rad" if hinge else "m"
    missing.append(f"{suffix}: no release (x0 = {model.x0:g} {unit}, v0 = {model.v0:g} {unit}/s)")
    for entry in model.terms:
        pushed = not hinge and elements(entry, model.k, _PUSH)
        if suffix == "xml" and (elements(entry, model.k, JOINT) or pushed):
            continue
        values = ", ".join(f"{name} = {value:g}" for name, value in zip(entry.term.names, entry.values, strict=True))
        what = "no sensor that shows" if entry.term.slot is Slot.OBSERVATION else "no"
        missing.append(f"{suffix}: {what} {entry.term.name}" + (f" ({values})" if values else ""))
    if suffix == "urdf" and model.f_k > 0.0:
        force = f"{model.f_k:g} {'N m' if hinge else 'N'}"
        missing.append(f"urdf: friction = {force} is written, but readers differ in what they make of it")
    return tuple(missing)


def export(model: Model, into: Path, angular: bool = False) -> dict[str, Path]:
    """Write NAME.xml, NAME.urdf, not_said.txt (what they leave out) and friction.py to a folder, which is made.

    NAME : see ``file_name``. Returns the files by name. Raises StoreError when the folder cannot be written.
    """
    said = [line for suffix in ("xml", "urdf") for line in cannot_say(model, suffix, angular)]
    name, hinge = file_name(model, angular), turns(model, angular)
    texts = {
        f"{name}.xml": _hinge_mjcf(model) if hinge else mjcf(model),
        f"{name}.urdf": _hinge_urdf(model) if hinge else models.text_of(models.urdf(_slider(model), SLIDER)),
        "not_said.txt": ("\n".join(said) + "\n").encode(),
        FRICTION: friction_file(model, "hinge" if hinge else "slide").encode(),
    }
    return models.written(into, texts)
