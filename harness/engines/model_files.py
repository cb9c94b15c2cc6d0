"""A model of the five slots as MJCF and URDF: what those formats have words for, and a list of what they have not.

MJCF has words for what harness.engines.joint_words lists, and gravity along the axis stands for a push.
URDF has mass, linear damping and a friction it is vague about.
"""

from pathlib import Path
from typing import Any

from lxml import etree

from harness.core.errors import StoreError
from harness.core.slider import Slider
from harness.engines import hinge_files, models
from harness.engines.base import choice
from harness.engines.joint_words import GRAVITY, JOINT, JointWords, Kinds, elements, words_of
from harness.model.model import Model, Restoring
from harness.model.term import Push, Slot

_PUSH: Kinds = frozenset({Push})


def _put_words(tree: Any, words: JointWords) -> None:
    """Add polynomials and zones to the joint of an MJCF tree."""
    joint = tree.find(".//joint[@name='slide']")
    for attribute, more in (("stiffness", words.stiffness), ("damping", words.damping)):
        own = [float(number) for number in joint.get(attribute, "0").split()]
        total = [left + right for left, right in zip([*own, 0.0, 0.0][:3], more, strict=True)]
        joint.set(attribute, " ".join(map(repr, total)))
    for name, zone in words.zones:
        fixed = etree.SubElement(tree.find("tendon"), "fixed", name=name, stiffness=repr(zone.stiffness))
        fixed.set("springlength", f"{zone.low!r} {zone.high!r}")
        etree.SubElement(fixed, "joint", joint="slide", coef="1")


def _put_gravity(tree: Any, acceleration: float) -> None:
    """Tilt gravity along the axis, m/s^2."""
    option = tree.find("option")
    if option is None:
        option = etree.SubElement(tree, "option")
    option.set("gravity", f"{acceleration!r} 0 {-GRAVITY!r}")


def mjcf(model: Model) -> bytes:
    """The model as MJCF with every digit."""
    tree = etree.fromstring(models.exact_mjcf(_slider(model), "slider", model.restoring.value))
    _put_words(tree, words_of((entry for entry in model.terms if elements(entry, model.k, JOINT)), model.k))
    pushes = [e for entry in model.terms for e in elements(entry, model.k, _PUSH) if isinstance(e, Push)]
    push = sum(element.force for element in pushes)
    if push != 0.0:
        _put_gravity(tree, push / model.m)
    if model.in_slot(Slot.FRICTION_LAW):
        tree.find(".//joint[@name='slide']").set("frictionloss", "0")
    text: bytes = etree.tostring(tree, xml_declaration=True, encoding="utf-8")
    return text


def urdf(model: Model) -> bytes:
    """The model as URDF with every digit."""
    text: bytes = etree.tostring(models.urdf(_slider(model), "slider"), xml_declaration=True, encoding="utf-8")
    return text


def _slider(model: Model) -> Slider:
    """The base parameters; a free axis has no stiffness that anybody looks at."""
    return Slider(model.m, model.c, model.k or 1.0, model.f_k, model.f_s)


def turns(model: Model, angular: bool = False) -> bool:
    """Whether a model is that of a hinge: a pendulum always is, others where their recording is of an angle."""
    return angular or model.restoring is Restoring.PENDULUM


def cannot_say(model: Model, suffix: str, angular: bool = False) -> tuple[str, ...]:
    """What a file of this format ("xml" is MJCF, or "urdf") leaves out of the model, one sentence each.

    angular : x is an angle. Raises InputError for another format.
    """
    choice("model format", suffix, ("xml", "urdf"))
    hinge = turns(model, angular)
    if hinge:
        missing = hinge_files.cannot_say(model, suffix)
        missing.append(f"{suffix}: no release (x0 = {model.x0:g} rad, v0 = {model.v0:g} rad/s)")
    else:
        missing = list(models.cannot_say(_slider(model), "slider", suffix, model.restoring.value))
        missing.append(f"{suffix}: no release (x0 = {model.x0:g} m, v0 = {model.v0:g} m/s)")
    for entry in model.terms:
        pushed = not hinge and elements(entry, model.k, _PUSH)
        if suffix == "xml" and (elements(entry, model.k, JOINT) or pushed):
            continue
        values = ", ".join(f"{name} = {value:g}" for name, value in zip(entry.term.names, entry.values, strict=True))
        what = "no sensor that shows" if entry.term.slot is Slot.OBSERVATION else "no"
        missing.append(f"{suffix}: {what} {entry.term.name}" + (f" ({values})" if values else ""))
    if suffix == "urdf" and model.f_k > 0.0:
        unit = "N m" if hinge else "N"
        missing.append(f"urdf: friction = {model.f_k:g} {unit} is written, but readers differ in what they make of it")
    return tuple(missing)


def export(model: Model, into: Path, angular: bool = False) -> dict[str, Path]:
    """Write NAME.xml, NAME.urdf and not_said.txt (what they leave out) to a folder, which is made.

    NAME : "pendulum" for a hinge (``turns``), else "slider". Returns the files by name. Raises StoreError when the
    folder cannot be written.
    """
    said = [line for suffix in ("xml", "urdf") for line in cannot_say(model, suffix, angular)]
    hinge = turns(model, angular)
    name = file_name(model, angular)
    texts = {
        f"{name}.xml": hinge_files.mjcf(model) if hinge else mjcf(model),
        f"{name}.urdf": hinge_files.urdf(model) if hinge else urdf(model),
        "not_said.txt": ("\n".join(said) + "\n").encode(),
    }
    try:
        into.mkdir(parents=True, exist_ok=True)
        return {name: models.write(into / name, text) for name, text in texts.items()}
    except OSError as error:
        raise StoreError(f"{into}: cannot write the models ({error.strerror})") from error


def file_name(model: Model, angular: bool = False) -> str:
    """What a model's files are called, without ending."""
    return hinge_files.NAME if turns(model, angular) else "slider"
