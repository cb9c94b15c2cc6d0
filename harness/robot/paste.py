"""Friction of a joint as text: elements of a robot's model, copies of its files, the words of other engines.

What is said of an engine comes from the table of words; PhysX's viscous coefficient of a hinge is per degree.
"""

import json
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Literal
from xml.sax.saxutils import escape, quoteattr, unescape

from harness.core.checks import not_negative, positive
from harness.engines.mujoco.presets import presets
from harness.robot.bare import with_included
from harness.robot.words.table import Form, table

_TOKEN = re.compile(
    r"<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>|<(?P<close>/)?(?P<name>[^\s/>!?]+)(?P<rest>(?:[^>\"']|\"[^\"]*\"|'[^']*')*)>",
    re.DOTALL,
)
_ATTRIBUTE = re.compile(r"(?P<space>\s+)(?P<name>[^\s=]+)\s*=\s*(?P<quote>[\"'])(?P<value>.*?)(?P=quote)", re.DOTALL)
_QUOTES = {"&quot;": '"', "&apos;": "'"}


@dataclass(frozen=True, slots=True)
class Tag:
    """A start tag. way : names of the elements it stands in and its own. begin, end : where in the text. attributes :
    as they are meant. empty : it has no content.
    """

    way: tuple[str, ...]
    begin: int
    end: int
    attributes: Mapping[str, str]
    empty: bool


def tags(text: str) -> Iterator[Tag]:
    """Every start tag of a well-formed text, in order."""
    way: list[str] = []
    for found in _TOKEN.finditer(text):
        if found["name"] is None:
            continue
        if found["close"]:
            way.pop()
            continue
        rest = found["rest"]
        attributes = {one["name"]: unescape(one["value"], _QUOTES) for one in _ATTRIBUTE.finditer(rest)}
        empty = rest.endswith("/")
        yield Tag((*way, found["name"]), found.start(), found.end(), attributes, empty)
        if not empty:
            way.append(found["name"])


def with_attributes(text: str, tag: Tag, values: Mapping[str, str]) -> str:
    """The text with these attributes of a tag, which are changed where they stand or put behind the others."""
    own, left = text[tag.begin : tag.end], dict(values)

    def changed(found: re.Match[str]) -> str:
        name = found["name"]
        if name not in left:
            return found[0]
        return f"{found['space']}{name}={_quoted(left.pop(name))}"

    own = _ATTRIBUTE.sub(changed, own)
    more = "".join(f" {name}={_quoted(value)}" for name, value in left.items())
    at = re.search(r"\s*/?>$", own)
    assert at is not None
    return text[: tag.begin] + own[: at.start()] + more + own[at.start() :] + text[tag.end :]


def _quoted(value: str) -> str:
    return f'"{escape(value, {chr(34): "&quot;"})}"'


Format = Literal["mjcf", "urdf"]


@dataclass(frozen=True, slots=True)
class JointPaste:
    """What a joint is to be given.

    f_k : dry friction, N m or N. c : viscous damping, N m s/rad or N s/m. armature : kg m^2 or kg. dt : the step that
    the robot is simulated at, s, on which MuJoCo's words for stiff friction depend.

    Raises InputError for anything negative.
    """

    joint: str
    f_k: float
    c: float
    armature: float
    dt: float

    def __post_init__(self) -> None:
        for name in ("f_k", "c", "armature"):
            not_negative(f"paste: {name}", getattr(self, name))
        positive("paste: dt", self.dt, "s")

    @property
    def mjcf_words(self) -> dict[str, str]:
        """Attributes of the joint's element in MJCF; friction as stiff as the step allows."""
        return {
            "frictionloss": _text(self.f_k),
            "damping": _text(self.c),
            "armature": _text(self.armature),
            **stiff_friction(self.dt),
        }

    @property
    def urdf_words(self) -> dict[str, str]:
        """Attributes of the joint's <dynamics> in URDF."""
        return {"damping": _text(self.c), "friction": _text(self.f_k)}

    @property
    def mjcf(self) -> str:
        """The joint's element in MJCF, to be put into the one there is."""
        return f"<joint name={quoteattr(self.joint)} {_written(self.mjcf_words)}/>"

    @property
    def urdf(self) -> str:
        """The joint's <dynamics> in URDF, with the calls for what PyBullet does not read of it."""
        return "\n".join((f"<dynamics {_written(self.urdf_words)}/>", *self.calls))

    @property
    def calls(self) -> tuple[str, ...]:
        """For PyBullet: a joint's friction is read but without effect, and every link has a damping of its own."""
        return (
            f"joint = [p.getJointInfo(body, i)[1].decode() for i in range(p.getNumJoints(body))].index({self.joint!r})",
            f"p.setJointMotorControl2(body, joint, p.VELOCITY_CONTROL, targetVelocity=0, force={_text(self.f_k)})",
            f"p.changeDynamics(body, joint, jointDamping={_text(self.c)}, linearDamping=0, angularDamping=0)",
        )

    def cannot_say(self, form: Format, terms: Sequence[str] = ()) -> tuple[str, ...]:
        """What a format leaves out, one sentence each; terms : names of what the joint has besides."""
        missing = [f"{form}: no {name} of {self.joint}" for name in terms]
        if form == "urdf":
            if self.armature > 0.0:
                missing.append(f"urdf: no armature ({self.armature:.4g} of {self.joint}'s rotor)")
            if self.f_k > 0.0:
                missing.append(
                    f"urdf: PyBullet reads friction = {self.f_k:.4g} without effect; a velocity motor has it"
                )
        return tuple(missing)


