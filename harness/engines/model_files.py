"""A model of the five slots as MJCF and URDF: what those formats have words for, and a list of what they have not.

MuJoCo's joint has polynomials, stiffness a x + b x^2 + c x^3 and damping a v + b v|v| + c v^3, and a fixed tendon with
two spring lengths is a spring with a dead zone: these stand for non-linear stiffness, quadratic drag, end stops and
backlash. Gravity along the axis stands for a constant force. URDF has mass, linear damping and a friction it is vague
about.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from lxml import etree

from harness.core.errors import StoreError
from harness.core.slider import Slider
from harness.engines import models
from harness.engines.base import choice
from harness.model.model import Model, ModelTerm
from harness.model.term import Slot

_FAR: Final = 1e6
"""m; a tendon's spring length that is never reached."""


def _quadratic(tree: Any, model: Model, entry: ModelTerm) -> None:
    _coefficient(tree, "stiffness", 1, entry.value("k2"))


def _cubic(tree: Any, model: Model, entry: ModelTerm) -> None:
    _coefficient(tree, "stiffness", 2, entry.value("k3"))


def _drag(tree: Any, model: Model, entry: ModelTerm) -> None:
    _coefficient(tree, "damping", 1, entry.value("c2"))


def _stops(tree: Any, model: Model, entry: ModelTerm) -> None:
    gap = entry.value("gap")
    below = -_FAR if entry.term.variant == "positive" else -gap
    above = _FAR if entry.term.variant == "negative" else gap
    _dead_zone(tree, "end_stop", entry.value("k_stop"), below, above)


def _backlash(tree: Any, model: Model, entry: ModelTerm) -> None:
    # the dead zone is the spring's own: the tendon takes its place
    _coefficient(tree, "stiffness", 0, 0.0)
    _dead_zone(tree, "backlash", model.k, -entry.value("gap"), entry.value("gap"))


def _push(tree: Any, model: Model, entry: ModelTerm) -> None:
    option = tree.find("option")
    if option is None:
        option = etree.SubElement(tree, "option")
    option.set("gravity", f"{entry.value('force') / model.m!r} 0 {-models.GRAVITY!r}")


_IN_MJCF: Final[dict[str, Callable[[Any, Model, ModelTerm], None]]] = {
    "quadratic-stiffness": _quadratic,
    "cubic-stiffness": _cubic,
    "quadratic-drag": _drag,
    "end-stop": _stops,
    "backlash": _backlash,
    "constant-force": _push,
}


def _coefficient(tree: Any, attribute: str, power: int, value: float) -> None:
    """Set one coefficient of a polynomial of the joint."""
    joint = tree.find(".//joint[@name='slide']")
    numbers = [*joint.get(attribute, "0").split(), "0", "0"][:3]
    numbers[power] = repr(value)
    joint.set(attribute, " ".join(numbers))


def _dead_zone(tree: Any, name: str, stiffness: float, below: float, above: float) -> None:
    """A spring that acts beyond two places."""
    fixed = etree.SubElement(tree.find("tendon"), "fixed", name=name, stiffness=repr(stiffness))
    fixed.set("springlength", f"{below!r} {above!r}")
    etree.SubElement(fixed, "joint", joint="slide", coef="1")


def mjcf(model: Model) -> bytes:
    """The model as MJCF with every digit."""
    tree = etree.fromstring(models.exact_mjcf(_slider(model), "slider", model.restoring.value))
    for entry in model.terms:
        if _is_in_mjcf(entry, model):
            _IN_MJCF[entry.term.name](tree, model, entry)
    friction = model.find("presliding") or model.find("regularised-friction")
    if friction is not None:
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


def _is_in_mjcf(entry: ModelTerm, model: Model) -> bool:
    # a second term of a kind would overwrite the first
    first = model.find(entry.term.key) is entry
    return first and entry.term.name in _IN_MJCF


def cannot_say(model: Model, suffix: str) -> tuple[str, ...]:
    """What a file of this format ("xml" is MJCF, or "urdf") leaves out of the model, one sentence each.

    Raises InputError for another format.
    """
    choice("model format", suffix, ("xml", "urdf"))
    missing = list(models.cannot_say(_slider(model), "slider", suffix, model.restoring.value))
    missing.append(f"{suffix}: no release (x0 = {model.x0:g} m, v0 = {model.v0:g} m/s)")
    for entry in model.terms:
        if suffix == "xml" and _is_in_mjcf(entry, model):
            continue
        values = ", ".join(f"{name} = {value:g}" for name, value in zip(entry.term.names, entry.values, strict=True))
        what = "no sensor that shows" if entry.term.slot is Slot.OBSERVATION else "no"
        missing.append(f"{suffix}: {what} {entry.term.name}" + (f" ({values})" if values else ""))
    if suffix == "urdf" and model.f_k > 0.0:
        missing.append(f"urdf: friction = {model.f_k:g} N is written, but readers differ in what they make of it")
    return tuple(missing)


def export(model: Model, into: Path) -> dict[str, Path]:
    """Write slider.xml, slider.urdf and not_said.txt (what they leave out) to a folder, which is made.

    Returns the files by name. Raises StoreError when the folder cannot be written.
    """
    said = [line for suffix in ("xml", "urdf") for line in cannot_say(model, suffix)]
    texts = {
        "slider.xml": mjcf(model),
        "slider.urdf": urdf(model),
        "not_said.txt": ("\n".join(said) + "\n").encode(),
    }
    try:
        into.mkdir(parents=True, exist_ok=True)
        return {name: models.write(into / name, text) for name, text in texts.items()}
    except OSError as error:
        raise StoreError(f"{into}: cannot write the models ({error.strerror})") from error
