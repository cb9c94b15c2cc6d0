"""Friction of a joint as text for a robot's model: elements to paste, and copies of the files that have them."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Literal
from xml.sax.saxutils import escape, quoteattr, unescape

from harness.core.checks import not_negative, positive
from harness.engines.mujoco.presets import presets
from harness.robot.bare import with_included

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
