"""What takes the effect from a word that is right by itself: a flag, an unused class, another geom, a fixed joint."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Literal

from harness.robot.words.read import Defaults, Node, family
from harness.robot.words.table import Fate, Form, Word
from harness.robot.words.touching import Beaten, Touching, numbers

Grade = Literal["wrong", "lost", "partly"]


@dataclass(frozen=True, slots=True)
class Lost:
    """why : a clause. fix : what to write. readers : that it is so for; all where empty.

    grade : wrong, the word has no effect by another word of the file; lost, it has none, which need be no mistake;
    partly, a part of it has none, or it may have one with what is in another file. fate : at those readers.
    """

    why: str
    fix: str
    readers: tuple[str, ...] = ()
    grade: Grade = "wrong"
    fate: Fate = "dropped"


_MUJOCO: Final = ("mujoco", "mjx", "warp", "genesis", "isaac")
"""Readers that have the file from MuJoCo's compiler."""
_STEPPED: Final = ("mujoco", "mjx", "warp")
"""Readers that step it as MuJoCo does."""


class Effects:
    """Of the words of a file."""

    def __init__(self, form: Form, nodes: Sequence[Node]) -> None:
        self._form, self._nodes = form, nodes

    @cached_property
    def _defaults(self) -> Defaults:
        return Defaults(self._nodes)

    @cached_property
    def _touching(self) -> Touching:
        return Touching(self._nodes, self._defaults)

    def lost(self, word: Word, value: str, node: Node) -> Lost | None:
        """What takes the effect from a word; node : its element, or that which holds it. None where it has one."""
        if word.form == "mjcf":
            return self._in_mjcf(word, value, node)
        if self._form == "usd":
            return _in_usd(word, node)
        found = _in_urdf(word, node, self._nodes) or _by_its_joint(word, value, node)
        off = self._switched_off(word, node) if found is None and self._form == "urdf" else None
        return found if off is None else replace(off, readers=_STEPPED)

    def _in_mjcf(self, word: Word, value: str, node: Node) -> Lost | None:
        switch = word.unit == "enable, disable"
        if not switch and not any(numbers(value)):
            return None
        if (lost := self._switched_off(word, node)) is not None:
            return lost
        on = self._defaults.having(node, word.name)
        if not on:
            return self._of_a_class(word, node)
        found = [self._unnamed(one) or self._beside(word.name, numbers(value), one) for one in on]
        return next((one for one in found if one is not None), None) if all(found) else None

    @cached_property
    def _part(self) -> bool:
        """Whether the file is one that others include, with what it names."""
        ways = {one.way for one in self._nodes}
        return self._nodes[0].tag != "mujoco" or ("mujoco", "worldbody") not in ways or ("mujoco", "body") in ways

    @cached_property
    def _joints(self) -> set[str | None]:
        return {one.attributes.get("name") for one in self._defaults.outside if one.tag in ("joint", "freejoint")}

    def _unnamed(self, node: Node) -> Lost | None:
        """A class or a joint that an element names and that is not there, for which its file is refused."""
        name = self._defaults.class_of(node)
        if self._part or self._touching.open:
            return None
        if not self._defaults.knows(name):
            return Lost(f"no default is of the class {name}", "name one that there is", _MUJOCO, fate="refused")
        joint = node.attributes.get("joint")
        if family(node.tag) == "actuator" and joint is not None and joint not in self._joints:
            return Lost(f"no joint is called {joint}", "name one that there is", _MUJOCO, fate="refused")
        return None

    def _beside(self, name: str, values: Sequence[float], node: Node) -> Lost | None:
        """What other words do to one that this element has."""
        has, lost = self._defaults.of(node), None
        if node.tag == "joint" and name in ("damping", "stiffness") and any(numbers(has.get("springdamper"))):
            own = (*_MUJOCO, "rapier")
            lost = Lost("springdamper of the same joint takes its place", "leave springdamper out", own)
        elif name == "springdamper" and not all(values[:2]):
            lost = Lost("both of its numbers have to be above zero", "write both", _MUJOCO, fate="refused")
        elif name in ("solreffriction", "solimpfriction") and node.tag == "pair":
            if not any(one.attributes.get("cone") == "elliptic" for one in self._nodes if one.tag == "option"):
                lost = Lost("the cone is pyramidal", 'add cone="elliptic" to <option>', _STEPPED)
        elif name in ("solreffriction", "solimpfriction") and not any(numbers(has.get("frictionloss"))):
            lost = Lost("there is no frictionloss", f'add frictionloss="..." to the {node.tag}', _MUJOCO)
        elif node.tag == "general" and name == "biasprm" and has.get("biastype", "none") == "none":
            lost = Lost("biastype is none", 'add biastype="affine"', _MUJOCO)
        elif name == "friction" and node.tag in ("geom", "pair"):
            lost = self._of_a_contact(values, node, has)
        elif name in ("kv", "dampratio") and {"kv", "dampratio"} <= set(node.attributes):
            why = "kv and dampratio stand side by side"
            lost = Lost(why, "leave one of the two out", _MUJOCO, fate="refused")
        elif family(node.tag) == "actuator" and "gear" in has and not any(numbers(has["gear"])):
            lost = Lost("its gear is 0", "leave gear out", _MUJOCO)
        elif name in ("kp", "kv", "ki", "dampratio", "biasprm") and self._group_is_off(has):
            lost = Lost(f"actuatorgroupdisable has its group {has.get('group', '0')}", "take it out", _STEPPED)
        elif name == "o_friction" and not self._overrides:
            lost = Lost("overrides are not enabled", 'add <flag override="enable"/> to <option>', _MUJOCO)
        return lost

    @cached_property
    def _overrides(self) -> bool:
        return any(one.attributes.get("override") == "enable" for one in self._nodes if one.tag == "flag")

    def _group_is_off(self, has: dict[str, str]) -> bool:
        groups = (one.attributes.get("actuatorgroupdisable", "") for one in self._nodes if one.tag == "option")
        return has.get("group", "0") in " ".join(groups).split()

    def _switched_off(self, word: Word, node: Node) -> Lost | None:
        for flag in (one for one in self._nodes if one.tag == "flag" and one is not node):
            for name in _FLAGS.get(word.kind, ()):
                if flag.attributes.get(name) != "disable":
                    continue
                why = f'<flag {name}="disable"/> in line {flag.line} switches '
                if word.name == "springdamper":
                    return Lost(f"{why}its damping off", "take the flag out", _MUJOCO, "partly")
                return Lost(f"{why}it off", "take the flag out", _MUJOCO)
        return None

    def _of_a_class(self, word: Word, node: Node) -> Lost | None:
        """A default that no element has."""
        inside = next(one for one in node.above() if one.tag == "default")
        if self._part:
            return None  # a library of classes
        name = inside.attributes.get("class", "main")
        own = [one for one in self._nodes if one.tag == "default" and inside in list(one.above())]
        within = {one.attributes.get("class", "main") for one in own}
        of_it = [one for one in self._defaults.alike(node) if self._defaults.class_of(one) in within]
        kind = {"actuator": "actuator", "tendon": "tendon"}.get(family(node.tag), node.tag)
        if not any(self._defaults.alike(node)):
            return Lost(f"the file has no {kind}", "", (), "lost")
        if of_it:
            return Lost(f"each {kind} of the class {name} has its own", "", (), "lost")
        # one of several classes that give the word may wait for its use
        elsewhere = any(word.name in n.attributes and inside not in list(n.above()) for n in self._nodes)
        why, fix = f"no {kind} is of the class {name}", f'add class="{name}" to the {kind}'
        return Lost(why, fix, (), "lost" if elsewhere else "wrong")

    def _of_a_contact(self, values: Sequence[float], node: Node, has: dict[str, str]) -> Lost | None:
        """Of a friction: condim, priority, pairs, and the larger of two."""
        if self._overrides and any("o_friction" in one.attributes for one in self._nodes if one.tag == "option"):
            return Lost("o_friction of <option> takes its place", "write it there, or take the override out", _STEPPED)
        if node.tag == "pair":
            condims = [int(has["condim"])] if has.get("condim", "").isdigit() else []
        elif has.get("contype") == has.get("conaffinity") == "0" and not self._touching.beaten(node):
            why = "contype and conaffinity are 0"
            return Lost(why, "it touches nothing, but by a pair", _STEPPED, "lost")
        else:
            condims = self._touching.condims(node)
        if condims and set(condims) == {1}:
            sure = node.tag == "pair" or self._touching.with_world(node)  # else what bears it is in another file
            why = "condim is 1, a contact without friction"
            return Lost(why, 'write condim="3"', _MUJOCO, "wrong" if sure else "partly")
        if node.tag == "geom" and (lost := self._beaten(node)) is not None:
            return lost
        if max(condims, default=0) == 3 and any(values[1 if node.tag == "geom" else 2 :]) and "condim" in has:
            return Lost("its torsional and rolling parts want condim 4 and 6", 'write condim="6"', (), "partly")
        return None

    def _beaten(self, node: Node) -> Lost | None:
        """By another geom, or by a pair, in every contact that is told by the file."""
        every = self._touching.beaten(node)
        found = [one for one in every if one is not None]
        if not found or len(found) < len(every) or self._touching.open:
            return None
        first: Beaten = max(found, key=lambda one: (one.fixed, one.said))
        more = f"{first.of} has more, and of two geoms the larger counts"
        why, fix = {
            "pair": (f"the <pair> of {first.of} has its own", "write it there"),
            "priority": (f"{first.of} has a higher priority, and its friction counts", 'give this one priority="..."'),
            "larger": (more, 'write it there too, or give this one priority="1"'),
        }[first.how]
        if not first.fixed and first.how != "pair":
            return Lost(why, "what else it touches is not in this file", (), "partly")
        return Lost(why, fix, _STEPPED, "wrong" if all(one.said for one in found) else "lost")