def stiff_friction(dt: float) -> dict[str, str]:
    """Attributes of a joint in MJCF with which MuJoCo's dry friction is as stiff as a step of dt s allows."""
    stiff = presets("joint", "tuned", dt)
    return {name: " ".join(map(_text, stiff[name])) for name in ("solreffriction", "solimpfriction")}


def written(
    path: Path, paste: JointPaste, edited: Mapping[Path, str] = MappingProxyType({})
) -> tuple[Path, str] | None:
    """The file of a model that has the joint's element, and its text with what is to be pasted and all else as it is.

    edited : by resolved path, texts that take the place of files. None where no element has the joint's name (a
    replicate makes it). Raises InputError as ``load_arm`` does.
    """
    sources = with_included(path, edited)
    urdf = sources[0].root.tag == "robot"
    for source in sources:
        text, every = source.text, list(tags(source.text))
        for i, tag in enumerate(every):
            if tag.way[-1] != "joint" or tag.attributes.get("name") != paste.joint:
                continue
            if not urdf and "body" in tag.way and "default" not in tag.way:
                return source.path, with_attributes(text, tag, paste.mjcf_words)
            if urdf and tag.way == ("robot", "joint"):
                for one in every[i + 1 :]:
                    if len(one.way) <= len(tag.way):
                        break
                    if one.way[2:] == ("dynamics",):
                        return source.path, with_attributes(text, one, paste.urdf_words)
                return source.path, _with_child(text, tag, f"<dynamics {_written(paste.urdf_words)}/>")
    return None


def copies(path: Path, *pastes: JointPaste) -> dict[str, str]:
    """Texts of the files that change, with what is to be pasted for every joint, by name; of an SDF a URDF."""
    edited: dict[Path, str] = {}
    for paste in pastes:
        if (found := written(path, paste, edited)) is not None:
            edited[found[0].resolve()] = found[1]
    return {file.with_suffix(".urdf" if file.suffix == ".sdf" else file.suffix).name: t for file, t in edited.items()}


def _with_child(text: str, tag: Tag, child: str) -> str:
    """The text with an element put first into a tag's content, on a line of its own."""
    line = text[text.rfind("\n", 0, tag.begin) + 1 : tag.begin]
    indent = line if line.isspace() else ""
    if not tag.empty:
        return f"{text[: tag.end]}\n{indent}  {child}{text[tag.end :]}"
    own = re.sub(r"\s*/>$", ">", text[tag.begin : tag.end])
    return f"{text[: tag.begin]}{own}\n{indent}  {child}\n{indent}</{tag.way[-1]}>{text[tag.end :]}"


def _written(words: dict[str, str]) -> str:
    return " ".join(f'{name}="{value}"' for name, value in words.items())


def _text(value: float) -> str:
    return f"{value:.10g}"


_WIDTHS = {False: 0.05, True: 0.01}
"""rad/s, and m/s of a slide, over which a controller's friction passes zero: above the noise of most speeds."""


def elsewhere(pastes: Sequence[JointPaste], slides: Callable[[str], bool]) -> dict[str, str]:
    """Texts by engine: isaac, newton, sdf, genesis, drake, ros2; none where there is no joint.

    slides : whether a joint of this name is a slide.
    """
    if not pastes:
        return {}
    texts = {"newton": _newton, "genesis": _genesis, "drake": _drake}
    made = {name: "\n".join(map(write, pastes)) for name, write in texts.items()}
    made["newton"] = f"{_said('newton', 'urdf', 'friction')}\n{made['newton']}"
    made["genesis"] = f"{_said('genesis', 'urdf', 'friction')}\n{made['genesis']}"
    made["drake"] = f"{_said('drake', 'urdf', 'friction')}; add it as a generalized force\n{made['drake']}"
    made["isaac"] = _isaac(pastes, slides)
    made["sdf"] = "\n".join(map(_sdf, pastes))
    made["ros2"] = _ros2(pastes, slides)
    return made


