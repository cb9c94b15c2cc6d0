"""What takes the effect from a word that is right by itself: a flag, an unused class, a fixed joint."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from harness.robot.words.read import Node
from harness.robot.words.table import Form, Word


@dataclass(frozen=True, slots=True)
class Lost:
    """why : a clause. fix : what to write. parsers : of readers that it is so for; all where empty.
    partly : the word has an effect, and a part of it has none.
    """

    why: str
    fix: str
    parsers: tuple[str, ...] = ()
    partly: bool = False


_MUJOCO = ("mujoco", "isaac")


def without_effect(form: Form, word: Word, value: str, node: Node, nodes: Sequence[Node]) -> Lost | None:
    """What takes the effect from a word; node : its element, or that which holds it. None where it has one."""
    if form == "mjcf":
        return _in_mjcf(word, value, node, nodes)
    if form in ("urdf", "sdf"):
        return _in_urdf(word, node, nodes) or _in_a_fixed_joint(word, value, node)
    return None


def _in_mjcf(word: Word, value: str, node: Node, nodes: Sequence[Node]) -> Lost | None:
    numbers = [float(part) for part in value.split()] if word.unit != "enable, disable" else []
    if (lost := _of_a_class(word, node, nodes)) or not any(numbers) or (lost := _switched_off(word, node, nodes)):
        return lost
    return _beside(word.name, numbers, node, nodes)


def _beside(name: str, numbers: Sequence[float], node: Node, nodes: Sequence[Node]) -> Lost | None:
    """Of other attributes of the same element."""
    has, lost = node.attributes, None
    if node.tag == "joint" and name in ("damping", "stiffness") and "springdamper" in has:
        lost = Lost("springdamper of the same joint takes its place", "leave springdamper out", (*_MUJOCO, "rapier"))
    elif name in ("solreffriction", "solimpfriction") and _nothing("frictionloss", node, nodes):
        lost = Lost("there is no frictionloss", 'add frictionloss="..." to it', _MUJOCO)
    elif node.tag == "general" and name == "biasprm" and has.get("biastype", "none") == "none" and "class" not in has:
        lost = Lost("biastype is none", 'add biastype="affine"', _MUJOCO)
    elif name == "friction" and node.tag in ("geom", "pair"):
        lost = _of_a_shape(numbers, node, nodes)
    elif name in ("kv", "dampratio") and {"kv", "dampratio"} <= set(has):
        lost = Lost("kv and dampratio stand side by side, and the file is refused", "leave one of the two out", _MUJOCO)
    elif name == "o_friction" and not any(n.attributes.get("override") == "enable" for n in nodes if n.tag == "flag"):
        lost = Lost("overrides are not enabled", 'add <flag override="enable"/> to <option>', _MUJOCO)
    return lost


def _of_a_class(word: Word, node: Node, nodes: Sequence[Node]) -> Lost | None:
    """A default that nothing in the file has."""
    inside = next((one for one in node.above() if one.tag == "default"), None)
    name = None if inside is None else inside.attributes.get("class")
    if inside is None or name in (None, "main") or inside.parent is None or inside.parent.tag != "default":
        return None
    outside = [n for n in nodes if "default" not in n.way]
    used = {n.attributes[key] for n in outside for key in ("class", "childclass") if key in n.attributes}
    within = {one.attributes.get("class") for one in nodes if one.tag == "default" and inside in list(one.above())}
    # a library of classes is none of a mistake: one is, where the word stands nowhere else in a file with joints
    elsewhere = [n for n in nodes if word.name in n.attributes and inside not in list(n.above())]
    if used & (within | {name}) or elsewhere or not any(n.tag == node.tag for n in outside):
        return None
    return Lost(f"nothing is of the class {name}", f'add class="{name}" to the {node.tag}')


_FLAGS = {
    "friction": ("frictionloss", "constraint"),
    "damping": ("damper",),
    "servo": ("actuation",),
    "contact": ("contact", "constraint"),
}


def _switched_off(word: Word, node: Node, nodes: Sequence[Node]) -> Lost | None:
    if node.tag == "flag":
        return None
    for flag in (n for n in nodes if n.tag == "flag"):
        for name in _FLAGS.get(word.kind, ()):
            if flag.attributes.get(name) == "disable" and not (name == "damper" and word.name == "springdamper"):
                return Lost(
                    f'<flag {name}="disable"/> in line {flag.line} switches it off', "take the flag out", _MUJOCO
                )
    return None


def _nothing(name: str, node: Node, nodes: Sequence[Node]) -> bool:
    """Whether neither an element nor any default of the file has an attribute."""
    return name not in node.attributes and not any(
        name in n.attributes for n in nodes if "default" in n.way or n.tag == node.tag
    )


def _of_a_shape(numbers: Sequence[float], node: Node, nodes: Sequence[Node]) -> Lost | None:
    """A contact has the larger condim of its two geoms, 3 where a geom says none; a pair has its own."""
    has = node.attributes
    usual = {
        n.attributes["condim"] for n in nodes if n.tag == "geom" and "default" in n.way and "condim" in n.attributes
    }
    # one default of the whole file, or none, is what a geom has that says nothing; of several the largest is supposed
    usual = usual if len(usual) == 1 and not any("class" in n.attributes for n in nodes) else usual | {"3"}
    own = {n.attributes.get("condim", max(usual)) for n in nodes if n.tag == "geom" and "default" not in n.way}
    largest = max(own | (usual if not own else set()))
    condim = has.get("condim", "3") if node.tag == "pair" else largest
    if condim == "1":
        partly = "default" in node.way  # what it touches may stand in another file
        return Lost("condim is 1, a contact without friction", 'write condim="3"', _MUJOCO, partly)
    if node.tag == "geom" and "default" not in node.way and has.get("contype") == has.get("conaffinity") == "0":
        return Lost("contype and conaffinity are 0", "it touches nothing, but by a pair", partly=True)
    if condim == "3" and any(numbers[1 if node.tag == "geom" else 2 :]) and "condim" in has:
        return Lost("its torsional and rolling parts want condim 4 and 6", 'write condim="6"', partly=True)
    return None


def _in_urdf(word: Word, node: Node, nodes: Sequence[Node]) -> Lost | None:
    if node.parent is not None and node.tag == "dynamics":
        every = [one for one in node.parent.children if one.tag == "dynamics"]
        if len(every) > 1 and node is not every[0]:
            return Lost("a joint's second <dynamics>: the first one counts", "put both words into one element")
    outer = next((one for one in node.above() if one.tag == "gazebo" and "reference" in one.attributes), None)
    if outer is not None:
        name = outer.attributes["reference"]
        if not any(n.tag in ("link", "joint") and n.attributes.get("name") == name for n in nodes):
            return Lost(f"no link or joint is called {name}", "name one that there is")
    return None


_OF_JOINTS = ("friction", "damping", "spring", "armature")


def _in_a_fixed_joint(word: Word, value: str, node: Node) -> Lost | None:
    joint = next((one for one in node.above() if one.tag == "joint"), None)
    zero = re.fullmatch(r"[0.\s]*", value)
    if joint is not None and joint.attributes.get("type") == "fixed" and word.kind in _OF_JOINTS and not zero:
        return Lost("the joint is fixed", "write it into a joint that moves")
    return None
