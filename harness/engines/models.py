"""The models of models/: where they are, and how a Slider's numbers get into them."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lxml import etree

from harness.core.errors import StoreError
from harness.core.slider import Slider
from harness.core.writing import replacing
from harness.engines.base import Restoring, choice
from harness.engines.joint_words import coefficient

if TYPE_CHECKING:
    import mujoco

NAMES = ("slider", "slider_on_floor")
"""Joint friction, and a box on a floor with contact friction."""
FILES = (*NAMES, "pendulum")
"""And a hinge under gravity (harness.engines.model_files)."""


def folder() -> Path:
    """The folder of the models: harness/_models in an installed wheel, models/ at the top of a checkout.

    Raises StoreError when neither is there.
    """
    package = Path(__file__).resolve().parents[1]
    for candidate in (package / "_models", package.parent / "models"):
        if (candidate / "slider.xml").is_file():
            return candidate
    raise StoreError(f"models: not found beside {package}; install the package again")


def path(name: str, suffix: str) -> Path:
    """The file of a model; name is one of FILES, suffix "xml" (MJCF) or "urdf". Raises InputError for others."""
    choice("model", name, FILES)
    choice("model format", suffix, ("xml", "urdf"))
    return folder() / f"{name}.{suffix}"


def mjcf(slider: Slider, name: str = "slider", restoring: Restoring = "spring") -> "mujoco.MjSpec":
    """A model as MjSpec with the numbers of ``slider``; a pendulum's k sin x is no attribute and is left out."""
    import mujoco

    spec = mujoco.MjSpec.from_file(str(path(name, "xml")))
    slide = spec.joint("slide")
    stiffness, damping = slider.k if restoring == "spring" else 0.0, slider.c
    words = polynomial(slide)
    slide.stiffness = [stiffness, 0.0, 0.0] if words else stiffness
    slide.damping = [damping, 0.0, 0.0] if words else damping
    box = spec.geom("box")
    box.mass = slider.m
    if name == "slider":
        slide.frictionloss = slider.f_k
    else:
        # MuJoCo takes the larger of the two coefficients
        box.friction[0] = spec.geom("floor").friction[0] = coefficient(slider)
    return spec


def polynomial(joint: Any) -> bool:
    """Whether this MuJoCo takes a joint's stiffness and damping as polynomials; older ones take one number each."""
    return not isinstance(joint.stiffness, float)


def urdf(slider: Slider, name: str = "slider") -> Any:
    """A model as an lxml tree with the numbers of ``slider``; URDF has no word for a spring."""
    tree = etree.parse(str(path(name, "urdf")))
    inertial = tree.find("link[@name='slider']/inertial")
    mass, inertia = inertial.find("mass"), inertial.find("inertia")
    scale = slider.m / float(mass.get("value"))
    mass.set("value", repr(slider.m))
    for axis in ("ixx", "iyy", "izz"):
        inertia.set(axis, repr(float(inertia.get(axis)) * scale))
    dynamics = tree.find("joint[@name='slide']/dynamics")
    dynamics.set("damping", repr(slider.c))
    dynamics.set("friction", repr(slider.f_k if name == "slider" else 0.0))
    return tree


def export(slider: Slider, into: Path, restoring: Restoring = "spring") -> dict[str, Path]:
    """Write all four models with the numbers of ``slider`` to a folder, which is made; nothing half-written is left.

    Returns the files by name ("slider.xml", ...). Raises StoreError when the folder cannot be written.
    """
    texts = {}
    for name in NAMES:
        texts[f"{name}.xml"] = exact_mjcf(slider, name, restoring)
        texts[f"{name}.urdf"] = text_of(urdf(slider, name))
    return written(into, texts)


def text_of(tree: Any) -> bytes:
    text: bytes = etree.tostring(tree, xml_declaration=True, encoding="utf-8")
    return text


def written(into: Path, texts: Mapping[str, bytes]) -> dict[str, Path]:
    """Write files by name to a folder, which is made, each whole or not at all; raises StoreError."""
    try:
        into.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            with replacing(into / name) as part:
                part.write_bytes(text)
    except OSError as error:
        raise StoreError(f"{into}: cannot write the models ({error.strerror})") from error
    return {name: into / name for name in texts}


def exact_mjcf(slider: Slider, name: str, restoring: Restoring) -> bytes:
    """MJCF text with every digit; MuJoCo's own writer keeps six."""
    spec = mjcf(slider, name, restoring)
    tree = etree.fromstring(spec.to_xml().encode())
    joint, box = tree.find(".//joint[@name='slide']"), tree.find(".//geom[@name='box']")
    joint.set("stiffness", repr(float(spec.joint("slide").stiffness[0])))
    joint.set("damping", repr(slider.c))
    box.set("mass", repr(slider.m))
    if name == "slider":
        joint.set("frictionloss", repr(slider.f_k))
    else:
        for geom in (box, tree.find(".//geom[@name='floor']")):
            geom.set("friction", f"{coefficient(slider)!r} 0 0")
    return text_of(tree)


def cannot_say(slider: Slider, name: str, suffix: str, restoring: Restoring = "spring") -> tuple[str, ...]:
    """What a model file of this format leaves out of ``slider``, one sentence each."""
    choice("model", name, NAMES)
    choice("model format", suffix, ("xml", "urdf"))
    missing = []
    if slider.break_away > slider.f_k:
        missing.append(f"{suffix}: no break-away force above sliding friction (f_s = {slider.break_away:g} N)")
    if restoring == "pendulum":
        missing.append(f"{suffix}: no pendulum's restoring force k sin x")
    if suffix == "urdf":
        if restoring == "spring":
            missing.append(f"urdf: no spring (k = {slider.k:g} N/m)")
        if name == "slider_on_floor":
            missing.append(f"urdf: no coefficient of friction (mu = {coefficient(slider):g})")
    return tuple(missing)