def _number(value: float) -> str:
    return f"{value:.10g}"


def _said(reader: str, form: Form, name: str) -> str:
    """A comment: what a reader makes of a word."""
    word = next(one for one in table().words[form] if one.name == name)
    taken = word.taken(reader)
    title = table().readers[reader].title
    return f"# {title}, friction: {taken.fate}{f', {taken.note}' if taken.note else ''}"


def _isaac(pastes: Sequence[JointPaste], slides: Callable[[str], bool]) -> str:
    """Actuators of Isaac Lab, and the same as attributes of PhysX's joints in a USD."""
    lines = [
        "# Isaac Lab on Isaac Sim 5 and later: efforts in N m or N, per rad; before, friction had no unit",
        "from isaaclab.actuators import ImplicitActuatorCfg",
        "",
        "actuators = {",
    ]
    for one in pastes:
        f, c, armature = map(_number, (one.f_k, one.c, one.armature))
        lines += [
            f"    {one.joint!r}: ImplicitActuatorCfg(",
            f"        joint_names_expr=[{re.escape(one.joint)!r}], stiffness=None, damping=None, armature={armature},",
            f"        friction={f}, dynamic_friction={f}, viscous_friction={c},",
            "    ),",
        ]
    lines += ["}", "", "# or in the USD, on the joint's prim (PhysxJointAxisAPI, inside of an articulation):"]
    for one in pastes:
        axis = "linear" if slides(one.joint) else "angular"
        viscous = one.c if slides(one.joint) else math.radians(one.c)
        unit = "N s/m" if slides(one.joint) else "N m s/deg"
        values = {"staticFrictionEffort": one.f_k, "dynamicFrictionEffort": one.f_k, "armature": one.armature}
        lines.append(f'# {one.joint!r}: apiSchemas = ["PhysxJointAxisAPI:{axis}"]')
        lines += [f"# float physxJointAxis:{axis}:{name} = {_number(value)}" for name, value in values.items()]
        lines.append(f"# float physxJointAxis:{axis}:viscousFrictionCoefficient = {_number(viscous)}  ({unit})")
    return "\n".join(lines)


def _newton(one: JointPaste) -> str:
    f, c, armature = map(_number, (one.f_k, one.c, one.armature))
    return (
        "i = builder.joint_qd_start[next(k for k, label in enumerate(builder.joint_label)"
        f" if label.split('/')[-1] == {one.joint!r})]\n"
        f"builder.joint_friction[i], builder.joint_damping[i], builder.joint_armature[i] = {f}, {c}, {armature}"
    )


def _sdf(one: JointPaste) -> str:
    """In the joint's <axis>."""
    word = next(one for one in table().words["sdf"] if one.name == "friction")
    readers = table().of("sdf")
    reads, drops = ([r.title for r in readers if (word.taken(r.name).fate == "read") is own] for own in (True, False))
    return (
        f"<!-- in the axis of {one.joint.replace('--', '__')}; friction is read by {', '.join(reads)}, dropped by"
        f" {', '.join(drops)} -->\n<dynamics><damping>{_number(one.c)}</damping>"
        f"<friction>{_number(one.f_k)}</friction></dynamics>"
    )


def _genesis(one: JointPaste) -> str:
    f, c, armature = map(_number, (one.f_k, one.c, one.armature))
    return (
        f"dof = robot.get_joint({one.joint!r}).dofs_idx_local\n"
        f"robot.set_dofs_frictionloss([{f}], dof)\nrobot.set_dofs_damping([{c}], dof)\n"
        f"robot.set_dofs_armature([{armature}], dof)"
    )


def _drake(one: JointPaste) -> str:
    """Before Finalize."""
    return (
        f"plant.GetJointByName({one.joint!r}).set_default_damping({_number(one.c)})\n"
        f"# with an actuator of the joint: actuator.set_default_rotor_inertia({_number(one.armature)}), gear ratio 1"
    )


def _ros2(pastes: Sequence[JointPaste], slides: Callable[[str], bool]) -> str:
    """Parameters of a controller that adds friction: coulomb tanh(v/tanh_width) + viscous v."""
    lines = [
        "# torque = coulomb tanh(v/tanh_width) + viscous v; N m and rad/s of a hinge, N and m/s of a slide",
        "friction_compensation:",
        "  ros__parameters:",
        f"    joints: {json.dumps([one.joint for one in pastes])}",
    ]
    for one in pastes:
        width = _WIDTHS[slides(one.joint)]
        values = {"coulomb": float(one.f_k), "viscous": float(one.c), "tanh_width": width}
        lines.append(f"    {json.dumps(one.joint)}:")
        lines += [f"      {name}: {value!r}" for name, value in values.items()]
    return "\n".join(lines)
