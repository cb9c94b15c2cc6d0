"""Friction of joints in the words of other engines and of a controller, with what each makes of them.

What is said of an engine comes from the table of words; PhysX's viscous coefficient of a hinge is per degree.
"""

import json
import math
import re
from collections.abc import Callable, Sequence

from harness.robot.paste import JointPaste
from harness.robot.words.table import Form, table

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