_FLAGS: Final = {
    "friction": ("frictionloss", "constraint"),
    "damping": ("damper",),
    "spring": ("spring",),
    "servo": ("actuation",),
    "contact": ("contact", "constraint"),
}


_OF_GAZEBO_JOINTS: Final = ("implicitSpringDamper", "springStiffness")
"""Words of <gazebo> that are of a joint; the others are of a link."""


def _in_urdf(word: Word, node: Node, nodes: Sequence[Node]) -> Lost | None:
    if node.parent is not None and node.tag == "dynamics":
        every = [one for one in node.parent.children if one.tag == "dynamics"]
        if len(every) > 1 and node is not every[0]:
            return Lost("a joint's second <dynamics>: the first one counts", "put both words into one element")
    outer = next((one for one in node.above() if one.tag == "gazebo"), None)
    if outer is None or word.form != "urdf":
        return None
    wants = "joint" if word.name in _OF_GAZEBO_JOINTS else "link"
    name = outer.attributes.get("reference")
    if name is None:
        return Lost("<gazebo> refers to nobody", f'add reference="..." with the name of a {wants}')
    of = {one.tag for one in nodes if one.tag in ("link", "joint") and one.attributes.get("name") == name}
    if not of:
        return Lost(f"no link or joint is called {name}", "name one that there is")
    return None if wants in of else Lost(f"{name} is no {wants}", f"name a {wants}")


_AXES: Final = {
    "PhysicsRevoluteJoint": ("angular", "rotX", "rotY", "rotZ"),
    "PhysicsPrismaticJoint": ("linear", "transX", "transY", "transZ"),
}
"""Instances of a drive that a joint's type has."""


_SCHEMAS: Final = {
    r"drive:": "PhysicsDriveAPI:{}",
    r"physxJointAxis:": "PhysxJointAxisAPI:{}",
    r"physxJoint:": "PhysxJointAPI",
    r"physics:\w+Friction$": "PhysicsMaterialAPI",
}
"""Of attributes, by how their names begin, the schema that a prim has to apply so that they are read."""


def _in_usd(word: Word, node: Node) -> Lost | None:
    """A drive of an axis that the joint has not, or that is not applied; friction at rest below that of sliding."""
    name, prim = next(iter(node.attributes)), node.parent
    if prim is None:
        return None
    beside = {key: value for one in prim.children for key, value in one.attributes.items()}
    static = numbers(beside.get(name.replace("dynamicFriction", "staticFriction")))
    if name.endswith("dynamicFrictionEffort") and static < numbers(beside[name]):
        return Lost("it is above its staticFrictionEffort", "write at least as much there", grade="partly")
    schema = next((to for of, to in _SCHEMAS.items() if re.match(of, name)), None)
    if schema is None:
        return None
    axis = name.split(":")[1]
    wanted, axes = schema.format(axis), _AXES.get(prim.tag)
    if axes is not None and "{}" in schema and axis not in axes:
        return Lost(f"a {prim.tag} has no axis {axis}", f"write {name.replace(f':{axis}:', f':{axes[0]}:')}")
    schemas = re.search(r"apiSchemas\s*=\s*\[([^\]]*)\]", prim.text)
    elsewhere = re.search(r"references|payload|inherits|specializes|variantSets", prim.text)
    typed = axes is not None or prim.tag == "Material"
    if typed and elsewhere is None and f'"{wanted}"' not in (schemas[1] if schemas else ""):
        return Lost(f"the schema {wanted} is not applied", f'add "{wanted}" to apiSchemas')
    return None


_OF_JOINTS: Final = ("friction", "damping", "spring", "armature")


_TWO_AXES: Final = ("universal", "revolute2", "gearbox")
"""Types of SDF's joints."""


def _by_its_joint(word: Word, value: str, node: Node) -> Lost | None:
    """A model that does not move, and a joint that has no such axis or is taken for a fixed one."""
    if word.kind not in _OF_JOINTS:
        return None
    model = next((one for one in node.above() if one.tag == "model"), node)
    still = any(one.tag == "static" and one.text in ("true", "1") for one in model.children)
    if still and word.form == "sdf":
        return Lost("its model is static", "take <static> out")
    joint = next((one for one in node.above() if one.tag == "joint"), None)
    kind = "" if joint is None or re.fullmatch(r"[0.\s]*", value) else joint.attributes.get("type", "")
    if kind == "fixed":
        return Lost("the joint is fixed", "write it into a joint that moves")
    if kind and kind not in _TWO_AXES and any(one.tag == "axis2" for one in node.above()):
        return Lost(f"a {kind} joint has no second axis", "write it into <axis>")
    if kind == "floating":
        why = "PyBullet makes a floating joint a fixed one"
        return Lost(why, "leave the root link free", ("pybullet",), "lost")
    return None
